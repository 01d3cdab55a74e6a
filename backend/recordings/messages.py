"""What travels between the web process and the writer: what happened down, what was written up."""

from dataclasses import dataclass
from typing import Any

from backend.recordings.chunks import Document


@dataclass(frozen=True)
class Begin:
    """A run began at t = 0: the metadata of its recording and the scenario that it starts with."""

    number: int
    epoch: int
    head: dict[str, str]
    scenario: dict[str, Any]
    tuning_id: int


@dataclass(frozen=True)
class Note:
    """Something to keep beside the samples of a run; a change also names the part of the scenario that it replaces."""

    number: int
    epoch: int
    document: Document


@dataclass(frozen=True)
class Hold:
    """Stop recording, and why; None: go on."""

    number: int
    sentence: str | None


Item = Begin | Note | Hold


@dataclass(frozen=True)
class Wrote:
    """How far the writer is: all items up to `item` are on disk or need not be, all samples before `sample` as well."""

    item: int
    sample: int
    recording: str | None
    path: str | None
    size: int
    samples: int
    lost: int


@dataclass(frozen=True)
class Ended:
    """A recording is complete."""

    recording: str
    path: str


@dataclass(frozen=True)
class Stopped:
    """Recording stopped, and why; an empty sentence: it goes on."""

    sentence: str


Answer = Wrote | Ended | Stopped
