"""What a session tells, as the documents that a recording keeps."""

import json
from datetime import datetime
from typing import Any

from backend.recordings.chunks import NS, Document
from backend.recordings.layout import CHANGES, COMMANDS, EVENTS, FORMAT
from backend.session.events import Event
from backend.session.journal import Change, Run, Told
from vssea_core import __version__

LEVELS = {"info": 2, "warning": 3, "fault": 5}
"""Of foxglove.Log."""


def begin_head(run: Run) -> dict[str, str]:
    """Return the metadata of a run's recording; its id is when it began."""
    begun_ns = round(datetime.fromisoformat(run.wall_time).timestamp() * 1e3) * 1_000_000
    return {
        "id": run.wall_time.replace(":", "-").replace(".", "-"), "format": FORMAT, "vssea": __version__,
        "begun_at": run.wall_time, "begin_ns": str(begun_ns), "epoch": str(run.epoch), "rig": run.rig, "origin": "live",
        "name": "", "scenario": run.scenario.name,
    }  # fmt: skip


def change_entry(number: int, change: Change) -> Document:
    """Return a change of a part of the scenario."""
    content = {
        "n": number, "at_s": change.at_s, "epoch": change.epoch, "by": change.by, "part": change.part,
        "tuning_id": change.tuning_id, "words": list(change.words), "changes": change.changes, "document": change.document,
    }  # fmt: skip
    return Document(CHANGES, change.at_s, content)


def command_entry(number: int, told: Told) -> Document:
    """Return a command as it was asked."""
    content = {
        "n": number, "at_s": told.at_s, "wall_time": told.wall_time, "epoch": told.epoch, "by": told.by,
        "command": told.command, "arguments": _strict(told.arguments), "ok": told.ok, "problem": told.problem,
    }  # fmt: skip
    return Document(COMMANDS, told.at_s, content)


def event_entry(number: int, event: Event, begin_ns: int) -> Document:
    """Return an event as a log message that robotics tools know."""
    seconds, nanoseconds = divmod(begin_ns + round(event.time_s * NS), 1_000_000_000)
    content = {
        "timestamp": {"sec": seconds, "nsec": nanoseconds}, "level": LEVELS[event.severity], "message": event.text,
        "name": event.kind, "file": "", "line": 0, "n": number, "number": event.number, "at_s": event.time_s,
        "epoch": event.epoch, "kind": event.kind, "by": event.by, "severity": event.severity, "wall_time": event.wall_time,
    }  # fmt: skip
    return Document(EVENTS, event.time_s, content)


def _strict(value: Any) -> Any:
    """Return what JSON has no word for, such as NaN, as text."""
    return json.loads(json.dumps(value, default=str), parse_constant=str)
