"""The metrics of runs in lanes, from the sums that were kept instead of samples; see simulation.metrics for what they are."""

import numpy as np
from numpy.typing import NDArray

from vssea_core.batch import layout as at
from vssea_core.channels import INDEX, LIMITS
from vssea_core.simulation.metrics import METRICS, TORQUE_LIMITS

Numbers = NDArray[np.float64]
METRIC_NAMES = tuple(metric.name for metric in METRICS)
LIMIT_NAMES = tuple(limit.name for limit in LIMITS[:8])
"""Limits that a simulated rig can meet."""


def first_sums(row: Numbers) -> Numbers:
    """Return the sums (17,) after the first sample, a row of channels."""
    error, torque, bits = row[INDEX["error"]], row[INDEX["motor_torque"]], int(row[INDEX["limits"]])
    link = row[INDEX["link_disturbance"]] - row[INDEX["link_disturbance_estimate"]]
    motor = row[INDEX["motor_disturbance"]] - row[INDEX["motor_disturbance_estimate"]]
    saturated = float(bits & TORQUE_LIMITS != 0)
    limits = [float(bits & limit.bit != 0) for limit in LIMITS[:8]]
    return np.array([abs(error), error**2, abs(torque), torque**2, torque, 0.0, saturated, link**2, motor**2, *limits])


def metrics_of_sums(sums: Numbers, count: int, period_s: float) -> Numbers:
    """Return metrics and limit shares (m, 9 + 8) of runs of `count` samples from their sums (m, 17)."""
    columns = {
        "peak_error": sums[:, at.PEAK_ERROR],
        "rms_error": np.sqrt(sums[:, at.SQUARED_ERROR] / count),
        "peak_torque": sums[:, at.PEAK_TORQUE],
        "rms_torque": np.sqrt(sums[:, at.SQUARED_TORQUE] / count),
        "torque_chatter": np.sqrt(sums[:, at.SQUARED_CHANGE] / max(1, count - 1)),
        "saturated": 100.0 * (sums[:, at.SATURATED] / count),
        "observer_error": np.sqrt(sums[:, at.LINK_ESTIMATE] / count),
        "motor_observer_error": np.sqrt(sums[:, at.MOTOR_ESTIMATE] / count),
    }
    period = (count - 1) * period_s / (count - 1) if count > 1 else 0.0  # as the recorded times say
    columns["saturated_time"] = columns["saturated"] / 100.0 * count * period
    limits = sums[:, at.LIMITS : at.LIMITS + len(LIMIT_NAMES)] / count
    return np.column_stack([*(columns[name] for name in METRIC_NAMES), limits])
