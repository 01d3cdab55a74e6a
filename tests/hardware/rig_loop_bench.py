"""The loop of a rig on a bench: a simulated rig, a ring, a flag, beats, and a pipe whose other end is the test's."""

import numpy as np
from numpy.typing import NDArray

from backend.loop import messages
from backend.loop.messages import Changed, Done, Refused, RigReport, State
from backend.loop.pacer import Pacer
from backend.loop.rig_loop import RigLoop
from backend.rigs.faults import Fault
from backend.rigs.rig import Axis, Measured
from backend.rigs.rig_file import RigFile
from backend.rigs.simulated import SimulatedRig
from backend.telemetry.beats import LEASE, WEB, Beats
from backend.telemetry.ring import Ring, RingReader, RingWriter
from backend.telemetry.stop_flag import StopFlag
from tests.backend.loop_bench import Pipe
from vssea_core.actuator.parameters import Actuator, EquilibriumMotor, Timing
from vssea_core.channels import INDEX
from vssea_core.control.prepared import prepare
from vssea_core.control.tuning import PositionObserver, StateFeedback, Tuning
from vssea_core.scenario import Scenario
from vssea_core.scenarios import REALISTIC
from vssea_core.signals.documents import Disturbances, SineReference

T = 0.002

FILE = RigFile.model_validate(
    {
        "name": "bench",
        "rate_hz": 500,
        "bus": {"interface": "virtual"},
        "motor": {"node": 1, "counts_per_turn": 16384, "torque_limit": 74.0},
        "stiffness": {"node": 2, "counts_per_turn": 16384, "torque_limit": 0.79},
        "link": {"node": 3, "counts_per_turn": 131072},
        "limits": {
            "motor_torque": 70.0, "motor_torque_rate": 20000.0, "motor_speed": 3.0, "stiffness_torque": 0.75,
            "stiffness_speed": 400.0, "link_low": -1.6, "link_high": 1.6, "braking": 8.0, "deflection": 0.6,
            "stiffness_low": 25.0, "stiffness_high": 900.0, "jog_speed": 0.8, "stiffness_jog": 400.0,
        },
        "homing": {"torque": 0.10, "speed": 150.0, "still_s": 0.1},
    }
)  # fmt: skip

SCENARIO = REALISTIC.model_copy(
    update={
        "actuator": Actuator(motor=EquilibriumMotor(coulomb_friction=2.0, torque_lag_s=1.6e-4)),
        "timing": Timing(sample_time_s=T, compute_delay_samples=1),
        "tuning": Tuning(controller=StateFeedback(natural_frequency=12.0), observer=PositionObserver(bandwidth=80.0)),
        "reference": SineReference(amplitude=0.3, frequency_hz=0.5),
        "disturbances": Disturbances(),
    }
)


def prepared(tuning: Tuning, period_s: float = T) -> NDArray[np.float64]:
    return prepare(tuning, period_s)


class BrokenRig(SimulatedRig):
    """A simulated rig whose answers a test can spoil, and which counts what was asked of it."""

    def __init__(self, scenario: Scenario, stiffness_offset: float = 40.0) -> None:
        super().__init__(scenario, stiffness_offset)
        self.missed: dict[str, int] = {}  # cycles for which a node still answers nothing
        self.spoiled: dict[str, float] = {}  # fields of Measured that are replaced
        self.asked = [(0.0, 0.0)]
        self.orders: list[tuple[str, Axis]] = []
        self.never_enables = False
        self.closed = 0
        self._kept: Measured | None = None

    def exchange(self, motor_torque: float, stiffness_torque: float) -> Measured:
        self.asked.append((motor_torque, stiffness_torque))
        now = super().exchange(motor_torque, stiffness_torque)
        before = self._kept or now
        for part in [part for part, cycles in self.missed.items() if cycles > 0]:
            self.missed[part] -= 1
            old = {
                f"{part}_position": getattr(before, f"{part}_position"),
                f"{part}_age": getattr(before, f"{part}_age") + 1,
            }
            now = now._replace(**old)
        self._kept = now
        return now._replace(**self.spoiled)

    def arm(self, axis: Axis) -> None:
        self.orders.append(("arm", axis))
        if not self.never_enables:
            super().arm(axis)

    def stop(self, axis: Axis) -> None:
        self.orders.append(("stop", axis))
        super().stop(axis)

    def disarm(self, axis: Axis) -> None:
        self.orders.append(("disarm", axis))
        super().disarm(axis)

    def close(self) -> None:
        self.closed += 1
        super().close()

    def switch_off_by_itself(self, axis: Axis) -> None:
        super().disarm(axis)


class RigBench:
    """Drives one loop turn by turn; time is injected, server and operator are alive unless a test says otherwise."""

    def __init__(self, scenario: Scenario = SCENARIO, file: RigFile = FILE, truth: Scenario | None = None) -> None:
        self.scenario, self.file = scenario, file
        self.ring, self.flag, self.beats, self.pipe = Ring(), StopFlag(), Beats(), Pipe()
        self.reader, self.writer = RingReader(self.ring.name), RingWriter(self.ring.name)
        self.now = 1000.0
        self.alive = {WEB: True, LEASE: True}
        self.rig = BrokenRig(truth or scenario)
        self.loop = RigLoop(
            self.writer, self.flag, self.beats, self.pipe, lambda file, scenario: self.rig,  # type: ignore[arg-type]
            Pacer(lambda: self.now, self.sleep), lambda: self.now,
        )  # fmt: skip
        self._numbers = 0

    def sleep(self, duration_s: float) -> None:
        self.now += duration_s

    def send(self, command: messages.Command) -> int:
        self._numbers += 1
        self.pipe.inbox.append((self._numbers, command))
        return self._numbers

    def turn(self, missed: int = 0) -> None:
        for which, alive in self.alive.items():
            if alive:
                self.beats.beat(which)
        self.now += self.loop.turn(0.0, missed)

    def turns(self, count: int) -> None:
        for _ in range(count):
            self.turn()

    def pass_s(self, duration_s: float) -> None:
        self.turns(round(duration_s / T))

    def answer(self, number: int) -> Done | Refused | None:
        for report in self.pipe.outbox:
            if isinstance(report, Done | Refused) and report.number == number:
                return report
        return None

    def ask(self, command: messages.Command, most: int = 1200) -> Done | Refused:
        """Send a command and turn until it is answered."""
        number = self.send(command)
        for _ in range(most):
            self.turn()
            answer = self.answer(number)
            if answer is not None:
                return answer
        raise AssertionError(f"{command} was not answered")

    def do(self, command: messages.Command) -> None:
        answer = self.ask(command)
        assert isinstance(answer, Done), answer

    def refused(self, command: messages.Command) -> str:
        answer = self.ask(command)
        assert isinstance(answer, Refused), f"{command} was not refused"
        return answer.sentence

    def until(self, *states: State, most_s: float = 10.0) -> float:
        """Turn until the loop is in one of `states`; return how long it took [s]."""
        begun = self.now
        while self.state not in states:
            assert self.now - begun < most_s, f"still {self.state}, not {states}"
            self.turn()
        return self.now - begun

    @property
    def state(self) -> State:
        return self.loop.state

    def connect(self) -> None:
        tuning = self.scenario.tuning
        period_s = self.scenario.timing.sample_time_s
        self.do(messages.Connect(self.file, self.scenario, prepared(tuning, period_s), 1))
        self.pass_s(0.1)

    def home(self) -> None:
        self.do(messages.Home())
        self.until("ready", "fault")
        assert self.state == "ready", self.reason()
        self.pass_s(0.2)

    def arm(self) -> None:
        self.do(messages.Arm())
        assert self.state == "armed"

    def armed(self) -> None:
        self.connect()
        self.home()
        self.arm()
        self.pass_s(0.2)

    def follow(self) -> None:
        self.do(messages.Follow())

    def jog(self, link: float = 0.3, stiffness: float = 0.0) -> None:
        self.do(messages.Jog(link, stiffness, self.now))

    def stop(self) -> None:
        self.flag.raise_()
        self.turn()

    def changes(self) -> list[State]:
        return [report.state for report in self.pipe.outbox if isinstance(report, Changed)]

    def reason(self) -> str | None:
        return [report for report in self.pipe.outbox if isinstance(report, Changed)][-1].reason

    def report(self) -> RigReport:
        return [report for report in self.pipe.outbox if isinstance(report, RigReport)][-1]

    def faults(self) -> list[int]:
        return [fault.number for fault in self.report().faults]

    def has(self, fault: Fault) -> bool:
        return fault.number in self.faults()

    def channel(self, name: str) -> NDArray[np.float64]:
        return self.reader.since(0).samples[:, INDEX[name]]

    def enabled(self) -> list[Axis]:
        return [axis for axis in ("motor", "stiffness") if self.rig.axis(axis).state == "enabled"]

    def close(self) -> None:
        self.reader.close()
        self.writer.close()
        self.ring.close()
        self.flag.close()
        self.beats.close()
