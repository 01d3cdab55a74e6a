"""The commands that begin, hold and end runs: load, reset, pause, resume, step, pace, stop."""

from typing import TYPE_CHECKING, Any

from backend.loop import messages
from backend.problem import Problem
from backend.session.arguments import Loading, Nothing, Pace, Samples
from backend.session.journal import Run, wall_time
from backend.session.permission import Permission, granted
from backend.session.planning import planned
from vssea_core.scenario import Scenario
from vssea_core.scenarios import SCENARIOS

if TYPE_CHECKING:
    from backend.session.session import Session

Message = dict[str, Any]


class RunCommands:
    """Each is told to every page once the control process has done it."""

    def __init__(self, session: "Session") -> None:
        self._session = session

    async def load_scenario(self, asked: Loading, by: str) -> Message:
        """Restart with another scenario, at t = 0."""
        scenario = asked.scenario or SCENARIOS.get(asked.name or "")
        if scenario is None:
            raise Problem(
                404, "No such scenario", f"There is no scenario {asked.name!r}; known: {', '.join(SCENARIOS)}."
            )
        session = self._session
        async with session.turn:
            before = session.history.state()
            await self.load(scenario)
            session.preset = None
            session.history.record_load(by, before)
            session.tell(session.document(by))
            session.kept.soon()
        session.note("scenario", f"scenario {scenario.name} loaded", by)
        return {"tuning_id": session.status.tuning_id}

    async def load(self, scenario: Scenario, run: bool | None = None) -> None:
        """Begin a run of a scenario, at once if the old one ran unless `run` says; the caller has the session's turn.

        Raises Problem, and the old one goes on.
        """
        session = self._session
        prepared = await planned(session.design, scenario)
        if run is None:
            run = session.status.state in ("starting", "running")
        await session.link.command(messages.Load(scenario, prepared, session.status.tuning_id + 1, run))
        session.status.tuning_id += 1
        session.running.load(scenario)
        session.margins.ask(scenario, session.status.tuning_id)
        self.begun()
        session.tell(session.document())

    async def reset(self, _: Nothing, by: str, permit: Permission = granted) -> Message:
        """Back to t = 0; the only way out of a stop or a fault. A rig's time goes on."""
        session = self._session
        if session.rig.connected:
            await session.rig.commands.reset(by, permit)
            return {}
        async with session.turn:
            permit()
            if session.link.ended:
                await session.start_control()
                await self.load(session.running.beginning)
            elif session.scenario.sequence:
                await self.load(session.running.beginning)  # what the sequence changed goes back to what it was
            else:
                await session.link.command(messages.Reset())
                self.begun()
        session.status.stopped_by = None
        session.note("state", "reset to t = 0", by)
        return {}

    async def pause(self, _: Nothing, by: str) -> Message:
        """Hold time."""
        await self._session.link.command(messages.Pause())
        return {}

    async def resume(self, _: Nothing, by: str) -> Message:
        """Let time run."""
        await self._session.link.command(messages.Resume())
        return {}

    async def step(self, asked: Samples, by: str) -> Message:
        """Advance a paused session."""
        done = await self._session.link.command(messages.Step(asked.samples))
        return {"time_s": done.time_s}

    async def set_pace(self, asked: Pace, by: str) -> Message:
        """Ask for another real-time factor."""
        session = self._session
        await session.link.command(messages.SetPace(asked.factor))
        session.status.pace = asked.factor
        session.note("state", f"real-time factor {asked.factor:g}", by)
        session.tell_state()
        return {}

    async def stop(self, _: Nothing, by: str) -> Message:
        """Motor torque off at once (a rig brakes first), stiffness held. Passes every queue: it only writes the flag."""
        self.stop_at_once(by)
        return {}

    def stop_at_once(self, by: str) -> None:
        """Stop as the command does; `by` stands in the sentence: Stopped by ..."""
        session = self._session
        session.flag.raise_()
        if session.status.state not in ("stopped", "fault"):
            session.status.stopped_by = by

    def begun(self) -> None:
        """Tell the journal that a run began."""
        session = self._session
        status = session.status
        run = Run(status.epoch, session.running.beginning, status.tuning_id, wall_time(), session.rig.state.kind)
        session.journal.begin(run)
