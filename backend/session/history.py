"""One linear history of what was changed: undo, redo, save points. It keeps states and does not look into them."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

State = TypeVar("State")
Pairs = dict[str, tuple[Any, Any]]
KEPT = 200
QUIET_S = 0.4
"""Changes of one page to the same fields that follow each other within this time are one entry: a drag of a slider."""


@dataclass(frozen=True)
class Stamp:
    """When a change took effect, and the tuning in force since then."""

    wall_time: str
    epoch: int
    time_s: float
    tuning_id: int


@dataclass(eq=False)
class Entry(Generic[State]):
    """One change, with the states before and after it; a save point changes nothing and cannot be undone."""

    number: int
    stamp: Stamp
    by: str
    part: str
    words: list[str]
    changes: Pairs
    before: State
    after: State
    undone: bool = False
    save_point: str | None = None
    heard_at: float = -math.inf

    def document(self) -> dict[str, Any]:
        """Return it as JSON takes it."""
        stamp = self.stamp
        return {
            "number": self.number, "wall_time": stamp.wall_time, "epoch": stamp.epoch, "time_s": stamp.time_s,
            "by": self.by, "part": self.part, "words": self.words,
            "changes": {path: list(pair) for path, pair in self.changes.items()},
            "tuning_id": stamp.tuning_id, "undone": self.undone, "save_point": self.save_point,
        }  # fmt: skip


class History(Generic[State]):
    """The newest entries; `listener` hears of each that is new or has changed. `clock` [s] tells drags from changes."""

    def __init__(
        self, listener: Callable[[list[Entry[State]]], None], clock: Callable[[], float], kept: int = KEPT
    ) -> None:
        self._listener, self._clock, self._kept = listener, clock, kept
        self._entries: list[Entry[State]] = []
        self._done: list[Entry[State]] = []
        self._taken_back: list[Entry[State]] = []
        self._count = 0

    def record(
        self,
        by: str,
        part: str,
        changes: Pairs,
        before: State,
        after: State,
        stamp: Stamp,
        words: Callable[[Pairs], list[str]],
        may_join: bool = True,
    ) -> Entry[State]:
        """Add a change, or join it with the drag that it continues; what was undone cannot be redone from here on."""
        entry = self._dragged(by, part, changes) if may_join else None
        if entry is None:
            entry = self._add(Entry(self._next(), stamp, by, part, words(changes), changes, before, after))
            self._done.append(entry)
        else:
            entry.changes = {path: (entry.changes[path][0], after) for path, (_, after) in changes.items()}
            entry.words = words({path: pair for path, pair in entry.changes.items() if pair[0] != pair[1]})
            entry.after, entry.stamp = after, stamp
        self._taken_back.clear()
        entry.heard_at = self._clock()
        self._listener([entry])
        return entry

    def save_point(self, name: str, by: str, state: State, stamp: Stamp) -> Entry[State]:
        """Add a named state to return to; it changes nothing, and undo passes over it."""
        entry = self._add(Entry(self._next(), stamp, by, "", [], {}, state, state, save_point=name))
        self._listener([entry])
        return entry

    @property
    def undoable(self) -> Entry[State] | None:
        """The change that undo would take back, None if there is none."""
        return self._done[-1] if self._done else None

    @property
    def redoable(self) -> Entry[State] | None:
        """The change that redo would make again, None if there is none."""
        return self._taken_back[-1] if self._taken_back else None

    def forget(self) -> None:
        """Forget all entries: what they lead back to belongs to another rig. Their numbers go on."""
        for entries in (self._entries, self._done, self._taken_back):
            entries.clear()

    def undo(self) -> Entry[State]:
        """Mark the newest change in force as undone and return it; IndexError if there is none."""
        entry = self._done.pop()
        self._taken_back.append(entry)
        return self._mark(entry, undone=True)

    def redo(self) -> Entry[State]:
        """Mark the change that was undone last as in force again and return it; IndexError if there is none."""
        entry = self._taken_back.pop()
        self._done.append(entry)
        return self._mark(entry, undone=False)

    def entry(self, number: int) -> Entry[State] | None:
        """Return the entry of a number, None if there is none (any more)."""
        return next((entry for entry in self._entries if entry.number == number), None)

    def last(self, count: int) -> list[dict[str, Any]]:
        """Return the newest `count` entries, oldest first."""
        return [entry.document() for entry in self._entries[-count:]]

    def _dragged(self, by: str, part: str, changes: Pairs) -> Entry[State] | None:
        """Return the newest entry if a change continues it."""
        newest = self._entries[-1] if self._entries else None
        if newest is None or newest is not self.undoable or self._taken_back:
            return None
        same = (newest.by, newest.part, newest.changes.keys()) == (by, part, changes.keys())
        same = same and all(only_numbers_differ(*pair) for pair in changes.values())
        return newest if same and self._clock() - newest.heard_at < QUIET_S else None

    def _mark(self, entry: Entry[State], undone: bool) -> Entry[State]:
        entry.undone, entry.heard_at = undone, -math.inf
        self._listener([entry])
        return entry

    def _next(self) -> int:
        self._count += 1
        return self._count

    def _add(self, entry: Entry[State]) -> Entry[State]:
        self._entries.append(entry)
        if len(self._entries) > self._kept:
            self._forget(next((old for old in self._entries[:-1] if old.save_point is None), self._entries[0]))
        return entry

    def _forget(self, entry: Entry[State]) -> None:
        self._entries.remove(entry)
        for stack in (self._done, self._taken_back):
            if entry in stack:
                stack.remove(entry)


def only_numbers_differ(before: Any, after: Any) -> bool:
    """Return whether two values are alike but for numbers, as those of a moving slider are; None stands for no number."""
    if isinstance(before, dict) and isinstance(after, dict):
        return before.keys() == after.keys() and all(only_numbers_differ(before[name], after[name]) for name in after)
    if isinstance(before, list) and isinstance(after, list):
        return len(before) == len(after) and all(map(only_numbers_differ, before, after))
    return before == after or (_is_number(before) and _is_number(after))


def _is_number(value: Any) -> bool:
    return value is None or (isinstance(value, (int, float)) and not isinstance(value, bool))
