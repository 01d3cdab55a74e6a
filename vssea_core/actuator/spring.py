"""The leaf spring: torque and stiffness over deflection and stiffness motor position, Eqs. (3)-(4).

The paper prints theta_l inside the sine; the deflection delta = theta_e - theta_l is meant (Eq. 5 linearises
k (theta_e - theta_l)), and Y_k = Y_tau / 2. Everything follows from one sine, of a quarter of the deflection.
"""

import math
from typing import NamedTuple

from vssea_core.compiled import inlined


class Leaf(NamedTuple):
    """The spring divided by Y_tau: a shape that holds for any plant and any model of it."""

    torque: float  # sin(delta/2) / theta_ms^3, Eq. (3)
    stiffness: float  # cos(delta/2) / (2 theta_ms^3), Eq. (4)
    back: float  # dV/d theta_ms / Y_tau = -12 sin^2(delta/4) / theta_ms^4, pushing towards softer


SERIES_RANGE = 0.25


@inlined
def sine_and_cosine(x):
    """Return sin(x), cos(x): by their series (error below 2e-16) for |x| <= 0.25, a deflection of 1 rad, else by libm."""
    if abs(x) > SERIES_RANGE:
        return math.sin(x), math.cos(x)
    s = x * x
    ss = s * s
    sine = (1.0 - s * (1 / 6)) + ss * ((1 / 120 - s * (1 / 5040)) + ss * (1 / 362880 - s * (1 / 39916800)))
    cosine = (1.0 - s * 0.5) + ss * ((1 / 24 - s * (1 / 720)) + ss * (1 / 40320 - s * (1 / 3628800)))
    return x * sine, cosine


@inlined
def leaf(deflection, theta_ms):
    """Return the Leaf at a deflection [rad] and a stiffness motor position [rad].

    V = (2 Y_tau / theta_ms^3) (1 - cos(delta/2)); with q = sin(delta/4): 1 - cos(delta/2) = 2 q^2 keeps its digits.
    """
    q, c = sine_and_cosine(0.25 * deflection)
    per_theta = 1.0 / theta_ms
    per_cube = per_theta * per_theta * per_theta
    return Leaf(
        2.0 * q * c * per_cube,
        (0.5 - q * q) * per_cube,
        -12.0 * q * q * per_cube * per_theta,
    )


def stiffness_motor_position(stiffness: float, spring_constant: float) -> float:
    """Return theta_ms [rad] at which the unloaded spring has `stiffness` [N m/rad], inverse of Eq. (4)."""
    return math.cbrt(spring_constant / (2.0 * stiffness))


def equilibrium_deflection(torque: float, spring_constant: float, theta_ms: float) -> float:
    """Return delta [rad] at which the spring carries `torque` [N m], inverse of Eq. (3).

    Raises ValueError if the spring cannot carry it at this stiffness.
    """
    ratio = torque * theta_ms**3 / spring_constant
    if abs(ratio) >= 1.0:
        raise ValueError(
            f"the spring cannot carry {torque:g} N·m at theta_ms {theta_ms:.4g} rad; "
            f"expected less than {spring_constant / theta_ms**3:.4g} N·m, so raise the stiffness or lower the disturbance at t = 0"
        )
    return 2.0 * math.asin(ratio)
