"""The commands of the history: undo and redo whoever's change it was, name a save point, return to an entry."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from backend.problem import Problem
from backend.session.arguments import EntryNumber, Nothing, SavePoint
from backend.session.changes import differences
from backend.session.history import Entry, History, Pairs, Stamp
from backend.session.journal import wall_time
from backend.session.permission import Permission, granted
from backend.session.sentences import changes_words, several, whose
from vssea_core.scenario import CHANGEABLE, Scenario

if TYPE_CHECKING:
    from backend.session.session import Session

Message = dict[str, Any]
WHOLE = "scenario"
"""The part of an entry that changed more than one part, or the rig; its paths are those of the scenario."""
START = "start"
HELLO_ENTRIES = 100


@dataclass(frozen=True)
class State:
    """All that an entry can bring back: the scenario as it stood then and at t = 0, and the preset in use."""

    now: Scenario
    beginning: Scenario
    preset: Any


class HistoryCommands:
    """Keeps the history of the session's changes, and goes back and forth in it."""

    def __init__(self, session: "Session") -> None:
        self._session = session
        self._history: History[State] = History(self._tell, time.monotonic)

    def state(self) -> State:
        """Return the present state."""
        session = self._session
        return State(session.scenario, session.running.beginning, session.preset)

    def record(self, by: str, part: str, changes: Pairs, before: State, time_s: float) -> None:
        """Add a change of a part that is now in force."""
        self._history.record(by, part, changes, before, self.state(), self._stamp(time_s), self._words(part))

    def record_load(self, by: str, before: State) -> None:
        """Add the load of another scenario, or of an edited one."""
        self._record_whole(by, before, before.beginning, self._session.running.beginning, 0.0)

    def begin(self) -> None:
        """Begin anew, and mark where: what was before, with another rig, cannot be returned to."""
        self._history.forget()
        self._session.tell({"type": "history", "entries": [], "anew": True, **self._possible()})
        self._history.save_point(START, "server", self.state(), self._stamp(0.0))

    def greeting(self) -> Message:
        """Return what a page needs of it when it connects."""
        return {"history": self._history.last(HELLO_ENTRIES), **self._possible()}

    def last(self, count: int) -> list[Message]:
        """Return the newest `count` entries, oldest first."""
        return self._history.last(count)

    async def undo(self, _: Nothing, by: str, permit: Permission = granted) -> Message:
        """Take back the newest change in force, whoever made it."""
        return await self._step(by, "undo", permit)

    async def redo(self, _: Nothing, by: str, permit: Permission = granted) -> Message:
        """Make the change again that was undone last."""
        return await self._step(by, "redo", permit)

    async def save_point(self, asked: SavePoint, by: str) -> Message:
        """Name the present state, to return to it."""
        async with self._session.turn:
            name = asked.name or f"save point at {self._session.status.time_s:.1f} s"
            entry = self._history.save_point(name, by, self.state(), self._stamp(self._session.status.time_s))
        return {"number": entry.number}

    async def return_to(self, asked: EntryNumber, by: str, permit: Permission = granted) -> Message:
        """Go back to the state after an entry, as one change that can itself be undone."""
        session = self._session
        async with session.turn:
            permit()
            entry = self._history.entry(asked.number)
            if entry is None:
                raise Problem(404, "No such entry", f"There is no entry {asked.number} in the history (any more).")
            before = self.state()
            at_s = await self._restore(entry.after, None, by, permit)
            after = self.state()
            if _fixed(before.beginning) == _fixed(after.beginning):
                recorded = self._record_whole(by, before, before.now, after.now, at_s)
            else:
                recorded = self._record_whole(by, before, before.beginning, after.beginning, at_s)
            place = entry.save_point or f"entry {entry.number}"
            kind = session.parts.kind_of(recorded.part if recorded else WHOLE)
            session.note(kind, f"returned to {place}: {several(recorded.words) if recorded else 'no change'}", by)
        return {"tuning_id": session.status.tuning_id, "number": recorded.number if recorded else None}

    async def _step(self, by: str, way: str, permit: Permission) -> Message:
        session = self._session
        async with session.turn:
            permit()
            entry = self._history.undoable if way == "undo" else self._history.redoable
            if entry is None:
                raise Problem(409, f"Nothing to {way}", f"There is nothing to {way}. Nothing was changed.")
            await self._restore(entry.before if way == "undo" else entry.after, entry.part, by, permit)
            getattr(self._history, way)()
            kind = session.parts.kind_of(entry.part)
            done = "took back" if way == "undo" else "made again"
            session.note(kind, f"{done}{whose(entry.by, by)}: {several(entry.words)}", by)
        return {
            "tuning_id": session.status.tuning_id, "number": entry.number, "by": entry.by, "part": entry.part,
            "words": entry.words,
        }  # fmt: skip

    async def _restore(self, state: State, part: str | None, by: str, permit: Permission) -> float:
        """Put one part of a state in force, or all of it, and return the time [s] from which it is.

        Raises Problem, and nothing has changed.
        """
        session = self._session
        if part in CHANGEABLE:
            return await self._put(state.now, (part,), by, permit)
        if _fixed(session.running.beginning) != _fixed(state.beginning):
            await session.runs.load(state.beginning)
            at_s = 0.0
        else:
            at_s = await self._put(state.now, CHANGEABLE, by, permit)
        session.preset = state.preset
        session.tell(session.document(by))
        session.kept.soon()
        return at_s

    async def _put(self, source: Scenario, parts: tuple[str, ...], by: str, permit: Permission) -> float:
        present = self._session.scenario
        other = [part for part in parts if getattr(source, part) != getattr(present, part)]
        new = present.model_copy(update={part: getattr(source, part) for part in other})
        return await self._session.parts.put(new, other, by, permit)

    def _record_whole(self, by: str, before: State, old: Scenario, new: Scenario, at_s: float) -> Entry[State] | None:
        """Add a change of any parts; an entry of a single part that may change live is one of that part."""
        found = differences(old.model_dump(mode="json"), new.model_dump(mode="json"))
        if not found:
            return None
        part, *others = {path.split(".")[0] for path in found}
        if others or part not in CHANGEABLE:
            part = WHOLE
        changes = {path.removeprefix(f"{part}."): pair for path, pair in found.items()}
        return self._history.record(
            by, part, changes, before, self.state(), self._stamp(at_s), self._words(part), may_join=False
        )

    def _words(self, part: str) -> Callable[[Pairs], list[str]]:
        return lambda pairs: changes_words(self._session.scenario, "" if part == WHOLE else part, pairs)

    def _stamp(self, time_s: float) -> Stamp:
        status = self._session.status
        return Stamp(wall_time(), status.epoch, time_s, status.tuning_id)

    def _possible(self) -> Message:
        return {"can_undo": self._history.undoable is not None, "can_redo": self._history.redoable is not None}

    def _tell(self, entries: list[Entry[State]]) -> None:
        documents = [entry.document() for entry in entries]
        self._session.tell({"type": "history", "entries": documents, **self._possible()})


def _fixed(scenario: Scenario) -> dict[str, Any]:
    """Return what cannot change while a scenario runs."""
    return scenario.model_dump(exclude=set(CHANGEABLE))
