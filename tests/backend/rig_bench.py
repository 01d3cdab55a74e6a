"""A session on the bench that can connect a rig: the rig's control process is a script that answers as one does."""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from backend.loop import messages
from backend.loop.messages import AxisReport, Changed, Done, LatchedFault, Moved, RigReport
from backend.problem import Problem, refused
from backend.rigs.faults import FAULTS
from backend.rigs.library import rig_file_of
from backend.rigs.rig import AXES, Identity
from backend.rigs.rig_file import RigFile
from backend.session.control_link import RIG_ENTRY
from backend.session.control_reports import ControlReports
from backend.session.session import Session
from backend.telemetry.beats import LEASE, WEB, Beats
from backend.telemetry.ring import EPOCH, PERIOD_S, RingWriter
from tests.backend.session_bench import BenchLink, SessionBench, on_bench
from tests.injected_clock import Clock
from vssea_core.channels import INDEX
from vssea_core.scenario import Scenario
from vssea_core.scenarios import REALISTIC
from vssea_core.signals.documents import ConstantStiffness, JogReference

SINE = {"kind": "sine", "amplitude": 0.2, "frequency_hz": 0.5, "offset": 0.312}

EMULATOR = rig_file_of((Path(__file__).parents[2] / "backend/rigs/emulator.toml").read_text("utf-8"))
IDENTITY = Identity("emulated", "emulator", (("motor drive, node 1", "emulated drive"),))
REPORT = RigReport(
    "emulated", False, None, "drives off", ("not homed",),
    tuple(AxisReport(axis, "disabled", "switch on disabled", 0x40, 0, "", 0, 0.0, 0.0) for axis in AXES),
    0, (), 0, 0, 0, 250.0, 0.0, IDENTITY,
)  # fmt: skip
HOLD = JogReference(velocity=0.0, acceleration=2.0)


class Shelf:
    """Rigs by name."""

    def __init__(self, *rigs: RigFile) -> None:
        self.rigs = {rig.name: rig for rig in rigs or (EMULATOR,)}

    def file(self, name: str) -> RigFile:
        if name not in self.rigs:
            raise Problem(404, "No such rig", f"There is no rig {name!r}.")
        return self.rigs[name]


class ScriptedRig:
    """What a rig's control process answers and reports; nothing turns by itself."""

    def __init__(self, session: Session, epoch: int) -> None:
        self._reports, self._session = ControlReports(session), session
        self.writer = RingWriter(session.ring_name)
        self.epoch, self.time_s = epoch, 0.0
        self.state: messages.State = "starting"
        self.report = REPORT
        self.asked: list[messages.Command] = []
        self.refusals: dict[type[messages.Command], str] = {}
        self.scenario: Scenario | None = None
        self.wanted: Any = None

    def obey(self, command: messages.Command) -> None:
        """Carry a command out. Raises ValueError with a sentence."""
        self.asked.append(command)
        if type(command) in self.refusals:
            raise ValueError(self.refusals[type(command)])
        match command:
            case messages.Connect(scenario=scenario):
                self.scenario, self.wanted, self.epoch = scenario, scenario.reference, self.epoch + 1
                self.state = "connected"
                self.tell(Changed("connected", None, self.epoch, self.time_s))
                asyncio.get_running_loop().call_soon(self.tell, self.report)  # after the answer, as the real one
            case messages.Home():
                self.become("homing")
                self.become("ready", homed=True, cannot_arm=())
            case messages.Arm():
                self.moved("reference", HOLD, "armed")
                self.moved("stiffness_reference", ConstantStiffness(stiffness=137.0), "armed")
                self.become("armed", motion="holding 0.312 rad")
            case messages.Disarm():
                self.become("ready", motion="drives off")
            case messages.Follow():
                self.moved("reference", self.wanted, "follow")
                self.become("running", motion="tracking")
            case messages.Jog(link=link):
                self.moved("reference", JogReference(velocity=link), "jog")
                if link:
                    self.become("running", motion=f"jogging {link:.2f} rad/s")
            case messages.Hold():
                self.moved("reference", HOLD, "hold")
                self.become("armed", motion="holding 0.312 rad")
            case messages.SetReference(reference=reference):
                self.wanted = reference
            case messages.Reset():
                if any(fault.stands for fault in self.report.faults):
                    raise ValueError(self.report.faults[0].sentence)
                self.become("ready", faults=())

    def become(self, state: messages.State, reason: str | None = None, **report: Any) -> None:
        if state != self.state:
            self.state = state
            self.tell(Changed(state, reason, self.epoch, self.time_s))
        self.report = replace(self.report, **report)
        self.tell(self.report)

    def moved(self, part: Any, value: Any, why: str) -> None:
        assert self.scenario is not None
        self.scenario = self.scenario.model_copy(update={part: value})
        self.tell(Moved(part, self.scenario, self.time_s, why))

    def fail(self, number: int, stands: bool = False) -> None:
        fault = next(fault for fault in FAULTS if fault.number == number)
        latched = LatchedFault(number, fault.name, fault.sentence(), self.time_s, stands)
        self.become("fault", fault.sentence(), faults=(latched,), motion="drives off")

    def measure(self, samples: int, **channels: float) -> None:
        """Write samples as the loop does."""
        for _ in range(samples):
            _, rows = self.writer.room(1)
            rows[:] = 0.0
            for name, value in channels.items():
                rows[0, INDEX[name]] = value
            rows[0, INDEX["time"]], rows[0, EPOCH], rows[0, PERIOD_S] = self.time_s, self.epoch, 0.002
            self.writer.announce(1)
            self.time_s += 0.002

    def tell(self, report: messages.Report) -> None:
        self._reports.take(report)


class SwitchingLink:
    """The bench's control loop, or the scripted rig: never both, and each ends before the other begins."""

    def __init__(self, session: Session, simulation: BenchLink) -> None:
        self._session = session
        self.simulation: BenchLink | None = simulation
        self.rig: ScriptedRig | None = None
        self.beats: Beats | None = None
        self.refuses: dict[type[messages.Command], str] = {}
        self.died = False
        self.farewells: list[Any] = []
        self.started: list[str] = []

    @property
    def ended(self) -> bool:
        return self.died

    async def start(self, *shared: str, epoch: int, entry: str = "") -> None:
        await self.stop()
        self.died = False
        self.started.append(entry or "simulation")
        if entry == RIG_ENTRY:
            self.beats = Beats(shared[2])
            self.rig = ScriptedRig(self._session, epoch)
            self.rig.refusals = self.refuses
        else:
            self.simulation = BenchLink(self._session)
            self.simulation.loop.epoch = epoch

    async def command(self, command: messages.Command, limit_s: float = 2.0) -> Done:
        await asyncio.sleep(0)
        if self.died:
            raise Problem(503, "No answer", "The control process does not answer.")
        if self.rig is None:
            assert self.simulation is not None
            return await self.simulation.command(command)
        try:
            self.rig.obey(command)
        except ValueError as refusal:
            raise refused(f"{refusal}") from refusal
        return Done(0, self.rig.time_s)

    async def stop(self, farewell: messages.Command | None = None) -> None:
        if farewell is not None and not self.died:
            self.farewells.append(farewell)
        rig, self.rig = self.rig, None
        if rig is not None:
            rig.writer.close()
        if self.beats is not None:
            self.beats.close()
            self.beats = None
        simulation, self.simulation = self.simulation, None
        if simulation is not None:
            await simulation.stop()

    def die(self) -> None:
        """End as a killed process does."""
        self.died = True
        ControlReports(self._session).lost()


class RigBench(SessionBench):
    """A bench whose pages have keys, as websockets do."""

    clock: Clock

    def switch(self) -> None:
        """Put the link in that goes both ways."""
        self.switching = SwitchingLink(self.session, self.link)
        self.session.link = self.switching  # type: ignore[assignment]
        self.keys = {name: self.session.rig.control.join(name) for name in ("page 1", "page 2")}

    @property
    def rig(self) -> ScriptedRig:
        assert self.switching.rig is not None
        return self.switching.rig

    async def ask(self, command: str, by: str = "page 1", **arguments: Any) -> dict[str, Any]:
        return await self.call(command, by, self.keys.get(by), **arguments)

    async def call(self, command: str, by: str, key: str | None, **arguments: Any) -> dict[str, Any]:
        answer = await self.session.command(command, arguments, by, key)
        await asyncio.sleep(0)
        return answer

    async def to(self, state: str) -> None:
        """Bring a rig from nothing to a state."""
        for command, after in (("connect_rig", "connected"), ("home_stiffness", "ready"), ("arm", "armed")):
            await self.ask("renew_control") if command != "connect_rig" else None
            await self.ask(command, **({"rig": "emulator"} if command == "connect_rig" else {}))
            if after == state:
                return
        raise ValueError(state)

    async def passed(self, duration_s: float) -> None:
        """Let time go by as the session's watch sees it, the operator alive."""
        for _ in range(max(1, round(duration_s / 0.1))):
            self.clock.now += 0.1
            if self.session.rig.control.document()["operator"] == "page 1":
                await self.ask("renew_control")
            self.session.rig.watch()
        await self.settled()

    async def settled(self) -> None:
        """Let what the session does beside come to its end."""
        await asyncio.sleep(0)
        while self.session._tasks:
            await asyncio.gather(*self.session._tasks, return_exceptions=True)
            await asyncio.sleep(0)

    def beats(self) -> tuple[int, int]:
        assert self.switching.beats is not None
        return self.switching.beats.count(WEB), self.switching.beats.count(LEASE)

    def snapshot(self) -> dict[str, Any]:
        return self.session.snapshot()

    def events(self, kind: str) -> list[str]:
        return [event["text"] for event in self.session.log.last(500) if event["kind"] == kind]


@asynccontextmanager
async def on_rig_bench(folder: Path, scenario: Scenario = REALISTIC, **options: Any) -> AsyncIterator[RigBench]:
    """A simulated session that can connect the emulated rig, or those of `rigs`; time is the clock's."""
    clock = Clock()
    options = {"rigs": Shelf(), "clock": clock} | options
    async with on_bench(folder, scenario, bench=RigBench, **options) as bench:
        assert isinstance(bench, RigBench)
        bench.clock = clock
        bench.switch()
        yield bench


def at_rig(folder: Path, work: Callable[[RigBench], Any], **options: Any) -> None:
    """Run a test's coroutine on the bench."""

    async def run() -> None:
        async with on_rig_bench(folder, **options) as bench:
            await work(bench)

    asyncio.run(run())


async def refusal_of(bench: RigBench, command: str, by: str = "page 1", **arguments: Any) -> Problem:
    """Why a command is refused."""
    with pytest.raises(Problem) as refusal:
        await bench.ask(command, by, **arguments)
    return refusal.value


# ---- there and back
