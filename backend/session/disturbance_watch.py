"""Notices when timed disturbances begin and end, so that they have a mark on the plots."""

from backend.telemetry.ring import EPOCH, RingReader
from vssea_core.channels import INDEX
from vssea_core.signals.documents import Disturbances


class DisturbanceWatch:
    """Compares the newest sample's time with the time it last saw."""

    def __init__(self, ring: RingReader) -> None:
        self._ring = ring
        self._seen: tuple[int, float] | None = None

    def passed(self, disturbances: Disturbances) -> list[tuple[int, float, str]]:
        """Return epoch, time [s] and words of each start and end since the last call."""
        newest = self._ring.latest()
        if newest is None:
            return []
        epoch, now = int(newest[EPOCH]), float(newest[INDEX["time"]])
        before = self._seen[1] if self._seen is not None and self._seen[0] == epoch else 0.0
        self._seen = epoch, now
        moments = {
            (time_s, f"{side} disturbance {word}")
            for side, terms in (
                ("link", disturbances.link),
                ("motor", disturbances.motor),
                ("stiffness motor", disturbances.stiffness_motor),
            )
            for term in terms
            for time_s, word in ((term.start_s, "on"), (term.end_s, "off"))
            if time_s is not None and before < time_s <= now
        }
        return [(epoch, time_s, words) for time_s, words in sorted(moments)]
