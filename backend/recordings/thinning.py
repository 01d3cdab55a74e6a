"""A picture of many samples in few points: of each run of rows the least and the greatest value, in their order."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.float64]
Places = NDArray[np.intp]
AT_ONCE = 2_000_000
"""Values that are gathered at a time."""


@dataclass(frozen=True)
class Extremes:
    """Least and greatest value of each run and channel (runs, channels), and whether the least came first.

    NaN counts as no value; a run of nothing else has NaN for both.
    """

    low: Numbers
    high: Numbers
    low_first: NDArray[np.bool_]

    def pairs(self) -> Numbers:
        """Return both in the order in which they occurred, as rows (2 * runs, channels)."""
        pairs = np.empty((2 * len(self.low), self.low.shape[1]), self.low.dtype)
        pairs[0::2] = np.where(self.low_first, self.low, self.high)
        pairs[1::2] = np.where(self.low_first, self.high, self.low)
        return pairs


def extremes(values: Numbers, starts: Places) -> Extremes:
    """Return the Extremes of values (n, channels) in runs that begin at the rows `starts`; the last run ends with the rows."""
    return merged(values, values, np.ones(values.shape, bool), starts)


def merged(low: Numbers, high: Numbers, low_first: NDArray[np.bool_], starts: Places) -> Extremes:
    """Return the Extremes of runs of neighbouring extremes: least and greatest of them, and which came first."""
    ends = np.append(starts[1:], len(low))
    width = int((ends - starts).max(initial=0))
    step = max(1, AT_ONCE // max(1, width * low.shape[1]))
    parts = [
        _merged(low, high, low_first, starts[i : i + step], ends[i : i + step], width)
        for i in range(0, len(starts), step)
    ]
    if not parts:
        empty = np.empty((0, low.shape[1]))
        return Extremes(empty, empty, np.empty(empty.shape, bool))
    return Extremes(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def _merged(
    low: Numbers, high: Numbers, low_first: NDArray[np.bool_], starts: Places, ends: Places, width: int
) -> tuple[Numbers, Numbers, NDArray[np.bool_]]:
    # A shorter run repeats its last row, which changes neither its extremes nor where they first are.
    rows = np.minimum(starts[:, None] + np.arange(width), ends[:, None] - 1)
    lows = low[rows]
    highs = lows if high is low else high[rows]
    gone = np.isnan(lows)
    has_gone = bool(gone.any())
    least = (np.where(gone, np.inf, lows) if has_gone else lows).argmin(axis=1)[:, None]
    greatest = (np.where(gone, -np.inf, highs) if has_gone else highs).argmax(axis=1)[:, None]
    together = np.take_along_axis(low_first[rows], least, axis=1)
    first = np.where(least == greatest, together, least < greatest)[:, 0]
    found_low = np.take_along_axis(lows, least, axis=1)[:, 0]
    found_high = np.take_along_axis(highs, greatest, axis=1)[:, 0]
    if has_gone:  # beside NaN, a run may hold nothing but the infinity that stood in for it
        is_nothing = gone.all(axis=1)
        found_low = np.where(is_nothing, np.nan, np.where(np.isnan(found_low), np.inf, found_low))
        found_high = np.where(is_nothing, np.nan, np.where(np.isnan(found_high), -np.inf, found_high))
    return found_low, found_high, first
