"""The live session: every command is one method here; REST and websocket call the same."""

import asyncio
import logging
import uuid
from collections.abc import Awaitable, Callable
from itertools import count
from typing import Any

from pydantic import BaseModel, ValidationError

from backend.compute.pool import JobFailedError, JobRefusedError, Pool
from backend.loop import messages
from backend.presets.last import InForce
from backend.problem import Problem, from_validation, refused
from backend.session.arguments import Applying, Loading, Named, Nothing, Pace, Samples, Saving
from backend.session.changes import Changes, after_change, begun_with, differences, valued, with_changes
from backend.session.control_link import ControlLink
from backend.session.disturbance_watch import DisturbanceWatch
from backend.session.events import Event, EventLog, Kind, Severity
from backend.session.fault_snapshot import save_fault_snapshot
from backend.session.health import Health
from backend.session.kept_run import KeptRun
from backend.session.limit_watch import LimitWatch
from backend.session.live_margins import LiveMargins
from backend.session.notes import ChangeNotes, Note
from backend.session.preset_commands import PresetCommands
from backend.session.sentences import change_words
from backend.session.status import Status
from backend.settings import Settings
from backend.store.database import Database
from backend.telemetry.ring import Ring, RingReader
from backend.telemetry.stop_flag import StopFlag
from vssea_core.scenario import Scenario
from vssea_core.scenarios import SCENARIOS

logger = logging.getLogger(__name__)

WATCH_S = 0.1
STATE_EVERY = 5  # watches between two state messages
SAVE_AFTER_S = 1.0
Message = dict[str, Any]
EVENT_KINDS: dict[str, Kind] = {
    "tuning": "tuning", "reference": "reference", "stiffness_reference": "stiffness", "disturbances": "disturbance",
}  # fmt: skip


class Session:
    """One live session on a simulated rig."""

    def __init__(self, settings: Settings, pool: Pool, database: Database) -> None:
        self._settings, self._pool = settings, pool
        self.scenario: Scenario = SCENARIOS[settings.scenario]
        self._beginning = self.scenario  # as it stands at t = 0, before the sequence changes it
        self.preset: InForce | None = None
        self.status = Status()
        self._segment, self._flag = Ring(), StopFlag()
        self.ring_name = self._segment.name
        self.run_id = uuid.uuid4().hex
        self.ring = RingReader(self._segment.name)
        self._health, self._limits = Health(self.ring), LimitWatch(self.ring)
        self._loads = DisturbanceWatch(self.ring)
        self.listeners: set[Callable[[Message], None]] = set()
        self.log = EventLog(self._tell_event)
        self._notes = ChangeNotes(self._tell_change)
        self._link = ControlLink(self._on_report, self._on_lost)
        self.margins = LiveMargins(pool.analysis, self.tell)
        self._turn = asyncio.Lock()
        self._tasks: set[asyncio.Task[None]] = set()
        self._save_timer: asyncio.TimerHandle | None = None
        self.presets = PresetCommands(database, self)
        self._kept = KeptRun(self.presets.presets, self)
        self._commands: dict[str, tuple[type[BaseModel], Callable[[Any, str], Awaitable[Message]]]] = {
            "tune": (Changes, self.tune),
            "set_reference": (Changes, self.set_reference),
            "set_stiffness": (Changes, self.set_stiffness),
            "set_disturbances": (Changes, self.set_disturbances),
            "load_scenario": (Loading, self.load_scenario),
            "pause": (Nothing, self.pause),
            "resume": (Nothing, self.resume),
            "step": (Samples, self.step),
            "reset": (Nothing, self.reset),
            "set_pace": (Pace, self.set_pace),
            "stop": (Nothing, self.stop),
            "save_preset": (Saving, self.presets.save),
            "apply_preset": (Applying, self.presets.apply),
            "delete_preset": (Named, self.presets.delete),
        }

    # ---- life

    def start(self) -> None:
        """Start the control process and the workers in the background; the state says when they are ready."""
        self._spawn(self._begin())
        self._spawn(self._warm_workers())
        self._spawn(self._watch())

    async def close(self) -> None:
        """Save the last tuning and end the control process."""
        for task in self._tasks:
            task.cancel()
        await self.margins.stop()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        if self._save_timer is not None:
            self._save_timer.cancel()
            await self._kept.write()
        await self._link.stop()
        self.ring.close()
        self._flag.close()
        self._segment.close()

    async def _begin(self) -> None:
        last = await self._kept.read()
        if last is not None:
            self.scenario, self.preset = last.scenario, last.preset
        try:
            await self._link.start(self.ring_name, self._flag.name, self.status.epoch)
        except Problem:
            return  # its end was told, and Reset starts it anew
        try:
            await self._load(self.scenario)
        except Problem as problem:
            logger.warning("the last tuning cannot be used: %s", problem.detail)
            self.scenario, self.preset = SCENARIOS[self._settings.scenario], None
            await self._load(self.scenario)
            self.note(
                "scenario", f"The last tuning cannot be used: {problem.detail} Loaded {self.scenario.name}", "server"
            )
        else:
            if last is not None:
                self.note("scenario", f"{self.scenario.name} and its last tuning are back", "server")

    async def _warm_workers(self) -> None:
        """Start the workers beside the control process; a worker that fails to start is tried again when it is needed."""
        for worker in (self._pool.design, self._pool.analysis, self._pool.simulation, self._pool.tasks):
            try:
                await worker.start()
            except JobFailedError as failure:
                logger.warning("%s", failure)

    async def _watch(self) -> None:
        """Tell of limits as they begin, and of the state twice a second."""
        for turn in count(1):
            await asyncio.sleep(WATCH_S)
            for epoch, time_s, sentence in self._limits.begun():
                self.log.add("limit", sentence, "rig", epoch, time_s, "warning")
            for epoch, time_s, sentence in self._loads.passed(self.scenario.disturbances):
                self.log.add("disturbance", sentence, "scenario", epoch, time_s)
            if turn % STATE_EVERY == 0 and self.listeners:
                self._tell_state()

    def _spawn(self, work: Awaitable[None]) -> None:
        task = asyncio.ensure_future(work)
        self._tasks.add(task)
        task.add_done_callback(self._finished)

    def _finished(self, task: "asyncio.Task[None]") -> None:
        self._tasks.discard(task)
        if not task.cancelled() and task.exception() is not None:
            logger.error("a task of the session failed", exc_info=task.exception())
            self.status.fail(f"{task.exception()}. Restart the server; its log has the details.")
            self._tell_state()

    # ---- what pages see

    @property
    def beginning(self) -> Scenario:
        """The scenario as it stands at t = 0, before its sequence changes it."""
        return self._beginning

    def snapshot(self) -> Message:
        """Return the state in words and figures, as docs/protocol.md has it."""
        self.status.follow(self.ring.latest())
        figures = self._health.figures(self.scenario.timing.sample_time_s, self.status.epoch)
        return self.status.snapshot(self.scenario, figures, len(self.listeners))

    def document(self, by: str = "server") -> Message:
        """Return the live scenario and its preset."""
        preset = self.preset and self.preset.document()
        differs = self._beginning != self.scenario
        beginning = self._beginning.model_dump(mode="json") if differs else None
        return {
            "type": "document", "scenario": self.scenario.model_dump(mode="json"), "beginning": beginning,
            "preset": preset, "tuning_id": self.status.tuning_id, "by": by,
        }  # fmt: skip

    def tell(self, message: Message) -> None:
        """Send a message to every page."""
        for listener in list(self.listeners):
            listener(message)

    def _tell_state(self) -> None:
        self.tell({"type": "state", "snapshot": self.snapshot()})

    def _tell_event(self, event: Event) -> None:
        self.tell({"type": "event", "event": event.document()})

    def _tell_change(self, part: str, by: str, note: Note) -> None:
        words = [change_words(self.scenario, f"{part}.{path}", *pair) for path, pair in note.changes.items()]
        self.log.add(EVENT_KINDS[part], ", ".join(words), by, note.epoch, note.time_s)

    def note(self, kind: Kind, text: str, by: str, severity: Severity = "info") -> None:
        """Log an event of now."""
        self.log.add(kind, text, by, self.status.epoch, self.status.time_s, severity)

    # ---- reports of the control process

    def _on_report(self, report: messages.Report) -> None:
        if isinstance(report, messages.Followed):
            self._follow(report)
        if not isinstance(report, messages.Changed):
            return
        self.status.take(report)
        state = self.status.state
        severity: Severity = "fault" if state == "fault" else "warning" if state == "stopped" else "info"
        by = self.status.stopped_by or "server" if state == "stopped" else "session"
        self.note("fault" if state == "fault" else "state", self.status.sentence(self.scenario), by, severity)
        self._tell_state()
        if state == "fault":
            self._spawn(self._keep_fault())

    async def _keep_fault(self) -> None:
        period_s = self.scenario.timing.sample_time_s
        file = await asyncio.to_thread(
            save_fault_snapshot,
            self._settings.data_dir,
            self.ring.last(round(2.0 / period_s)),
            self.scenario,
            self.status.reason,
        )
        self.note("fault", f"The last 2 s before the fault are kept in {file}", "server")

    def _on_lost(self) -> None:
        self.status.fail("the control process ended unexpectedly. Press Reset to start it anew.")
        self.note("fault", self.status.sentence(self.scenario), "server", "fault")
        self._tell_state()

    # ---- commands

    async def command(self, name: str, arguments: Any, by: str) -> Message:
        """Run the command `name` for page `by`. Raises Problem."""
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

    def command_names(self) -> list[str]:
        """Return the names of all commands."""
        return list(self._commands)

    async def stop(self, _: Nothing, by: str) -> Message:
        """Motor torque off at once, stiffness held. Passes every queue: it only writes the flag."""
        self._flag.raise_()
        if self.status.state not in ("stopped", "fault"):
            self.status.stopped_by = by
        return {}

    async def tune(self, asked: Changes, by: str) -> Message:
        """Change the tuning; refused, and the old one kept, if its own sampled loop is unstable."""
        return await self._change("tuning", asked, by, self._install)

    async def set_reference(self, asked: Changes, by: str) -> Message:
        """Follow another reference, without a jump."""
        return await self._change(
            "reference", asked, by, lambda new: self._link.command(messages.SetReference(new.reference))
        )

    async def set_stiffness(self, asked: Changes, by: str) -> Message:
        """Command another stiffness; refused if the tuning would be unstable there."""

        async def command(new: Scenario) -> messages.Done:
            await self._planned(new)
            return await self._link.command(messages.SetStiffness(new.stiffness_reference))

        return await self._change("stiffness_reference", asked, by, command)

    async def set_disturbances(self, asked: Changes, by: str) -> Message:
        """Apply other disturbances, at once."""
        return await self._change(
            "disturbances", asked, by, lambda new: self._link.command(messages.SetDisturbances(new.disturbances))
        )

    async def _change(
        self, part: str, asked: Changes, by: str, apply: Callable[[Scenario], Awaitable[messages.Done]]
    ) -> Message:
        async with self._turn:
            old = self.scenario
            new = with_changes(old, part, asked)
            found = differences(old.model_dump(mode="json")[part], new.model_dump(mode="json")[part])
            if found:
                done = await apply(new)
                # Only this part: the sequence may have changed another one meanwhile.
                self.scenario = self.scenario.model_copy(update={part: getattr(new, part)})
                self.margins.ask(self.scenario, self.status.tuning_id)
                await self._keep_sequence(part, asked)
                self._notes.add(part, by, found, self.status.epoch, done.time_s)
                self.tell(self.document(by))
                self.save_soon()
            return {
                "tuning_id": self.status.tuning_id,
                "applied": {path: after for path, (_, after) in found.items()},
            }

    async def _install(self, new: Scenario) -> messages.Done:
        planned = await self._planned(new)
        done = await self._link.command(messages.Install(new.tuning, planned.prepared, self.status.tuning_id + 1))
        self.status.tuning_id += 1
        return done

    async def _keep_sequence(self, part: str, asked: Changes) -> None:
        """Let a live change hold beyond a reset, and let what is left of the sequence start from it."""
        self._beginning = self.scenario if not self.scenario.sequence else begun_with(self._beginning, part, asked)
        if self.scenario.sequence:
            planned = await self._planned(self.scenario)
            await self._link.command(messages.Plan(planned.followers))

    def _follow(self, report: messages.Followed) -> None:
        """Take over a change that the sequence made."""
        changed = dict(self.scenario.sequence[report.index].changes)
        before = self.scenario
        self.scenario = after_change(before, changed)
        self.status.tuning_id = report.tuning_id
        self.margins.ask(self.scenario, report.tuning_id)
        words = [change_words(self.scenario, path, valued(before, path), value) for path, value in changed.items()]
        self.log.add("sequence", ", ".join(words), "sequence", self.status.epoch, report.time_s)
        self.tell(self.document("sequence"))

    async def _planned(self, scenario: Scenario) -> Any:
        try:
            return await self._pool.design.run("plan_run", scenario)
        except JobRefusedError as refusal:
            sentence = str(refusal)
            raise refused(f"{sentence[:1].upper()}{sentence[1:]}. The old tuning keeps running.") from refusal
        except JobFailedError as failure:
            raise Problem(503, "Not computed", f"The tuning could not be computed: {failure}.") from failure

    async def load_scenario(self, asked: Loading, by: str) -> Message:
        """Restart with another scenario, at t = 0."""
        scenario = asked.scenario or SCENARIOS.get(asked.name or "")
        if scenario is None:
            raise Problem(
                404, "No such scenario", f"There is no scenario {asked.name!r}; known: {', '.join(SCENARIOS)}."
            )
        async with self._turn:
            await self._load(scenario)
            self.preset = None
            self.tell(self.document(by))
            self.save_soon()
        self.note("scenario", f"scenario {scenario.name} loaded", by)
        return {"tuning_id": self.status.tuning_id}

    async def _load(self, scenario: Scenario) -> None:
        planned = await self._planned(scenario)
        run = self.status.state in ("starting", "running")
        await self._link.command(messages.Load(scenario, planned, self.status.tuning_id + 1, run))
        self.status.tuning_id += 1
        self.scenario = self._beginning = scenario
        self.margins.ask(scenario, self.status.tuning_id)
        self.tell(self.document())

    async def pause(self, _: Nothing, by: str) -> Message:
        """Hold time."""
        await self._link.command(messages.Pause())
        return {}

    async def resume(self, _: Nothing, by: str) -> Message:
        """Let time run."""
        await self._link.command(messages.Resume())
        return {}

    async def step(self, asked: Samples, by: str) -> Message:
        """Advance a paused session."""
        done = await self._link.command(messages.Step(asked.samples))
        return {"time_s": done.time_s}

    async def reset(self, _: Nothing, by: str) -> Message:
        """Back to t = 0; the only way out of a stop or a fault."""
        async with self._turn:
            if self._link.ended:
                await self._link.start(self.ring_name, self._flag.name, self.status.epoch)
                await self._load(self._beginning)
            elif self.scenario.sequence:
                await self._load(self._beginning)  # what the sequence changed goes back to what it was
            else:
                await self._link.command(messages.Reset())
        self.status.stopped_by = None
        self.note("state", "reset to t = 0", by)
        return {}

    async def set_pace(self, asked: Pace, by: str) -> Message:
        """Ask for another real-time factor."""
        await self._link.command(messages.SetPace(asked.factor))
        self.status.pace = asked.factor
        self.note("state", f"real-time factor {asked.factor:g}", by)
        self._tell_state()
        return {}

    def save_soon(self) -> None:
        """Keep what runs for the next start, once changes rest."""
        if self._save_timer is not None:
            self._save_timer.cancel()
        self._save_timer = asyncio.get_running_loop().call_later(SAVE_AFTER_S, lambda: self._spawn(self._save()))

    async def _save(self) -> None:
        self._save_timer = None
        await self._kept.write()
