"""What computes the parts of a batch: this machine's processes or a cluster's, behind one protocol."""

from dataclasses import dataclass, field
from typing import Protocol

from backend.batch.version import model_version


@dataclass(frozen=True)
class PartTask:
    """Runs `first` to `first + count` of the batch whose document this is (JSON); `number` is the part's place.

    `version` is that of the model of whoever asks; a worker of another one refuses.
    """

    document: str
    number: int
    first: int
    count: int
    version: str = field(default_factory=model_version)

    def check_version(self, worker: str, remedy: str) -> None:
        """Raise PartRefused if `worker`, which is this process, has another version of the model."""
        if self.version != model_version():
            raise PartRefused(
                f"{worker} runs version {model_version()} of the model, whoever asks runs {self.version}; {remedy}"
            )


@dataclass(frozen=True)
class PartFiles:
    """A computed part: its two Parquet files (`trajectories` is empty if no samples were kept), and its runs by state."""

    rows: bytes
    trajectories: bytes
    counts: dict[str, int]


class PartFailed(RuntimeError):
    """A part could not be computed; the text says why. Tried again, it may fail again."""


class PartRefused(PartFailed):
    """A part that would fail however often it is tried."""


class OutOfReach(PartFailed):
    """What computes is not to be had now."""


class WorkerLost(RuntimeError):
    """The worker of a part is gone; another one computes the same bits."""


class Engine(Protocol):
    """Computes parts, `threads` of them at the same time."""

    @property
    def name(self) -> str:
        """Where it computes, in words."""

    @property
    def threads(self) -> int:
        """How many parts are computed at the same time, 1 if that is not known."""

    @property
    def at_a_time(self) -> int:
        """How many parts may be given out now: at least `threads`."""

    @property
    def waiting_for(self) -> str:
        """What has to be there before a part can be computed, in words; "" if nothing is missing."""

    async def connect(self) -> None:
        """Make `threads` known. Raises OutOfReach."""

    async def run(self, part: PartTask) -> PartFiles:
        """Return a computed part. Raises PartFailed or one of its kinds, WorkerLost; a cancelled part ends early, within 0.2 s."""

    def process_ids(self) -> list[int]:
        """Return the numbers of its processes on this machine."""

    async def end(self) -> None:
        """End what it has started."""
