"""The largest output that a bounded input can cause: the L1 norm of an impulse response."""

import math

import numpy as np
from numpy.typing import NDArray

from vssea_core.control.matrix_exponential import exponential_less_identity

Numbers = NDArray[np.float64]

BLOCK = 2048
STEP = 0.05
"""Sample distance in units of 1/|fastest pole|: there Taylor's series about a sample locates every zero crossing."""
TIME_CONSTANTS = 60.0
MOST_BLOCKS = 1000


def peak_gain(numerator: Numbers, denominator: Numbers) -> float:
    """Return the integral of |h(t)| dt, the exact peak gain |y| <= gain * max |w|, for y = numerator / denominator w.

    Coefficients lowest power first; `denominator` (n,) is monic and its s^n left out, as in `polynomial_of`; `numerator` has
    at most n. Raises ValueError if a pole is not in the left half-plane, or if poles lie more than about 2000 times apart.
    """
    order = len(denominator)
    radius = float(abs(denominator[0])) ** (1.0 / order) or 1.0
    scaled = np.asarray(denominator) / radius ** np.arange(order, 0.0, -1.0)
    output = np.zeros(order)
    output[: len(numerator)] = np.asarray(numerator) / radius ** np.arange(order, order - len(numerator), -1.0)
    chain = np.diag(np.ones(order - 1), 1)
    chain[-1] = -scaled
    poles = np.linalg.eigvals(chain)
    fastest, slowest = float(np.abs(poles).max()), float(-poles.real.max())
    if not slowest > 0.0:
        raise ValueError("the response does not die out: a pole is not in the left half-plane; stabilise it first")
    step = STEP / fastest
    blocks = math.ceil(TIME_CONSTANTS / slowest / step / BLOCK)
    if blocks > MOST_BLOCKS:
        raise ValueError(
            f"the fastest pole is {fastest / slowest:.3g} times the slowest decay; expected at most about "
            f"{MOST_BLOCKS * BLOCK * STEP / TIME_CONSTANTS:.0f}, so move the poles closer together"
        )
    return _total_variation(chain, output, step, blocks)


def _total_variation(chain: Numbers, output: Numbers, step: float, blocks: int) -> float:
    """Return the integral of |output z| for z' = chain z from z = [0, ..., 0, 1]: the travel of its antiderivative."""
    order = len(chain)
    transition = np.eye(order) + exponential_less_identity(chain * step)
    states = np.zeros((order, 1))
    states[-1] = 1.0
    power = transition
    while states.shape[1] < BLOCK:
        states = np.hstack([states, power @ states])
        power = power @ power
    antiderivative = np.linalg.solve(chain.T, output)
    derivatives = [antiderivative]
    for _ in range(order + 4):
        derivatives.append(chain.T @ derivatives[-1])
    rows = np.array(derivatives)
    total = 0.0
    for _ in range(blocks):
        following = power @ states[:, :1]
        ends = np.hstack([states, following])
        height, slope = rows[:2] @ ends
        total += float(np.abs(np.diff(height)).sum())
        turning = np.flatnonzero(slope[:-1] * slope[1:] < 0.0)
        if len(turning):
            total += _overlooked(rows @ ends[:, turning], height[turning + 1], step)
        states = power @ states
    return total


def _overlooked(derivatives: Numbers, next_height: Numbers, step: float) -> float:
    """Return the travel that samples on either side of a turning point miss, with `derivatives` (m, n) at the first."""
    factorials = np.array([math.factorial(i) for i in range(len(derivatives))], dtype=float)
    height = (derivatives / factorials[:, None])[::-1]
    slope = (derivatives[1:] / factorials[:-1, None])[::-1]
    low, high = np.zeros(derivatives.shape[1]), np.full(derivatives.shape[1], step)
    for _ in range(50):
        middle = 0.5 * (low + high)
        same = np.polyval(slope, middle) * slope[-1] > 0.0
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    top, first = np.polyval(height, high), derivatives[0]
    return float((np.abs(top - first) + np.abs(next_height - top) - np.abs(next_height - first)).sum())
