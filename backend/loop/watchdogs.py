"""Signs of life that the loop waits for: the server's and the operator's page. The clock is injected."""

from collections.abc import Callable

from backend.rigs.faults import LEASE_EXPIRED, WEB_SILENT, Fault
from backend.telemetry.beats import LEASE, LEASE_S, WEB, Beats

WEB_S = 0.25


class Watchdogs:
    """Sees whether the counts of `beats` move. It only looks; nothing it does feeds them."""

    def __init__(self, beats: Beats, clock: Callable[[], float]) -> None:
        self._beats, self._clock = beats, clock
        now = clock()
        self._counts = [beats.count(WEB), beats.count(LEASE)]
        self._moved_s = [now, now - LEASE_S]  # a lease begins with its first renewal

    def look(self) -> None:
        """Note which counts have moved since the last look."""
        for which in (WEB, LEASE):
            count = self._beats.count(which)
            if count != self._counts[which]:
                self._counts[which], self._moved_s[which] = count, self._clock()

    def silent_s(self, which: int) -> float:
        """Return how long [s] a count has stood still."""
        return self._clock() - self._moved_s[which]

    @property
    def lease_left_s(self) -> float:
        """Time [s] until the lease expires; 0 = it has."""
        return max(0.0, LEASE_S - self.silent_s(LEASE))

    def expired(self) -> Fault | None:
        """Return what has been silent for too long, or None."""
        if self.silent_s(WEB) >= WEB_S:
            return WEB_SILENT
        if self.silent_s(LEASE) >= LEASE_S:
            return LEASE_EXPIRED
        return None
