"""How much a batch may be: runs, bytes, and how many may wait."""

import math
from dataclasses import dataclass

from backend.problem import Problem, refused
from backend.settings import Settings
from vssea_core.batch.document import Batch, count_of
from vssea_core.field_errors import FieldError


def runs_of(batch: Batch) -> int:
    """Return how many runs a batch has."""
    return math.prod(count_of(variation) for variation in batch.vary)


class TooLarge(RuntimeError):
    """The results have become larger than they may."""


@dataclass(frozen=True)
class Limits:
    """What the settings allow."""

    runs: int
    bytes: float
    waiting: int

    @classmethod
    def of(cls, settings: Settings) -> "Limits":
        """Return the limits that the settings name."""
        return cls(settings.batch_most_runs, 1e9 * settings.batch_most_gb, settings.batch_waiting)

    def check_runs(self, runs: int) -> None:
        """Raise Problem if a batch has too many runs."""
        if runs > self.runs:
            expected = f"expected at most {self.runs:,} runs"
            raise refused(
                f"The batch has {runs:,} runs; {expected}. Vary less, or raise VSSEA_BATCH_MOST_RUNS.",
                FieldError("vary", runs, expected),
            )

    def check_bytes(self, size: float) -> None:
        """Raise Problem if results of about `size` bytes are too many."""
        if size > self.bytes:
            expected = f"expected at most {self.bytes / 1e9:g} GB"
            raise refused(
                f"The results would take about {size / 1e9:.3g} GB; {expected}. Keep fewer trajectories or samples, "
                "or raise VSSEA_BATCH_MOST_GB.",
                FieldError("keep", size, expected),
            )

    def check_waiting(self, count: int) -> None:
        """Raise Problem if `count` batches wait already, and no more may."""
        if count >= self.waiting:
            raise Problem(
                429,
                "Too many batches",
                f"{count} batches are waiting; cancel one, wait for one, or raise VSSEA_BATCH_WAITING.",
            )

    def check_kept(self, size: int) -> None:
        """Raise TooLarge if `size` bytes of results are more than there may be."""
        if size > self.bytes:
            raise TooLarge(
                f"its results take more than {self.bytes / 1e9:g} GB; keep fewer samples, or raise VSSEA_BATCH_MOST_GB"
            )
