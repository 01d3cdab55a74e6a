"""The commands that change one part of the running scenario: tuning, reference, stiffness, disturbances."""

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from backend.loop import messages
from backend.session.changes import Changes, with_changes
from backend.session.journal import Change
from backend.session.notes import ChangeNotes, Note
from backend.session.permission import Permission, granted
from backend.session.planning import planned
from backend.session.running_scenario import part_differences, part_document
from backend.session.sentences import changes_words
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

    async def tune(self, asked: Changes, by: str, permit: Permission = granted) -> Message:
        """Change the tuning; refused, and the old one kept, if its own sampled loop is unstable."""
        return await self.change("tuning", asked, by, permit)

    async def set_reference(self, asked: Changes, by: str, permit: Permission = granted) -> Message:
        """Follow another reference, without a jump."""
        return await self.change("reference", asked, by, permit)

    async def set_stiffness(self, asked: Changes, by: str, permit: Permission = granted) -> Message:
        """Command another stiffness; refused if the tuning would be unstable there."""
        return await self.change("stiffness_reference", asked, by, permit)

    async def set_disturbances(self, asked: Changes, by: str, permit: Permission = granted) -> Message:
        """Apply other disturbances, at once."""
        return await self.change("disturbances", asked, by, permit)

    async def change(self, part: str, asked: Changes, by: str, permit: Permission = granted) -> Message:
        """Change a part as `asked`. Raises Problem, and the old one is kept, if it does not fit or is no longer permitted."""
        session = self._session
        async with session.turn:
            permit()
            found = await self.change_in_turn(part, asked, by, permit)
            return {
                "tuning_id": session.status.tuning_id,
                "applied": {path: after for path, (_, after) in found.items()},
            }

    async def change_in_turn(self, part: str, asked: Changes, by: str, permit: Permission = granted) -> Differences:
        """Change a part while the session's turn is held; return what became different."""
        session = self._session
        new = with_changes(session.scenario, part, asked)
        found = part_differences(session.scenario, new, part)
        if found:
            session.rig.check(new, [part])
            before = session.history.state()
            prepared = await self._prepared(new, [part])
            permit()
            time_s = await self._apply(new, part, prepared, asked, by)
            session.history.record(by, part, found, before, time_s)
            self._notes.add(part, by, found, session.status.epoch, time_s)
            session.tell(session.document(by))
            session.kept.soon()
        return found

    async def put(self, new: Scenario, parts: list[str], by: str, permit: Permission = granted) -> float:
        """Put whole parts of another scenario in place of the present ones, all or none, while the turn is held.

        Returns the time [s] from which all are in force. Raises Problem if they do not fit together, or are no longer permitted.
        """
        session = self._session
        session.rig.check(new, parts)
        prepared = await self._prepared(new, parts)
        permit()
        time_s = session.status.time_s
        for part in parts:
            time_s = await self._apply(new, part, prepared, Changes(replace=part_document(new, part)), by)
        session.tell(session.document(by))
        session.kept.soon()
        return time_s

    async def _prepared(self, new: Scenario, parts: list[str]) -> Any:
        """Return what the control process needs of a scenario, None if the parts cannot make it unstable."""
        ahead = self._session.running.ahead(new)
        matters = ahead.sequence or {"tuning", "stiffness_reference"} & set(parts)
        return await planned(self._session.design, ahead) if matters else None

    async def _apply(self, new: Scenario, part: str, prepared: Any, asked: Changes, by: str) -> float:
        session = self._session
        found = part_differences(session.scenario, new, part)
        done = await self._send(new, part, prepared)
        in_force = session.rig.moves.adopt(part, new)
        session.running.adopt(part, new, asked)
        session.margins.ask(session.scenario, session.status.tuning_id)
        if in_force:
            self.tell_journal(part, found, by, done.time_s)
        await self._plan_sequence()
        return done.time_s

    async def _send(self, new: Scenario, part: str, prepared: Any) -> messages.Done:
        session = self._session
        match part:
            case "tuning":
                number = session.status.tuning_id + 1
                done = await session.link.command(messages.Install(new.tuning, prepared.prepared, number))
                session.status.tuning_id = number
                return done
            case "reference":
                return await session.link.command(messages.SetReference(new.reference))
            case "stiffness_reference":
                return await session.link.command(messages.SetStiffness(new.stiffness_reference))
            case _:
                return await session.link.command(messages.SetDisturbances(new.disturbances))

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

    async def _plan_sequence(self) -> None:
        """Let what is left of the sequence start from the changed scenario."""
        session = self._session
        made, ahead = session.running.followed, session.running.ahead(session.scenario)
        if ahead.sequence:
            prepared = await planned(session.design, ahead)
            followers = tuple(replace(follower, index=made + follower.index) for follower in prepared.followers)
            await session.link.command(messages.Plan(followers))

    def kind_of(self, part: str) -> "Kind":
        """Return the kind of the events that tell of changes of a part."""
        return EVENT_KINDS.get(part, "scenario")

    def _note(self, part: str, by: str, note: Note) -> None:
        words = self._words(part, note.changes)
        self._session.log.add(EVENT_KINDS[part], ", ".join(words), by, note.epoch, note.time_s)

    def _words(self, part: str, found: Differences) -> list[str]:
        return changes_words(self._session.scenario, part, found)
