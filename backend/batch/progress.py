"""How far a batch is: its runs by state, the rate of those computed since it was begun or taken up again, the time left."""

import time
from collections import Counter
from collections.abc import Callable, Iterable
from typing import Any

STATES = ("done", "ended", "refused")


def summed(parts: Iterable[dict[str, int]]) -> dict[str, int]:
    """Return the runs by state of several parts together."""
    total = Counter[str]()
    for counts in parts:
        total.update(counts)
    return dict(total)


class RunCounts:
    """Counts the runs of one batch as its parts come in."""

    def __init__(
        self,
        runs: int,
        parts: int,
        kept: dict[str, int],
        kept_parts: int,
        clock: Callable[[], float] = time.monotonic,
        threads: int = 1,
    ) -> None:
        self.runs, self.parts, self.parts_done = runs, parts, kept_parts
        self.counts = Counter(dict.fromkeys(STATES, 0) | kept)
        self._clock, self._warm_at = clock, kept_parts + max(1, threads)
        self._since_s, self._latest_s, self._new = clock(), clock(), 0
        self._first_rate: float | None = None

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
        self._latest_s, self._new = self._clock(), self._new + sum(counts.values())
        if self.parts_done == self._warm_at and self.parts_done < self.parts:
            # The first part of each thread waits for its start, and says little of the others.
            self._first_rate = self._rate()
            self._since_s, self._new = self._latest_s, 0

    @property
    def rate(self) -> float | None:
        """Runs computed in a second; None before the first part."""
        return self._rate() or self._first_rate

    def document(self) -> dict[str, Any]:
        """Return it as REST gives it."""
        rate, left = self.rate, self.runs - self.done
        seconds_left = None if rate is None else left / rate - (self._clock() - self._latest_s)
        if seconds_left is not None and seconds_left <= 0.0:
            seconds_left = None if left else 0.0  # nothing has come for longer than all was to take
        return {
            "progress": {
                "done": self.done, "runs": self.runs, "parts_done": self.parts_done, "parts": self.parts,
                "share": self.share,
            },
            "counts": dict(self.counts), "rate": rate, "seconds_left": seconds_left,
        }  # fmt: skip

    def _rate(self) -> float | None:
        seconds = self._latest_s - self._since_s
        return self._new / seconds if self._new and seconds > 0.0 else None
