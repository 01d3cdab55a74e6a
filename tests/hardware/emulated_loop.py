"""The loop of a rig, its CANopen driver and the emulator, in one process and in injected time: no socket, no waiting."""

import can

from backend.emulator.emulator import Emulator
from backend.emulator.faults import Faults
from backend.emulator.plant import default_actuator
from backend.rigs.canopen import CanopenRig
from tests.hardware.fake_bus import ANSWER_DELAY_S, FakeBus, frame
from tests.hardware.fake_rig import GEAR_RATIO, RIG_FILE
from tests.hardware.rig_loop_bench import RigBench, T
from tests.injected_clock import Clock
from vssea_core.actuator.parameters import Timing
from vssea_core.control.tuning import PositionObserver, StateFeedback, Tuning
from vssea_core.scenarios import REALISTIC
from vssea_core.signals.documents import Disturbances, SineReference

SCENARIO = REALISTIC.model_copy(
    update={
        "actuator": default_actuator(),
        "timing": Timing(sample_time_s=T, compute_delay_samples=1),
        "tuning": Tuning(controller=StateFeedback(natural_frequency=12.0), observer=PositionObserver(bandwidth=80.0)),
        "reference": SineReference(amplitude=0.3, frequency_hz=0.5),
        "disturbances": Disturbances(),
    }
)


class EmulatorBus(FakeBus):
    """A bus whose nodes are the emulator's."""

    def __init__(self, clock: Clock) -> None:
        super().__init__(clock)
        self.emulator = Emulator(SCENARIO.actuator, self._from_emulator, clock.now)

    def send(self, message: can.Message, timeout: float | None = None) -> None:
        self.emulator.receive(message.arbitration_id, bytes(message.data), self.clock.now)
        self.emulator.turn(self.clock.now)

    def recv(self, timeout: float) -> can.Message | None:
        message = super().recv(timeout)
        self.emulator.turn(self.clock.now)
        return message

    def _from_emulator(self, can_id: int, data: bytes) -> None:
        self.post(frame(can_id, data), ANSWER_DELAY_S)


class EmulatedBench(RigBench):
    """The bench of the loop with the emulated rig in place of the simulated one."""

    def __init__(self) -> None:
        self.time = Clock()
        super().__init__(SCENARIO, RIG_FILE)
        self.bus = EmulatorBus(self.time)
        self.faults_of = Faults(self.bus.emulator, lambda code: None)
        self.canopen = CanopenRig(RIG_FILE, GEAR_RATIO, opened=lambda bus: self.bus, clock=self.time)  # type: ignore[arg-type, return-value]
        self.rig = self.canopen  # type: ignore[assignment]

    @property
    def now(self) -> float:
        return self.time.now

    @now.setter
    def now(self, value: float) -> None:
        self.time.now = max(self.time.now, value)

    def turn(self, missed: int = 0) -> None:
        for which, alive in self.alive.items():
            if alive:
                self.beats.beat(which)
        began = self.now
        self.now = began + self.loop.turn(0.0, missed)
