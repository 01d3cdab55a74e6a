"""The leaf spring: torque and stiffness over deflection and stiffness motor position, Eqs. (3)-(4).

The paper prints theta_l inside the sine; the deflection delta = theta_e - theta_l is meant (Eq. 5 linearises
k (theta_e - theta_l)), and Y_k = Y_tau / 2.
"""

import math

from vssea_core.compiled import inlined


@inlined
def spring_torque(spring_constant, deflection, theta_ms):  # type: ignore[no-untyped-def]
    """Return tau_s [N m] = (Y_tau / theta_ms^3) sin(delta / 2), Eq. (3)."""
    return spring_constant / (theta_ms * theta_ms * theta_ms) * math.sin(0.5 * deflection)


@inlined
def spring_stiffness(spring_constant, deflection, theta_ms):  # type: ignore[no-untyped-def]
    """Return k [N m/rad] = (Y_tau / (2 theta_ms^3)) cos(delta / 2), Eq. (4)."""
    return spring_constant / (2.0 * theta_ms * theta_ms * theta_ms) * math.cos(0.5 * deflection)


@inlined
def back_torque(spring_constant, deflection, theta_ms):  # type: ignore[no-untyped-def]
    """Return the torque [N m] of the spring's energy on the stiffness motor, dV/d theta_ms, pushing towards softer.

    V = (2 Y_tau / theta_ms^3) (1 - cos(delta / 2)); 1 - cos is written as 2 sin^2 to keep its digits.
    """
    sine = math.sin(0.25 * deflection)
    square = theta_ms * theta_ms
    return -12.0 * spring_constant / (square * square) * sine * sine


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
