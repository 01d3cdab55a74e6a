"""The commands of a connected rig: home, arm, disarm, follow, hold, jog, go to, reset. The control process decides."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from backend.loop import messages
from backend.problem import Problem
from backend.rigs.rig_file import Limits
from backend.session.arguments import Nothing
from backend.session.jog_ends import JogEnds
from backend.session.permission import Permission
from backend.session.rig_arguments import Going, Jogging
from backend.session.rig_limits import check_jog, check_move
from backend.session.uninterrupted import to_the_end

if TYPE_CHECKING:
    from backend.session.session import Session

Message = dict[str, Any]
LONG_LIMIT_S = 30.0
"""For commands that wait for the drives."""
REFUSED = 422


class RigCommands:
    """Each passes to the control process at once: none waits for a design that is being computed."""

    def __init__(self, session: "Session", clock: Callable[[], float]) -> None:
        self._session, self._clock = session, clock
        self._jogged_s: float | None = None  # when the jog was last renewed
        self.ends = JogEnds(session)
        self._driving = 0

    @property
    def driving(self) -> bool:
        """Whether a command that may switch the drives on is not answered yet."""
        return self._driving > 0

    async def home(self, _: Nothing, by: str) -> Message:
        """Find both end stops of the stiffness axis."""
        return await self._do(messages.Home(), by, "homing the stiffness axis", "Cannot home")

    async def arm(self, _: Nothing, by: str) -> Message:
        """Close the loops, holding where the rig is; 409 with the reasons if it cannot."""
        report = self._session.rig.state.report
        try:
            return await self._do(messages.Arm(), by, "arming", "Cannot arm")
        except Problem as problem:
            problem.members["reasons"] = list(report.cannot_arm) if report is not None else []
            raise

    async def disarm(self, _: Nothing, by: str) -> Message:
        """Come to rest, open the loops."""
        return await self._do(messages.Disarm(), by, "disarming", "Cannot disarm")

    async def follow(self, _: Nothing, by: str) -> Message:
        """Follow the reference that was set."""
        return await self._do(messages.Follow(), by, "following the reference", "Cannot follow")

    async def hold(self, _: Nothing, by: str) -> Message:
        """Come to rest and hold."""
        return await self._do(messages.Hold(), by, "holding", "Cannot hold")

    async def go_to(self, asked: Going, by: str) -> Message:
        """Move the link to a position."""
        check_move(self._limits(), asked.position, asked.speed)
        words = f"going to {asked.position:.3f} rad at up to {asked.speed:.2f} rad/s"
        return await self._do(messages.GoTo(asked.position, asked.speed), by, words, "Cannot go there")

    async def jog(self, asked: Jogging, by: str) -> Message:
        """Move with a velocity until it is let go or not renewed. Waits for nothing: a jog that is late is no jog."""
        now = self._clock()
        limits = self._limits()
        check_jog(limits, asked.link, asked.stiffness)
        if asked.stiffness:
            self.ends.check(limits.stiffness_high if asked.stiffness > 0.0 else limits.stiffness_low)
        goes_on = self._jogged_s is not None and now - self._jogged_s <= messages.JOG_LASTS_S
        moving = not asked.harmless
        command = messages.Jog(asked.link, asked.stiffness, now)
        done = await self._told("Cannot jog", command, by if moving else None)
        if moving and not goes_on:
            self._note(f"jogging: {_jog_words(asked)}", by)
        elif goes_on and not moving:
            self._note("jog let go", by)
        self._jogged_s = now if moving else None
        return {"time_s": done.time_s}

    async def reset(self, by: str, permit: Permission) -> None:
        """Leave a stop or a fault, drives off; refused while the cause stands. A control process that died is started anew."""
        await to_the_end(self._reset(by, permit))

    async def _reset(self, by: str, permit: Permission) -> None:
        session = self._session
        async with session.turn:
            permit()
            if session.rig.state.lost:
                await session.rig.connection.reconnect(by)
            else:
                await self._reset_running(by)

    async def _reset_running(self, by: str) -> None:
        session = self._session
        epoch = session.status.epoch
        await self._told("Cannot reset", messages.Reset(), by)
        session.status.stopped_by = None
        if session.status.epoch != epoch:
            session.runs.begun()
        self._note("reset", by)

    async def _do(self, command: messages.Command, by: str, words: str, title: str) -> Message:
        self._jogged_s = None
        self._driving += 1
        try:
            done = await self._told(title, command, by)
        finally:
            self._driving -= 1
        self._note(words, by)
        return {"time_s": done.time_s}

    async def _told(self, title: str, command: messages.Command, by: str | None) -> messages.Done:
        """Send a command; what the rig refuses in its present state is a conflict with that state: 409."""
        session = self._session
        if by is not None:
            session.rig.moves.by = by
        try:
            return await session.link.command(command, LONG_LIMIT_S)
        except Problem as problem:
            if problem.status == REFUSED:
                raise Problem(409, title, problem.detail) from problem
            raise

    def _limits(self) -> Limits:
        file = self._session.rig.file
        if file is None:
            raise Problem(409, "No rig", "No rig is connected; connect one first.")
        return file.limits

    def _note(self, text: str, by: str) -> None:
        self._session.note("rig", text, by)


def _jog_words(asked: Jogging) -> str:
    words = [f"link {asked.link:.2f} rad/s"] if asked.link else []
    words += [f"stiffness {asked.stiffness:.0f} N·m/rad a second"] if asked.stiffness else []
    return ", ".join(words)
