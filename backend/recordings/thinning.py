"""A picture of many samples in few points: of each span of time the least and the greatest sample, in their order."""

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.float64]


def thinned(values: Numbers, spans: int) -> Numbers:
    """Return values (n, channels) as pairs (2 * spans, channels): least and greatest of each of `spans` equal runs of rows.

    n must be at least `spans`. NaN counts as no value; a run of nothing else gives NaN.
    """
    borders = np.linspace(0, len(values), spans + 1).astype(np.intp)
    starts = borders[:-1]
    pairs = np.empty((2 * spans, values.shape[1]))
    low = np.fmin.reduceat(values, starts, axis=0)
    high = np.fmax.reduceat(values, starts, axis=0)
    rises = values[starts] <= values[borders[1:] - 1]  # of a run that rises the least comes first
    pairs[0::2] = np.where(rises, low, high)
    pairs[1::2] = np.where(rises, high, low)
    return pairs
