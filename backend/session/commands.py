"""The commands of a session by name: REST and websocket call the same, and the journal hears of each."""

from collections.abc import Awaitable, Callable
from functools import partial
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

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
from backend.session.command_audit import CommandAudit
from backend.session.journal import Told, wall_time
from backend.session.rig_arguments import Going, Handing, Jogging, RigName, TakingControl, Trial
from backend.session.trigger_source import Arming

if TYPE_CHECKING:
    from backend.session.session import Session

Message = dict[str, Any]
Method = Callable[[Any, str], Awaitable[Message]]


class Command(NamedTuple):
    """One command; on a rig, `moves` says that it can move it or change how it moves, so it needs control."""

    arguments: type[BaseModel]
    method: Callable[..., Awaitable[Message]]
    moves: bool = False
    where: Literal["anywhere", "simulation", "rig"] = "anywhere"
    keyed: bool = False
    """Whether the method also takes the caller's key."""
    waits: bool = False
    """Whether it waits for the session's turn or a design: the method also takes a check, made again before it takes effect."""


def command_table(session: "Session") -> dict[str, Command]:
    """Return every command of a session by its name. STOP needs nothing, and disarm and hold no control: as safe as STOP."""
    parts, runs, rig, control = session.parts, session.runs, session.rig.commands, session.rig.control
    return {
        "tune": Command(Changes, parts.tune, moves=True, waits=True),
        "set_reference": Command(Changes, parts.set_reference, moves=True, waits=True),
        "set_stiffness": Command(Changes, parts.set_stiffness, moves=True, waits=True),
        "set_disturbances": Command(Changes, parts.set_disturbances, moves=True, waits=True),
        "load_scenario": Command(Loading, runs.load_scenario, moves=True, where="simulation"),
        "pause": Command(Nothing, runs.pause, where="simulation"),
        "resume": Command(Nothing, runs.resume, where="simulation"),
        "step": Command(Samples, runs.step, where="simulation"),
        "reset": Command(Nothing, runs.reset, moves=True, waits=True),
        "set_pace": Command(Pace, runs.set_pace, where="simulation"),
        "stop": Command(Nothing, runs.stop),
        "undo": Command(Nothing, session.history.undo, moves=True, waits=True),
        "redo": Command(Nothing, session.history.redo, moves=True, waits=True),
        "save_point": Command(SavePoint, session.history.save_point),
        "return_to": Command(EntryNumber, session.history.return_to, moves=True, waits=True),
        "pin": Command(PinnedSpan, session.pins.pin),
        "change_pin": Command(ExcerptChange, session.pins.change),
        "unpin": Command(ExcerptNumber, session.pins.unpin),
        "arm_trigger": Command(Arming, session.trigger.arm),
        "disarm_trigger": Command(Nothing, session.trigger.disarm),
        "save_preset": Command(Saving, session.presets.save),
        "apply_preset": Command(Applying, session.presets.apply, moves=True, waits=True),
        "delete_preset": Command(Named, session.presets.delete),
        "connect_rig": Command(RigName, session.rig.connection.connect, where="simulation", keyed=True),
        "disconnect_rig": Command(Nothing, session.rig.connection.disconnect, moves=True, where="rig"),
        "home_stiffness": Command(Nothing, rig.home, moves=True, where="rig"),
        "arm": Command(Nothing, rig.arm, moves=True, where="rig"),
        "disarm": Command(Nothing, rig.disarm, where="rig"),
        "follow": Command(Nothing, rig.follow, moves=True, where="rig"),
        "hold": Command(Nothing, rig.hold, where="rig"),
        "jog": Command(Jogging, rig.jog, moves=True, where="rig"),
        "go_to": Command(Going, rig.go_to, moves=True, where="rig"),
        "try_tuning": Command(Trial, session.rig.trial.run),
        "take_control": Command(TakingControl, control.take, keyed=True),
        "renew_control": Command(Nothing, control.renew, keyed=True),
        "release_control": Command(Nothing, control.release, keyed=True),
        "ask_control": Command(TakingControl, control.ask, keyed=True),
        "hand_control": Command(Handing, control.hand, keyed=True),
    }  # fmt: skip


class Commands:
    """Checks the arguments of a command and who may give it, carries it out, and tells the journal what became of it."""

    def __init__(self, session: "Session") -> None:
        self._session = session
        self._commands = command_table(session)
        self._audit = CommandAudit()

    def names(self) -> list[str]:
        """Return the names of all commands."""
        return list(self._commands)

    async def run(self, name: str, arguments: Any, by: str, key: str | None = None) -> Message:
        """Run the command `name` for page `by`; `key` is what proves that it is in control. Raises Problem."""
        status, journal = self._session.status, self._session.journal
        status.follow(self._session.ring.latest())
        asked_at, epoch, at_s = wall_time(), status.epoch, status.time_s

        def tell_journal(problem: str | None) -> None:
            if self._audit.is_news(name, arguments, by, problem):
                journal.command(Told(epoch, at_s, asked_at, by, name, arguments, problem is None, problem))

        try:
            answer = await self._carry_out(name, arguments, by, key)
        except Problem as problem:
            tell_journal(problem.detail)
            raise
        tell_journal(None)
        return answer

    def permit(self, name: str, key: str | None, *, harmless: bool = False) -> None:
        """Raise Problem if a known command makes no sense where the session is, or its caller is not in control of the rig."""
        command, rig = self._commands[name], self._session.rig
        if command.where == "simulation" and rig.connected:
            raise Problem(
                409,
                "Not on a rig",
                f"{name} is for the simulation, and rig {rig.name} is connected; disconnect it first.",
            )
        if command.where == "rig" and not rig.connected:
            raise Problem(409, "No rig", f"{name} is for a rig, and none is connected; connect one first.")
        if command.moves and rig.connected and not harmless:
            rig.control.check(key)

    async def _carry_out(self, name: str, arguments: Any, by: str, key: str | None) -> Message:
        command = self._commands.get(name)
        if command is None:
            known = ", ".join(self._commands)
            raise Problem(404, "Unknown command", f"There is no command {name!r}; known: {known}.")
        try:
            validated = command.arguments.model_validate({} if arguments is None else arguments)
        except ValidationError as error:
            raise from_validation(error, command.arguments, consequence="Nothing was changed.") from error
        self.permit(name, key, harmless=getattr(validated, "harmless", False))
        if command.waits:
            return await command.method(validated, by, partial(self.permit, name, key))
        return await (command.method(validated, by, key) if command.keyed else command.method(validated, by))
