"""The commands that change one part of the running scenario: tuning, reference, stiffness, disturbances."""

from collections.abc import Awaitable, Callable
from typing import TYPE_CHECKING, Any

from backend.loop import messages
from backend.session.changes import Changes, with_changes
from backend.session.journal import Change
from backend.session.notes import ChangeNotes, Note
from backend.session.planning import planned
from backend.session.running_scenario import part_differences, part_document
from backend.session.sentences import change_words
from vssea_core.scenario import Scenario

if TYPE_CHECKING:
    from backend.session.events import Kind
    from backend.session.session import Session

Message = dict[str, Any]
Differences = dict[str, tuple[Any, Any]]
EVENT_KINDS: "dict[str, Kind]" = {
    "tuning": "tuning", "reference": "reference", "stiffness_reference": "stiffness", "disturbances": "disturbance",
}  # fmt: skip


class PartCommands:
    """Checks, applies, and tells of each change; what is refused leaves everything as it was."""

    def __init__(self, session: "Session") -> None:
        self._session = session
        self._notes = ChangeNotes(self._note)
        self._ways: dict[str, Callable[[Scenario], Awaitable[messages.Done]]] = {
            "tuning": self._install,
            "reference": lambda new: session.link.command(messages.SetReference(new.reference)),
            "stiffness_reference": self._set_stiffness,
            "disturbances": lambda new: session.link.command(messages.SetDisturbances(new.disturbances)),
        }

    async def tune(self, asked: Changes, by: str) -> Message:
        """Change the tuning; refused, and the old one kept, if its own sampled loop is unstable."""
        return await self.change("tuning", asked, by)

    async def set_reference(self, asked: Changes, by: str) -> Message:
        """Follow another reference, without a jump."""
        return await self.change("reference", asked, by)

    async def set_stiffness(self, asked: Changes, by: str) -> Message:
        """Command another stiffness; refused if the tuning would be unstable there."""
        return await self.change("stiffness_reference", asked, by)

    async def set_disturbances(self, asked: Changes, by: str) -> Message:
        """Apply other disturbances, at once."""
        return await self.change("disturbances", asked, by)

    async def change(self, part: str, asked: Changes, by: str) -> Message:
        """Change a part as `asked`. Raises Problem, and the old one is kept, if it does not fit."""
        session = self._session
        async with session.turn:
            found = await self.change_in_turn(part, asked, by)
            return {
                "tuning_id": session.status.tuning_id,
                "applied": {path: after for path, (_, after) in found.items()},
            }

    async def change_in_turn(self, part: str, asked: Changes, by: str) -> Differences:
        """Change a part while the session's turn is held; return what became different."""
        session = self._session
        old = session.scenario
        new = with_changes(old, part, asked)
        found = part_differences(old, new, part)
        if found:
            done = await self._ways[part](new)
            session.running.adopt(part, new, asked)
            session.margins.ask(session.scenario, session.status.tuning_id)
            self.tell_journal(part, found, by, done.time_s)
            await self._plan_sequence()
            self._notes.add(part, by, found, session.status.epoch, done.time_s)
            session.tell(session.document(by))
            session.save_soon()
        return found

    def follow(self, report: messages.Followed) -> None:
        """Take over a change that the sequence made."""
        session = self._session
        before = session.scenario
        parts = session.running.follow(report.index)
        session.status.tuning_id = report.tuning_id
        session.margins.ask(session.scenario, report.tuning_id)
        for part in parts:
            if part.changes:
                self.tell_journal(part.part, part.changes, "sequence", report.time_s)
        words = session.running.words_of_entry(report.index, before)
        session.log.add("sequence", ", ".join(words), "sequence", session.status.epoch, report.time_s)
        session.tell(session.document("sequence"))

    def tell_journal(self, part: str, found: Differences, by: str, at_s: float) -> None:
        """Tell the journal of a change of a part that is now in force."""
        session = self._session
        document = part_document(session.scenario, part)
        after = {path: value for path, (_, value) in found.items()}
        words = tuple(self._words(part, found))
        status = session.status
        session.journal.change(Change(status.epoch, at_s, by, part, status.tuning_id, words, after, document))

    async def _install(self, new: Scenario) -> messages.Done:
        session = self._session
        prepared = await planned(session.design, new)
        done = await session.link.command(messages.Install(new.tuning, prepared.prepared, session.status.tuning_id + 1))
        session.status.tuning_id += 1
        return done

    async def _set_stiffness(self, new: Scenario) -> messages.Done:
        await planned(self._session.design, new)
        return await self._session.link.command(messages.SetStiffness(new.stiffness_reference))

    async def _plan_sequence(self) -> None:
        """Let what is left of the sequence start from the changed scenario."""
        session = self._session
        if session.scenario.sequence:
            prepared = await planned(session.design, session.scenario)
            await session.link.command(messages.Plan(prepared.followers))

    def _note(self, part: str, by: str, note: Note) -> None:
        words = self._words(part, note.changes)
        self._session.log.add(EVENT_KINDS[part], ", ".join(words), by, note.epoch, note.time_s)

    def _words(self, part: str, found: Differences) -> list[str]:
        return [change_words(self._session.scenario, f"{part}.{path}", *pair) for path, pair in found.items()]
