"""What bounds the estimation error of a disturbance observer: under a bounded d''', and after a wrong start (Eq. 24)."""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from vssea_core.control.design import Poles, polynomial_of
from vssea_core.control.peak_gain import peak_gain

Numbers = NDArray[np.float64]


def estimation_bounds(poles: Poles, snap_of_disturbance: float) -> Numbers:
    """Return the largest errors (3,) of d^, d'^, d''^ while |d'''| <= `snap_of_disturbance` [rad/s^5], at short samples.

    Exact peak gains of the observer's error with three (velocity form) or five continuous `poles`; for a multiple pole they
    are the steady errors, c/g^3, 3c/g^2, 3c/g or 10c/g^3, 10c/g^2, 5c/g.
    """
    polynomial = polynomial_of(poles)
    highest_first = np.append(polynomial, 1.0)[::-1]
    order = len(polynomial)
    numerators = [highest_first[: order - 2 + i][::-1] for i in range(3)]
    return snap_of_disturbance * np.array([peak_gain(numerator, polynomial) for numerator in numerators])


def transient_constant(poles: Poles, decay: float) -> float:
    """Return the smallest M of |x(t)| <= M exp(-decay t) |x(0)|, Eq. (24), for the error of a velocity observer.

    x = [d, d', d''] errors, scaled as x_i / g^i with g^3 the product of the three `poles`; M >= 1. A triple pole at -g has a
    finite M only for decay < g. Raises ValueError if decay is not below that of the slowest pole.
    """
    polynomial = polynomial_of(poles)
    slowest = -max(pole.real for pole in poles)
    if not decay < slowest:
        raise ValueError(
            f"a decay of {decay:g} 1/s was asked for; expected less than {slowest:g} 1/s, the slowest pole's"
        )
    g = float(polynomial[0]) ** (1.0 / 3.0)
    error = np.diag(np.ones(2), 1)
    error[:, 0] = -polynomial[::-1] / g ** np.arange(1.0, 4.0)
    return _largest_norm(error + decay / g * np.eye(3), (slowest - decay) / g)


def _largest_norm(matrix: Numbers, decay: float) -> float:
    """Return the largest 2-norm of exp(matrix t) over t >= 0, for a slowest decay given in the same unit of time."""
    step = 0.01 / max(1.0, float(np.abs(np.linalg.eigvals(matrix)).max()))
    count = int(np.ceil(12.0 / min(decay, 1.0) / step))
    power, stack = expm(matrix * step), np.eye(len(matrix))[None]
    while len(stack) < count:
        stack = np.concatenate([stack, power @ stack])
        power = power @ power
    return float(np.linalg.norm(stack, ord=2, axis=(1, 2)).max())
