"""A marked span of a recording: a pinned run, what a trigger captured, or what led to a fault; and who keeps them."""

from dataclasses import asdict, dataclass, field, replace
from itertools import count
from typing import Any, Literal, Protocol


@dataclass(frozen=True)
class Excerpt:
    """The span [from_s, to_s] of the run that `recording` holds; `at_s` is what fired a trigger, or the fault.

    `period_s` is the period of the reference then, `words` how its tuning differs from that of the excerpt before it,
    `metrics` are figures of the span by name, `tuning` is the tuning as JSON takes it.
    """

    recording: str | None
    kind: Literal["pin", "trigger", "fault"]
    label: str
    from_s: float
    to_s: float
    by: str
    created_at: str
    at_s: float | None = None
    shown: bool = True
    period_s: float | None = None
    words: tuple[str, ...] = ()
    metrics: dict[str, float] = field(default_factory=dict)
    tuning: dict[str, Any] = field(default_factory=dict)
    id: int = 0

    def document(self) -> dict[str, Any]:
        """Return it as docs/protocol.md has it."""
        return asdict(self)


class Recordings(Protocol):
    """Who knows which recording is being written."""

    def of_run(self, epoch: int) -> str | None:
        """Return the id of the recording of a run, None if it is not recorded."""


class ExcerptStore(Protocol):
    """Keeps excerpts beyond a restart. Its methods may wait for a disk, so they are called in threads. They raise Problem."""

    def list(self) -> list[Excerpt]:
        """Return all, oldest first."""

    def add(self, excerpt: Excerpt) -> Excerpt:
        """Keep one and return it with its id."""

    def change(self, excerpt: Excerpt) -> None:
        """Keep another label, or whether it is shown."""

    def remove(self, number: int) -> None:
        """Forget one."""


class NoRecordings:
    """Nothing is recorded."""

    def of_run(self, epoch: int) -> str | None:
        """Return None."""


class ExcerptsInMemory:
    """Excerpts that end with the server."""

    def __init__(self) -> None:
        self._excerpts: dict[int, Excerpt] = {}
        self._numbers = count(1)

    def list(self) -> list[Excerpt]:
        """Return all, oldest first."""
        return list(self._excerpts.values())

    def add(self, excerpt: Excerpt) -> Excerpt:
        """Keep one and return it with its id."""
        kept = replace(excerpt, id=next(self._numbers))
        self._excerpts[kept.id] = kept
        return kept

    def change(self, excerpt: Excerpt) -> None:
        """Keep another label, or whether it is shown."""
        self._excerpts[excerpt.id] = excerpt

    def remove(self, number: int) -> None:
        """Forget one."""
        self._excerpts.pop(number, None)
