"""A measured stiffness curve beside the model's, as the analysis worker computes it."""

import math
from typing import Any

from vssea_core.actuator.calibration import fitted_spring, unloaded_stiffness


def calibrate(spring_constant: float, points: list[tuple[float, float]]) -> dict[str, Any]:
    """Return for each point (position [rad], stiffness [N m/rad]) what the model says, and the constant that fits best."""
    fit = fitted_spring(*zip(*points, strict=True)) if points else None
    deviations = [100.0 * (stiffness / unloaded_stiffness(at, spring_constant) - 1.0) for at, stiffness in points]
    rows = [
        {
            "stiffness_motor_position": at, "stiffness": stiffness, "model": unloaded_stiffness(at, spring_constant),
            "deviation_percent": deviation, "fitted": unloaded_stiffness(at, fit.spring_constant) if fit else None,
        }
        for (at, stiffness), deviation in zip(points, deviations, strict=True)
    ]  # fmt: skip
    return {
        "spring_constant": spring_constant,
        "rows": rows,
        "rms_percent": math.sqrt(math.fsum(each * each for each in deviations) / len(deviations))
        if deviations
        else None,
        "fit": {"spring_constant": fit.spring_constant, "rms_percent": 100.0 * fit.rms} if fit else None,
    }
