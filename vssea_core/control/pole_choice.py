"""Where to put the poles: prototypes, and the quadruple pole that meets a settling time or a bandwidth."""

import math

import numpy as np
from numpy.typing import NDArray


def butterworth_poles(order: int, radius: float) -> NDArray[np.complex128]:
    """Return the `order` poles [rad/s] of a Butterworth filter, on a circle of `radius` rad/s in the left half-plane."""
    angles = math.pi * (0.5 + (np.arange(order) + 0.5) / order)
    poles: NDArray[np.complex128] = radius * np.exp(1j * angles)
    if order % 2:
        poles[order // 2] = -radius
    return poles


def pole_for_settling_time(seconds: float, band: float = 0.02) -> float:
    """Return the quadruple pole p [rad/s] whose step response stays within `band` of its final value from `seconds` on.

    The step response is 1 - exp(-x) (1 + x + x^2/2 + x^3/6) with x = p t. Raises ValueError unless seconds > 0, 0 < band < 1.
    """
    if not seconds > 0.0:
        raise ValueError(f"the settling time is {seconds:g} s; expected more than 0 s")
    if not 0.0 < band < 1.0:
        raise ValueError(f"the settling band is {band:g}; expected a share of the step between 0 and 1, such as 0.02")
    low, high = 0.0, 800.0
    while high - low > 1e-13 * high:
        x = 0.5 * (low + high)
        if math.exp(-x) * (1.0 + x * (1.0 + x / 2.0 * (1.0 + x / 3.0))) > band:
            low = x
        else:
            high = x
    return high / seconds


def pole_for_bandwidth(bandwidth: float) -> float:
    """Return the quadruple pole p [rad/s] of the four-fold lag 1/(1 + s/p)^4 that is 3 dB down at `bandwidth` [rad/s].

    |1 + j w/p|^4 = sqrt(2), so p = w / sqrt(2^(1/4) - 1). Raises ValueError unless bandwidth > 0.
    """
    if not bandwidth > 0.0:
        raise ValueError(f"the bandwidth is {bandwidth:g} rad/s; expected more than 0 rad/s")
    return bandwidth / math.sqrt(2.0**0.25 - 1.0)
