"""The live session: every command is one method, and REST and websocket call the same."""

import asyncio
import logging
import time
import uuid
from collections.abc import Awaitable, Callable
from itertools import count
from typing import Any

from backend.compute.pool import JobFailedError, Pool
from backend.presets.last import InForce
from backend.problem import Problem
from backend.session.arguments import Loading
from backend.session.commands import Commands
from backend.session.control_link import ControlLink
from backend.session.control_reports import ControlReports
from backend.session.disturbance_watch import DisturbanceWatch
from backend.session.events import Event, EventLog, Kind, Severity
from backend.session.excerpt import ExcerptsInMemory, ExcerptStore, NoRecordings, Recordings
from backend.session.health import Health
from backend.session.history_commands import HistoryCommands
from backend.session.journal import Journal, Silent, Unharming
from backend.session.kept_run import KeptRun
from backend.session.limit_watch import LimitWatch
from backend.session.live_margins import LiveMargins
from backend.session.part_commands import PartCommands
from backend.session.pins import Pins
from backend.session.preset_commands import PresetCommands
from backend.session.rig_connection import NoRigs, RigFiles
from backend.session.rig_session import RigSession
from backend.session.run_commands import RunCommands
from backend.session.running_scenario import RunningScenario
from backend.session.status import Status
from backend.session.trigger import Trigger
from backend.settings import Settings
from backend.store.database import Database
from backend.telemetry.ring import Ring, RingReader
from backend.telemetry.stop_flag import StopFlag
from vssea_core.scenario import Scenario
from vssea_core.scenarios import SCENARIOS

logger = logging.getLogger(__name__)

WATCH_S = 0.1
STATE_EVERY = 5  # watches between two state messages
Message = dict[str, Any]


class Session:
    """One live session: simulated, or on a rig."""

    def __init__(
        self,
        settings: Settings,
        pool: Pool,
        database: Database,
        journal: Journal | None = None,
        recordings: Recordings | None = None,
        excerpts: ExcerptStore | None = None,
        rigs: RigFiles | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.settings, self._pool = settings, pool
        self.design = pool.design
        self.journal = Unharming(journal or Silent())
        self.running = RunningScenario(SCENARIOS[settings.scenario])
        self.preset: InForce | None = None
        self.status = Status()
        self._segment, self.flag = Ring(), StopFlag()
        self.ring_name = self._segment.name
        self.run_id = uuid.uuid4().hex
        self.ring = RingReader(self._segment.name)
        self._health, self._limits = Health(self.ring), LimitWatch(self.ring)
        self._loads = DisturbanceWatch(self.ring)
        self.listeners: set[Callable[[Message], None]] = set()
        self.log = EventLog(self._tell_event)
        reports = ControlReports(self)
        self.link = ControlLink(reports.take, reports.lost)
        self.margins = LiveMargins(pool.analysis, self.tell)
        self.turn = asyncio.Lock()
        self._tasks: set[asyncio.Task[None]] = set()
        self.parts, self.runs = PartCommands(self), RunCommands(self)
        self.presets = PresetCommands(database, self)
        self.kept = KeptRun(self.presets.presets, self)
        self.history = HistoryCommands(self)
        self.rig = RigSession(self, pool, rigs or NoRigs(), clock)
        self.pins = Pins(self, recordings or NoRecordings(), excerpts or ExcerptsInMemory())
        self.trigger = Trigger(self)
        self.commands = Commands(self)

    @property
    def scenario(self) -> Scenario:
        """The scenario as it stands now."""
        return self.running.now

    @property
    def beginning(self) -> Scenario:
        """The scenario as it stands at t = 0, before its sequence changes it."""
        return self.running.beginning

    # ---- life

    def start(self) -> None:
        """Start the control process and the workers in the background; the state says when they are ready."""
        self.spawn(self._begin())
        self.spawn(self._warm_workers())
        self.spawn(self.pins.load())
        self.spawn(self._watch())

    async def close(self) -> None:
        """Save the last tuning and end the control process."""
        for task in self._tasks:
            task.cancel()
        await self.margins.stop()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        await self.kept.now()
        await self.rig.close()
        await self.link.stop()
        self.ring.close()
        self.flag.close()
        self._segment.close()

    async def _begin(self) -> None:
        last = await self.kept.read()
        if last is not None:
            self.running.load(last.scenario)
            self.preset = last.preset
        try:
            await self.start_control()
        except Problem:
            return  # its end was told, and Reset starts it anew
        try:
            await self.runs.load(self.scenario)
        except Problem as problem:
            logger.warning("the last tuning cannot be used: %s", problem.detail)
            self.preset = None
            await self.runs.load(SCENARIOS[self.settings.scenario])
            self.note(
                "scenario", f"The last tuning cannot be used: {problem.detail} Loaded {self.scenario.name}", "server"
            )
        else:
            if last is not None:
                self.note("scenario", f"{self.scenario.name} and its last tuning are back", "server")
        self.history.begin()

    async def start_control(self) -> None:
        """Start the control process; nothing runs in it yet. Raises Problem if it ends or takes too long."""
        await self.link.start(self.ring_name, self.flag.name, epoch=self.status.epoch)
        self.status.pace = 1.0

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
            self.trigger.watch()
            self.rig.watch()
            if turn % STATE_EVERY == 0 and self.listeners:
                self.tell_state()

    def spawn(self, work: Awaitable[None]) -> None:
        """Do something beside; if it fails, the state says so."""
        task = asyncio.ensure_future(work)
        self._tasks.add(task)
        task.add_done_callback(self._finished)

    def _finished(self, task: "asyncio.Task[None]") -> None:
        self._tasks.discard(task)
        if not task.cancelled() and task.exception() is not None:
            logger.error("a task of the session failed", exc_info=task.exception())
            if self.rig.connected:
                self.runs.stop_at_once("a failure in the server")  # it may be what should have watched over the rig
                self.note("fault", f"a task of the server failed: {task.exception()}", "server", "fault")
            self.status.fail(f"{task.exception()}. Restart the server; its log has the details.")
            self.tell_state()

    # ---- what pages see

    def snapshot(self) -> Message:
        """Return the state in words and figures, as docs/protocol.md has it."""
        self.status.follow(self.ring.latest())
        period_s, core = self.scenario.timing.sample_time_s, self.rig.cores.core
        figures = self._health.figures(period_s, self.status.epoch, core)
        return self.status.snapshot(self.sentence(), self.rig.document(self.scenario), figures, len(self.listeners))

    def sentence(self) -> str:
        """Return what the session is doing, and why."""
        on_rig = self.rig.file is not None
        return self.status.rig_sentence(self.rig.state) if on_rig else self.status.sentence(self.scenario)

    def document(self, by: str = "server") -> Message:
        """Return the live scenario and its preset."""
        preset = self.preset and self.preset.document()
        differs = self.running.beginning != self.scenario
        beginning = self.running.beginning.model_dump(mode="json") if differs else None
        return {
            "type": "document", "scenario": self.scenario.model_dump(mode="json"), "beginning": beginning,
            "preset": preset, "tuning_id": self.status.tuning_id, "by": by,
        }  # fmt: skip

    def tell(self, message: Message) -> None:
        """Send a message to every page."""
        for listener in list(self.listeners):
            listener(message)

    def tell_state(self) -> None:
        """Send the state to every page."""
        self.tell({"type": "state", "snapshot": self.snapshot()})

    def _tell_event(self, event: Event) -> None:
        self.journal.event(event)
        self.trigger.hear(event)
        self.tell({"type": "event", "event": event.document()})

    def recordings_changed(self, message: Message) -> None:
        """Tell every page; what was pinned of a recording that is no more goes with it."""
        self.tell(message)
        self.spawn(self.pins.load())

    def note_recording(self, sentence: str, is_trouble: bool) -> None:
        """Log an event of the recorder."""
        self.note("recording", sentence, "recorder", "warning" if is_trouble else "info")

    def note(self, kind: Kind, text: str, by: str, severity: Severity = "info") -> None:
        """Log an event of now."""
        self.status.follow(self.ring.latest())
        self.log.add(kind, text, by, self.status.epoch, self.status.time_s, severity)

    # ---- commands

    async def command(self, name: str, arguments: Any, by: str, key: str | None = None) -> Message:
        """Run the command `name` for page `by`; `key` proves that it is in control of a rig. Raises Problem."""
        return await self.commands.run(name, arguments, by, key)

    def command_names(self) -> list[str]:
        """Return the names of all commands."""
        return self.commands.names()

    async def load_scenario(self, asked: Loading, by: str) -> Message:
        """Restart with another scenario, as the command does."""
        return await self.runs.load_scenario(asked, by)
