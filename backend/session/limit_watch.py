"""Notices limits as they begin, from the ring; a limit that comes and goes is told once a second at most."""

import numpy as np

from backend.telemetry.ring import EPOCH, RingReader
from vssea_core.channels import INDEX, LIMITS

QUIET_S = 1.0


class LimitWatch:
    """Reads on from where it stopped."""

    def __init__(self, ring: RingReader) -> None:
        self._ring = ring
        self._next = 0
        self._last_active: dict[int, tuple[int, float]] = {}

    def begun(self) -> list[tuple[int, float, str]]:
        """Return epoch, time [s] and sentence of each limit that became active since the last call."""
        piece = self._ring.since(self._next)
        self._next = piece.first + len(piece.samples)
        found = []
        for limit in LIMITS:
            active = np.flatnonzero(piece.samples[:, INDEX["limits"]].astype(np.int64) & limit.bit)
            if not len(active):
                continue
            first, last = piece.samples[active[0]], piece.samples[active[-1]]
            epoch, time_s = int(first[EPOCH]), float(first[INDEX["time"]])
            before = self._last_active.get(limit.bit)
            if before is None or before[0] != epoch or time_s - before[1] > QUIET_S:
                found.append((epoch, time_s, limit.sentence))
            self._last_active[limit.bit] = int(last[EPOCH]), float(last[INDEX["time"]])
        return found
