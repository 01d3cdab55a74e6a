"""What a rig really follows, beside what the document wants: jogs, moves and holds come and go without changing the wish."""

from typing import TYPE_CHECKING

from backend.loop.messages import Moved
from backend.session.journal import Change
from backend.session.rig_state import RigState
from backend.session.running_scenario import part_differences, part_document
from backend.session.sentences import changes_words
from vssea_core.scenario import Scenario

if TYPE_CHECKING:
    from backend.session.session import Session


class RigMoves:
    """Keeps the scenario in force, and tells the journal of it: a recording holds what was followed, not what was wanted."""

    def __init__(self, session: "Session", state: RigState) -> None:
        self._session, self._state = session, state
        self.by = "rig"
        """Who gave the last command that moves the rig."""

    def take(self, report: Moved) -> None:
        """Take another reference, or stiffness reference, that is in force now."""
        session, before = self._session, self._state.in_force
        if before is None:
            return
        part = report.part
        after = before.model_copy(update={part: getattr(report.scenario, part)})
        self._state.in_force = after
        found = part_differences(before, after, part)
        if not found:
            return
        words = (report.why, *changes_words(after, part, found))
        new = {path: value for path, (_, value) in found.items()}
        status = session.status
        session.journal.change(
            Change(status.epoch, report.time_s, self.by, part, status.tuning_id, words, new, part_document(after, part))
        )
        if part == "stiffness_reference":  # there is no other wish for the stiffness than what is in force
            session.running.put(part, after)
            session.margins.ask(session.scenario, status.tuning_id)
            session.tell(session.document(self.by))

    def follows(self) -> bool:
        """Return whether the rig follows the document's reference now."""
        in_force = self._state.in_force
        wanted = self._session.scenario.reference
        return in_force is not None and self._session.status.state == "running" and in_force.reference == wanted

    def adopt(self, part: str, new: Scenario) -> bool:
        """Take over a part that a command has changed; return whether it is in force at once.

        A reference is only stored unless it is being followed. Call it before the document takes the part over.
        """
        in_force = self._state.in_force
        if in_force is None:
            return True
        if part == "reference" and not self.follows():
            return False
        self._state.in_force = in_force.model_copy(update={part: getattr(new, part)})
        return True
