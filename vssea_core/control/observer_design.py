"""Discrete matrices of the disturbance observers (20)-(24), one channel each.

Lambda_a of Eq. (21) is a 3x3 block (x) I_4: it splits exactly into one observer a channel, and only the channels of link
and motor carry disturbances. The estimates d, d', d'' are kept instead of the auxiliary variables a = d + G v, so a change
of bandwidth leaves them where they are.
"""

import math

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

Matrix = NDArray[np.float64]


def chain(order: int, time: float) -> Matrix:
    """Return exp(N t) of a chain of `order` integrators: entry (i, j) is t^(j-i) / (j-i)!."""
    powers = [time**n / math.factorial(n) for n in range(order)]
    return np.array([[powers[j - i] if j >= i else 0.0 for j in range(order)] for i in range(order)])


def velocity_exact(bandwidth: float, sample_time_s: float) -> tuple[Matrix, Matrix, Matrix, Matrix]:
    """Return A (3x3), h, b0, b1 (3) of d+ = A d + h (v+ - v) + b0 f0 + b1 f1, without bias for d up to degree 2.

    f0, f1 are the nominal acceleration at the start and the end of the period, with the torque applied in it. The error
    has its triple pole at exp(-g T); there is no stability border below the Nyquist frequency.
    """
    t = sample_time_s
    phi = chain(3, t)
    c = np.array([t, t**2 / 2, t**3 / 6])
    z = math.exp(-bandwidth * t)
    gain = np.array([(1 - z) * (2 * z * z + 5 * z + 11) / (6 * t), (1 - z) ** 2 * (z + 2) / t**2, (1 - z) ** 3 / t**3])
    return phi - np.outer(gain, c), -gain, gain * t / 2, gain * t / 2


def velocity_first_order_hold(bandwidth: float, sample_time_s: float) -> tuple[Matrix, Matrix, Matrix, Matrix]:
    """Return the same matrices for Eq. (22), sampled with v and f held to first order.

    With a = d + G v and a' = F a + G f + H v: d+ = e^(FT) (d + G v) + (integrals of f and v) - G v+. A constant v cancels,
    so only its change is left.
    """
    g, t = bandwidth, sample_time_s
    gains = np.array([3 * g, 3 * g * g, g**3])
    f = np.array([[-gains[0], 1.0, 0.0], [-gains[1], 0.0, 1.0], [-gains[2], 0.0, 0.0]])
    h = np.array([gains[0] ** 2 - gains[1], gains[1] * gains[0] - gains[2], gains[2] * gains[0]])
    augmented = np.zeros((7, 7))
    augmented[:3, :3] = f * t
    augmented[:3, 3], augmented[:3, 4] = gains * t, h * t  # inputs f and v at the start of the period
    augmented[3, 5] = augmented[4, 6] = 1.0  # and their changes over it, as ramps
    transition = expm(augmented)
    b_slope, v_slope = transition[:3, 5], transition[:3, 6]
    return transition[:3, :3], v_slope - gains, transition[:3, 3] - b_slope, b_slope


def position_form(bandwidth: float, damping_rate: float, sample_time_s: float) -> tuple[Matrix, Matrix, Matrix, Matrix]:
    """Return A (5x5), B0, B1, M (5) of the observer of x = [theta, w, d, d', d''] on measured positions.

    x- = A x + B0 phi0 + B1 phi1;  x = x- + M (theta - x-[0]).  w' = -damping_rate w + phi - d, d''' = 0, exact for phi held
    to first order; M places five poles at exp(-g T) in the current form, so it adds no delay.
    """
    t = sample_time_s
    a = np.diag([1.0, -1.0, 1.0, 1.0], 1)
    a[1, 1] = -damping_rate
    augmented = np.zeros((7, 7))
    augmented[:5, :5] = a * t
    augmented[1, 5] = t
    augmented[5, 6] = 1.0
    transition = expm(augmented)
    discrete, b_level, b_slope = transition[:5, :5], transition[:5, 5], transition[:5, 6]
    return discrete, b_level - b_slope, b_slope, _five_poles(discrete, math.exp(-bandwidth * t))


def _five_poles(discrete: Matrix, pole: float) -> Matrix:
    """Return M for which (I - M C) A has all five eigenvalues at `pole` (Ackermann's formula on (A, C A))."""
    measured = np.zeros(5)
    measured[0] = 1.0
    rows = [measured @ discrete]
    for _ in range(4):
        rows.append(rows[-1] @ discrete)
    scale = np.linalg.norm(rows[0])
    polynomial = np.linalg.matrix_power(discrete - pole * np.eye(5), 5)
    last = np.zeros(5)
    last[4] = 1.0 / scale
    gain: Matrix = polynomial @ np.linalg.solve(np.array(rows) / scale, last)
    return gain
