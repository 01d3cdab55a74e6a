"""The session's event log: numbered, with wall and session time, kept for pages that join later."""

from collections import deque
from collections.abc import Callable
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from typing import Any, Literal

Kind = Literal[
    "tuning",
    "stiffness",
    "reference",
    "disturbance",
    "state",
    "limit",
    "fault",
    "preset",
    "scenario",
    "sequence",
    "link",
    "pin",
    "trigger",
    "recording",
    "rig",
    "control",
]
Severity = Literal["info", "warning", "fault"]
KEPT = 500


@dataclass(frozen=True)
class Event:
    """Something that happened, and who did it."""

    number: int
    wall_time: str
    epoch: int
    time_s: float
    kind: Kind
    text: str
    by: str
    severity: Severity

    def document(self) -> dict[str, Any]:
        """Return it as JSON takes it."""
        return asdict(self)


class EventLog:
    """The last events; `listener` is told of each new one."""

    def __init__(self, listener: Callable[[Event], None], clock: Callable[[], datetime] | None = None) -> None:
        self._events: deque[Event] = deque(maxlen=KEPT)
        self._listener = listener
        self._clock = clock or (lambda: datetime.now(UTC))
        self._count = 0

    def add(self, kind: Kind, text: str, by: str, epoch: int, time_s: float, severity: Severity = "info") -> None:
        """Append an event and tell the listener."""
        self._count += 1
        wall_time = self._clock().isoformat(timespec="milliseconds").replace("+00:00", "Z")
        event = Event(self._count, wall_time, epoch, time_s, kind, text, by, severity)
        self._events.append(event)
        self._listener(event)

    def last(self, count: int) -> list[dict[str, Any]]:
        """Return the newest `count` events, oldest first."""
        return [event.document() for event in list(self._events)[-count:]]
