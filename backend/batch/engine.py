"""What computes the parts of a batch: this machine's processes or a cluster's, behind one protocol."""

from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True)
class PartTask:
    """Runs `first` to `first + count` of the batch whose document this is (JSON); `number` is the part's place."""

    document: str
    number: int
    first: int
    count: int


@dataclass(frozen=True)
class PartFiles:
    """A computed part: its two Parquet files (`trajectories` is empty if no samples were kept), and its runs by state."""

    rows: bytes
    trajectories: bytes
    counts: dict[str, int]


class PartFailed(RuntimeError):
    """A part could not be computed; the text says why. Tried again, it may fail again."""


class WorkerLost(RuntimeError):
    """The worker of a part is gone; another one computes the same bits."""


class Engine(Protocol):
    """Computes parts, up to `workers` of them at a time."""

    @property
    def name(self) -> str:
        """Where it computes, in words."""

    @property
    def workers(self) -> int:
        """How many parts may be under way now."""

    async def run(self, part: PartTask) -> PartFiles:
        """Return a computed part. Raises PartFailed, WorkerLost; a cancelled part ends early, within 0.2 s."""

    def process_ids(self) -> list[int]:
        """Return the numbers of its processes on this machine."""

    async def end(self) -> None:
        """End what it has started."""
