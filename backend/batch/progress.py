"""How far a batch is: its runs by state, the rate of those computed since its begin or its latest start, the time left."""

import time
from collections import Counter
from collections.abc import Callable
from typing import Any

STATES = ("done", "ended", "refused")


class Progress:
    """Counts the runs of one batch as its parts come in."""

    def __init__(
        self, runs: int, parts: int, kept: dict[str, int], kept_parts: int, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self.runs, self.parts, self.parts_done = runs, parts, kept_parts
        self.counts = Counter(dict.fromkeys(STATES, 0) | kept)
        self._clock, self._begun_s, self._new, self._seconds = clock, clock(), 0, 0.0

    @property
    def done(self) -> int:
        """How many runs are computed and kept."""
        return self.counts.total()

    @property
    def share(self) -> float:
        """Which share of its runs is computed and kept."""
        return self.done / self.runs

    def add(self, counts: dict[str, int]) -> None:
        """Count the runs of a part."""
        self.counts.update(counts)
        self.parts_done += 1
        self._new += sum(counts.values())
        self._seconds = self._clock() - self._begun_s

    @property
    def rate(self) -> float | None:
        """Runs computed in a second since the start; None before the first part."""
        return self._new / self._seconds if self._new and self._seconds > 0.0 else None

    def document(self) -> dict[str, Any]:
        """Return it as REST gives it."""
        rate = self.rate
        left = None if rate is None else max(0.0, (self.runs - self.done) / rate - self._since_part())
        return {
            "progress": {
                "done": self.done, "runs": self.runs, "parts_done": self.parts_done, "parts": self.parts,
                "share": self.share,
            },
            "counts": dict(self.counts), "rate": rate, "seconds_left": left,
        }  # fmt: skip

    def _since_part(self) -> float:
        return self._clock() - self._begun_s - self._seconds
