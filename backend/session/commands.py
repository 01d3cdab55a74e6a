"""The commands of a session by name: REST and websocket call the same, and the journal hears of each."""

from collections.abc import Awaitable, Callable
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, ValidationError

from backend.problem import Problem, from_validation
from backend.session.arguments import (
    Applying,
    EntryNumber,
    ExcerptChange,
    ExcerptNumber,
    Loading,
    Named,
    Nothing,
    Pace,
    PinnedSpan,
    Samples,
    SavePoint,
    Saving,
)
from backend.session.changes import Changes
from backend.session.journal import Told, wall_time
from backend.session.trigger_source import Arming

if TYPE_CHECKING:
    from backend.session.session import Session

Message = dict[str, Any]


class Commands:
    """Checks the arguments of a command, carries it out, and tells the journal what became of it."""

    def __init__(self, session: "Session") -> None:
        self._session = session
        self._commands: dict[str, tuple[type[BaseModel], Callable[[Any, str], Awaitable[Message]]]] = {
            "tune": (Changes, session.parts.tune),
            "set_reference": (Changes, session.parts.set_reference),
            "set_stiffness": (Changes, session.parts.set_stiffness),
            "set_disturbances": (Changes, session.parts.set_disturbances),
            "load_scenario": (Loading, session.runs.load_scenario),
            "pause": (Nothing, session.runs.pause),
            "resume": (Nothing, session.runs.resume),
            "step": (Samples, session.runs.step),
            "reset": (Nothing, session.runs.reset),
            "set_pace": (Pace, session.runs.set_pace),
            "stop": (Nothing, session.runs.stop),
            "undo": (Nothing, session.history.undo),
            "redo": (Nothing, session.history.redo),
            "save_point": (SavePoint, session.history.save_point),
            "return_to": (EntryNumber, session.history.return_to),
            "pin": (PinnedSpan, session.pins.pin),
            "change_pin": (ExcerptChange, session.pins.change),
            "unpin": (ExcerptNumber, session.pins.unpin),
            "arm_trigger": (Arming, session.trigger.arm),
            "disarm_trigger": (Nothing, session.trigger.disarm),
            "save_preset": (Saving, session.presets.save),
            "apply_preset": (Applying, session.presets.apply),
            "delete_preset": (Named, session.presets.delete),
        }

    def names(self) -> list[str]:
        """Return the names of all commands."""
        return list(self._commands)

    async def run(self, name: str, arguments: Any, by: str) -> Message:
        """Run the command `name` for page `by`. Raises Problem."""
        status, journal = self._session.status, self._session.journal
        status.follow(self._session.ring.latest())
        asked_at, epoch, at_s = wall_time(), status.epoch, status.time_s

        def tell_journal(problem: str | None) -> None:
            journal.command(Told(epoch, at_s, asked_at, by, name, arguments, problem is None, problem))

        try:
            answer = await self._carry_out(name, arguments, by)
        except Problem as problem:
            tell_journal(problem.detail)
            raise
        tell_journal(None)
        return answer

    async def _carry_out(self, name: str, arguments: Any, by: str) -> Message:
        entry = self._commands.get(name)
        if entry is None:
            known = ", ".join(self._commands)
            raise Problem(404, "Unknown command", f"There is no command {name!r}; known: {known}.")
        model, method = entry
        try:
            validated = model.model_validate({} if arguments is None else arguments)
        except ValidationError as error:
            raise from_validation(error, model, consequence="Nothing was changed.") from error
        return await method(validated, by)
