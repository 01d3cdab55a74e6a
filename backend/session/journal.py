"""What a session tells of itself as it happens; a recorder hears it. A journal that fails never harms the session."""

import logging
from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any, Protocol

from backend.session.events import Event
from vssea_core.scenario import Scenario

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Run:
    """A run that began at t = 0; `scenario` is as it stands there, before its sequence changes it."""

    epoch: int
    scenario: Scenario
    tuning_id: int
    wall_time: str
    rig: str = "simulated"
    """Of which kind: simulated, emulated or real."""


@dataclass(frozen=True)
class Change:
    """A part of the scenario that is another one from `at_s` on.

    `changes` are the new values by path relative to the part, `document` is the whole part as it then is, as JSON takes it.
    `by` is a page, REST, or "sequence".
    """

    epoch: int
    at_s: float
    by: str
    part: str
    tuning_id: int
    words: tuple[str, ...]
    changes: dict[str, Any]
    document: dict[str, Any]


@dataclass(frozen=True)
class Told:
    """A command as it was asked, and whether it was carried out; `problem` says in one sentence why not."""

    epoch: int
    at_s: float
    wall_time: str
    by: str
    command: str
    arguments: Any
    ok: bool
    problem: str | None


class Journal(Protocol):
    """Hears what happens, in the order in which it happens; must return at once."""

    def begin(self, run: Run) -> None:
        """Hear that a run began."""

    def change(self, change: Change) -> None:
        """Hear of a change in force."""

    def command(self, command: Told) -> None:
        """Hear of a command, accepted or refused."""

    def event(self, event: Event) -> None:
        """Hear of an event of the log."""


class Silent:
    """A journal that hears nothing."""

    def begin(self, run: Run) -> None:
        """Pass over it."""

    def change(self, change: Change) -> None:
        """Pass over it."""

    def command(self, command: Told) -> None:
        """Pass over it."""

    def event(self, event: Event) -> None:
        """Pass over it."""


class Unharming:
    """Passes all on to a journal; what that raises ends in the server's log."""

    def __init__(self, journal: Journal) -> None:
        self._journal = journal

    def begin(self, run: Run) -> None:
        """Pass it on."""
        self._tell(self._journal.begin, run)

    def change(self, change: Change) -> None:
        """Pass it on."""
        self._tell(self._journal.change, change)

    def command(self, command: Told) -> None:
        """Pass it on."""
        self._tell(self._journal.command, command)

    def event(self, event: Event) -> None:
        """Pass it on."""
        self._tell(self._journal.event, event)

    def _tell(self, hear: Callable[[Any], None], what: Any) -> None:
        try:
            hear(what)
        except Exception:  # whatever it is, the session goes on
            logger.exception("the journal did not take %s", type(what).__name__)


def wall_time() -> str:
    """Return the time of day as events and recordings have it: UTC, ISO 8601 with milliseconds."""
    return datetime.now(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")
