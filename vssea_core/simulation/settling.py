"""When a signal is within a band for good: settling after a step, recovery after a disturbance."""

import numpy as np
from numpy.typing import NDArray

Samples = NDArray[np.float64]


def settled_at(time: Samples, deviation: Samples, band: float) -> float | None:
    """Return the time from which |deviation| <= `band` to the end of the record, or None if it ends outside.

    `time` [s] and `deviation` are (samples,), `band` in the deviation's unit; between samples it is a straight line.
    """
    outside = np.flatnonzero(~(np.abs(deviation) <= band))
    if not len(outside):
        return float(time[0]) if len(time) else None
    last = int(outside[-1])
    if last + 1 == len(time):
        return None
    before, after = float(deviation[last]), float(deviation[last + 1])
    share = (abs(before) - band) / abs(before - after) if np.isfinite(before) else 1.0
    return float(time[last] + share * (time[last + 1] - time[last]))


def recovery_time(time: Samples, error: Samples, disturbance_time: float, band: float) -> float | None:
    """Return the seconds from `disturbance_time` [s] until |error| <= `band` [rad] for the rest of the record.

    0 if the error never leaves the band; None if it is outside at the end, or nothing was recorded from then on.
    `time` and `error` are (samples,).
    """
    since = time >= disturbance_time - 1e-9
    if not np.any(since):
        return None
    settled = settled_at(time[since], error[since], band)
    return None if settled is None else max(0.0, settled - disturbance_time)
