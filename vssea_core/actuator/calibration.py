"""Measured stiffness beside the leaf spring's, unloaded: k = Y_tau / (2 theta_ms^3), Eq. (4)."""

import math
from collections.abc import Sequence
from typing import NamedTuple


class SpringFit(NamedTuple):
    """The spring constant [N m rad^3] that fits best, and the root mean square of the relative deviations it leaves."""

    spring_constant: float
    rms: float


def unloaded_stiffness(position: float, spring_constant: float) -> float:
    """Return the stiffness [N m/rad] at a stiffness motor position [rad], Eq. (4) without deflection."""
    return spring_constant / (2.0 * position**3)


def fitted_spring(positions: Sequence[float], stiffnesses: Sequence[float]) -> SpringFit:
    """Return the spring constant with the least squares of the relative deviations model / measured - 1.

    Raises ValueError unless there is a point and all numbers are positive.
    """
    if not positions or len(positions) != len(stiffnesses) or min(*positions, *stiffnesses) <= 0.0:
        raise ValueError(
            "a spring constant needs at least one point; expected positive positions and as many stiffnesses"
        )
    per_constant = [1.0 / (2.0 * x**3 * k) for x, k in zip(positions, stiffnesses, strict=True)]
    constant = math.fsum(per_constant) / math.fsum(a * a for a in per_constant)
    left = math.fsum((constant * a - 1.0) ** 2 for a in per_constant)
    return SpringFit(constant, math.sqrt(left / len(per_constant)))
