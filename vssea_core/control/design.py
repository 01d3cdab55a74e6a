"""Gains from poles: Eqs. (9), (14). `control.place` refuses repeated poles with one input; polynomials do not."""

import numpy as np
from numpy.typing import NDArray


def state_feedback_gains(natural_frequency: float, damping: float) -> NDArray[np.float64]:
    """Return K (4) of e' = (Gamma - b K^T) e with the characteristic polynomial (s^2 + 2 zeta p s + p^2)^2.

    At damping 1 this is [p^4, 4 p^3, 6 p^2, 4 p], the quadruple pole -p. Units: rad/s^4 per rad, rad/s, ...
    """
    pair = np.array([1.0, 2.0 * damping * natural_frequency, natural_frequency**2])
    return np.polymul(pair, pair)[:0:-1]


def surface_gains(surface_pole: float) -> NDArray[np.float64]:
    """Return s1, s2, s3 of (s + lambda)^3 = s^3 + s3 s^2 + s2 s + s1: the motion on sigma = 0, Eq. (14)."""
    return np.array([surface_pole**3, 3.0 * surface_pole**2, 3.0 * surface_pole])
