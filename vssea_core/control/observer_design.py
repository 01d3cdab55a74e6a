"""Discrete matrices of the disturbance observers (20)-(24), one channel each.

Lambda_a of Eq. (21) is a 3x3 block (x) I_4: it splits exactly into one observer a channel, and only the channels of link
and motor carry disturbances. The estimates d, d', d'' are kept instead of the auxiliary variables a = d + G v, so a change
of bandwidth leaves them where they are. Gains are found in states scaled by the sample time, where all is of the order of one.
"""

import math

import numpy as np
from numpy.typing import NDArray

from vssea_core.control.design import Poles, polynomial_of
from vssea_core.control.matrix_exponential import exponential_less_identity
from vssea_core.control.observer_poles import (
    PositionShape,
    VelocityShape,
    position_poles,
    velocity_poles,
)

Matrix = NDArray[np.float64]


def velocity_exact(
    bandwidth: float, sample_time_s: float, shape: VelocityShape = "multiple"
) -> tuple[Matrix, Matrix, Matrix, Matrix]:
    """Return A (3x3), h, b0, b1 (3) of d+ = A d + h (v+ - v) + b0 f0 + b1 f1, without bias for d up to degree 2.

    f0, f1 are the nominal acceleration at the start and the end of the period, with the torque applied in it. The error
    has its poles at exp(s_i T); there is no stability border below the Nyquist frequency.
    """
    return velocity_exact_of_poles(velocity_poles(bandwidth, shape), sample_time_s)


def velocity_exact_of_poles(poles: Poles, sample_time_s: float) -> tuple[Matrix, Matrix, Matrix, Matrix]:
    """Return the matrices of `velocity_exact` for three continuous poles s_i [rad/s] of the estimation error.

    With prod(z - exp(s_i T)) = (z-1)^3 + c2 (z-1)^2 + c1 (z-1) + c0 the gain is [c2 - c1/2 + c0/3, c1 - c0, c0] / [T, T^2, T^3].
    """
    t = sample_time_s
    c0, c1, c2 = polynomial_of(np.expm1(np.asarray(poles, dtype=complex) * t))
    gain = np.array([(c2 - c1 / 2.0 + c0 / 3.0) / t, (c1 - c0) / t**2, c0 / t**3])
    phi = np.array([[1.0, t, t * t / 2.0], [0.0, 1.0, t], [0.0, 0.0, 1.0]])
    return phi - np.outer(gain, [t, t**2 / 2.0, t**3 / 6.0]), -gain, gain * t / 2.0, gain * t / 2.0


def velocity_first_order_hold(
    bandwidth: float, sample_time_s: float, shape: VelocityShape = "multiple"
) -> tuple[Matrix, Matrix, Matrix, Matrix]:
    """Return the same matrices for Eq. (22), sampled with v and f held to first order."""
    return velocity_first_order_hold_of_poles(velocity_poles(bandwidth, shape), sample_time_s)


def velocity_first_order_hold_of_poles(poles: Poles, sample_time_s: float) -> tuple[Matrix, Matrix, Matrix, Matrix]:
    """Return the matrices of `velocity_first_order_hold` for three continuous poles s_i: s^3 + g0 s^2 + g1 s + g2.

    With a = d + G v, a' = F a + G f - F G v: d+ = e^(FT) d + (integrals of f) - (integral of e^(F tau)) G (v+ - v) / T. A
    constant v cancels, so only its change is left.
    """
    t = sample_time_s
    g2, g1, g0 = polynomial_of(poles)
    radius = g2 ** (1.0 / 3.0)
    scale = radius ** np.arange(3.0)
    gains = np.array([g0, g1, g2]) / scale
    augmented = np.zeros((5, 5))
    augmented[:3, 0] = -gains * t
    augmented[0, 1] = augmented[1, 2] = radius * t
    augmented[:3, 3] = gains * t  # input held over the period
    augmented[3, 4] = 1.0  # and its change over it, as a ramp
    change = exponential_less_identity(augmented)
    transition = np.eye(3) + change[:3, :3]
    held, ramp = scale * change[:3, 3], scale * change[:3, 4]
    return scale[:, None] * transition / scale, -held / t, held - ramp, ramp


def position_form(
    bandwidth: float, damping_rate: float, sample_time_s: float, shape: PositionShape = "multiple"
) -> tuple[Matrix, Matrix, Matrix, Matrix]:
    """Return A (5x5), B0, B1, M (5) of the observer of x = [theta, w, d, d', d''] on measured positions.

    x- = A x + B0 phi0 + B1 phi1;  x = x- + M (theta - x-[0]).  w' = -damping_rate w + phi - d, d''' = 0, exact for phi held
    to first order; M places five poles at exp(s_i T) in the current form, so it adds no delay. `kalman` is optimal without
    damping, and as good as optimal while damping_rate is well below g.
    """
    return position_form_of_poles(position_poles(bandwidth, shape), damping_rate, sample_time_s)


def position_form_of_poles(
    poles: Poles, damping_rate: float, sample_time_s: float
) -> tuple[Matrix, Matrix, Matrix, Matrix]:
    """Return the matrices of `position_form` for five continuous poles s_i [rad/s], sampled as exp(s_i T).

    Worked out in states scaled by the sample time, [theta, T w, T^2 d, ...]; A - I and z - 1 keep what a short sample changes.
    """
    p1, p2, p3, p4 = _integrals(-damping_rate * sample_time_s)
    change = np.array(
        [
            [0.0, p1, -p2, -p3, -p4],
            [0.0, -damping_rate * sample_time_s * p1, -p1, -p2, -p3],
            [0.0, 0.0, 0.0, 1.0, 0.5],
            [0.0, 0.0, 0.0, 0.0, 1.0],
            [0.0, 0.0, 0.0, 0.0, 0.0],
        ]
    )
    measured = change[0] + [1.0, 0.0, 0.0, 0.0, 0.0]
    rows = [measured]
    for _ in range(4):
        rows.append(rows[-1] @ change)
    gain = np.linalg.solve(np.array(rows), [0.0, 0.0, 0.0, 0.0, 1.0])
    vectors = [gain]
    for _ in range(5):
        vectors.append(change @ vectors[-1])
    m = np.append(polynomial_of(np.expm1(np.asarray(poles, dtype=complex) * sample_time_s)), 1.0) @ np.array(vectors)
    scale = sample_time_s ** np.arange(5.0)
    level, ramp = np.zeros(5), np.zeros(5)
    level[:2], ramp[:2] = (p2, p1), (p3, p2)
    level, ramp = level * sample_time_s**2 / scale, ramp * sample_time_s**2 / scale
    return np.eye(5) + change * scale / scale[:, None], level - ramp, ramp, m / scale


def _integrals(x: float) -> tuple[float, float, float, float]:
    """Return (e^x - 1) / x and the next three of the sequence p_(n+1) = (p_n - 1/n!) / x, with their limits 1/n! at 0."""
    if abs(x) > 1.0:
        p1 = math.expm1(x) / x
        p2 = (p1 - 1.0) / x
        p3 = (p2 - 0.5) / x
        return p1, p2, p3, (p3 - 1.0 / 6.0) / x
    p4 = 0.0
    for n in range(20, 3, -1):
        p4 = p4 * x + 1.0 / math.factorial(n)
    p3 = 1.0 / 6.0 + x * p4
    p2 = 0.5 + x * p3
    return 1.0 + x * p2, p2, p3, p4
