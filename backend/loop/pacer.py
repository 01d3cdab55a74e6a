"""The clock of the loop: absolute due times, so that lateness does not add up; clock and sleep are injected."""

import time
from collections.abc import Callable


class Pacer:
    """Waits for due times one interval apart and counts whole intervals that were missed."""

    def __init__(
        self, clock: Callable[[], float] = time.monotonic, sleep: Callable[[float], None] = time.sleep
    ) -> None:
        self._clock, self._sleep = clock, sleep
        self._due = clock()
        self.overruns = 0

    def restart(self) -> None:
        """Start counting from now, as after a pause."""
        self._due = self._clock()

    def wait(self, interval_s: float) -> float:
        """Sleep until `interval_s` after the last due time; return how late it became [s].

        Missed intervals are counted and left out, never run back to back.
        """
        self._due += interval_s
        ahead = self._due - self._clock()
        if ahead > 0.0:
            self._sleep(ahead)
        late = self._clock() - self._due
        missed = int(late / interval_s)
        if missed >= 1:
            self.overruns += missed
            self._due += missed * interval_s
        return late
