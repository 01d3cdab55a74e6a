"""exp(X) - I of a small matrix: what is left of a short sample, without losing it beside the identity."""

import math

import numpy as np
from numpy.typing import NDArray

TERMS = 14
LARGEST_NORM = 0.5


def exponential_less_identity(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return exp(X) - I of a square matrix X (n, n) by Taylor's series, halving X first where it is large.

    With E = exp(X/2) - I, exp(X) - I = E (E + 2 I). At norm 1/2 the series is left with 0.5^15/15!, below rounding.
    """
    norm = float(np.abs(matrix).sum(axis=0).max())
    halvings = max(0, math.ceil(math.log2(norm / LARGEST_NORM))) if norm > LARGEST_NORM else 0
    small = matrix * 0.5**halvings
    identity = np.eye(len(matrix))
    series = identity + small / TERMS
    for n in range(TERMS - 1, 1, -1):
        series = identity + small @ series / n
    result: NDArray[np.float64] = small @ series
    for _ in range(halvings):
        result = result @ result + 2.0 * result
    return result
