"""Change events without a flood: what a slider sends while it moves becomes one line when it rests."""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

QUIET_S = 0.4


@dataclass
class Note:
    """Changes of one page to the same fields, from the first value to the last."""

    changes: dict[str, tuple[Any, Any]]
    time_s: float
    epoch: int
    timer: asyncio.TimerHandle | None = None


class ChangeNotes:
    """Collects changes by page and fields; tells each once it has rested for a moment."""

    def __init__(self, tell: Callable[[str, str, Note], None]) -> None:
        self._tell = tell
        self._notes: dict[tuple[str, str, frozenset[str]], Note] = {}

    def add(self, part: str, by: str, changes: dict[str, tuple[Any, Any]], epoch: int, time_s: float) -> None:
        """Note changes (path: before, after) that took effect at `time_s`."""
        key = (part, by, frozenset(changes))
        note = self._notes.get(key)
        if note is not None and note.timer is not None:
            note.timer.cancel()
            changes = {path: (note.changes[path][0], after) for path, (_, after) in changes.items()}
        note = self._notes[key] = Note(changes, time_s, epoch)
        note.timer = asyncio.get_running_loop().call_later(QUIET_S, self._rested, key)

    def _rested(self, key: tuple[str, str, frozenset[str]]) -> None:
        note = self._notes.pop(key)
        note.changes = {path: pair for path, pair in note.changes.items() if pair[0] != pair[1]}
        if note.changes:
            self._tell(key[0], key[1], note)
