"""The leaf spring: torque and stiffness over deflection and stiffness motor position, Eqs. (3)-(4).

The paper prints theta_l inside the sine; the deflection delta = theta_e - theta_l is meant (Eq. 5 linearises
k (theta_e - theta_l)), and Y_k = Y_tau / 2. Everything follows from one sine, of a quarter of the deflection.
"""

import math
from typing import NamedTuple

from vssea_core.compiled import inlined
from vssea_core.fused import fused

QUARTER = math.pi / 4.0
S3, S5, S7, S9, S11, S13, S15 = (1.0 / math.factorial(n) for n in range(3, 16, 2))
C4, C6, C8, C10, C12, C14, C16 = (1.0 / math.factorial(n) for n in range(4, 17, 2))


class Leaf(NamedTuple):
    """The spring divided by Y_tau: a shape that holds for any plant and any model of it."""

    torque: float  # sin(delta/2) / theta_ms^3, Eq. (3)
    stiffness: float  # cos(delta/2) / (2 theta_ms^3), Eq. (4)
    back: float  # dV/d theta_ms / Y_tau = -12 sin^2(delta/4) / theta_ms^4, pushing towards softer


@inlined
def sine_and_cosine(x):
    """Return sin(x), cos(x) by their series, error below 2e-16; beyond pi/4, a deflection of pi, those of pi/4.

    The spring's law ends there. Nothing here branches or calls a library, so that several runs can be computed side by
    side in the lanes of a vector.
    """
    x = math.copysign(QUARTER, x) if abs(x) > QUARTER else x  # what is no number stays none
    s = x * x
    ss = s * s
    sine = fused(ss, fused(-S15, s, S13), fused(-S11, s, S9))
    sine = fused(ss, fused(ss, sine, fused(-S7, s, S5)), fused(-S3, s, 1.0))
    cosine = fused(ss, fused(ss, C16, fused(-C14, s, C12)), fused(-C10, s, C8))
    cosine = fused(ss, fused(ss, cosine, fused(-C6, s, C4)), fused(-0.5, s, 1.0))
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
