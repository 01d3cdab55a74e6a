"""How a piece of work is timed: best and median of several calls."""

import statistics
import time
from collections.abc import Callable


def timed(work: Callable[[], object], repeats: int) -> tuple[float, float]:
    """Return best and median time [s] of `work`, after one call that is not counted."""
    work()
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times), statistics.median(times)
