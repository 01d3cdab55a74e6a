"""Any sequence of commands, faults and silences, on a simulated rig: nothing moves that was not armed, nothing re-arms itself."""

import math

import numpy as np
import pytest
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, rule, run_state_machine_as_test

from backend.loop import messages
from backend.loop.messages import Done
from backend.loop.rig_states import DRIVEN
from backend.rigs.faults import CORRUPTED, LINK_ENCODER, REBOOTED
from backend.rigs.rig import AXES
from backend.telemetry.beats import LEASE, WEB
from tests.hardware.rig_loop_bench import FILE, RigBench, prepared
from vssea_core.control.tuning import StateFeedback
from vssea_core.signals.documents import ConstantStiffness, MoveReference, Reference, SineReference, StepReference

FAST = FILE.model_copy(update={"homing": FILE.homing.model_copy(update={"speed": 300.0, "still_s": 0.05})})
SETTINGS = settings(
    max_examples=25,
    stateful_step_count=40,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
parts = st.sampled_from(["link", "motor", "stiffness"])
axes = st.sampled_from(AXES)
references = st.sampled_from(
    [
        SineReference(amplitude=0.3, frequency_hz=0.5),
        SineReference(amplitude=1.5, frequency_hz=2.0),
        MoveReference(origin=0.0, target=0.6),
        StepReference(origin=0.0, target=1.0),
    ]
)


class AnySequence(RuleBasedStateMachine):
    """Turns the loop and looks at the rig after each turn."""

    def __init__(self) -> None:
        super().__init__()
        self.bench = RigBench(file=FAST)
        self.may_be_on = dict.fromkeys(AXES, False)  # armed or homed since the last stop or fault
        self.state = self.bench.state
        self.tuning_id = 1

    def teardown(self) -> None:
        self.bench.close()

    @initialize(how=st.sampled_from(["connected", "ready", "armed", "running"]))
    def begin(self, how: str) -> None:
        self.bench.connect()
        self.state = self.bench.state
        if how != "connected":
            self.ask(messages.Home())
            while self.state == "homing":
                self.turn()
            assert self.state == "ready"
            self.turns(50)
        if how in ("armed", "running"):
            self.ask(messages.Arm())
            self.turns(30)
        if how == "running":
            self.ask(messages.Follow())
            self.turns(100)

    def ask(self, command: messages.Command) -> None:
        number = self.bench.send(command)
        self.turn()
        for _ in range(800):
            answer = self.bench.answer(number)
            if answer is not None:
                break
            self.turn()
        assert answer is not None, f"{command} was never answered"
        if not isinstance(answer, Done):
            assert answer.sentence
            assert not answer.sentence.endswith(".")

    def turns(self, count: int) -> None:
        for _ in range(count):
            self.turn()

    def turn(self) -> None:
        self.bench.rig.orders.clear()
        self.bench.turn()
        self.look()

    def look(self) -> None:
        bench = self.bench
        before, self.state = self.state, bench.state
        for order, axis in bench.rig.orders:
            if order == "arm":
                assert before in ("connected", "ready", "homing"), f"{axis} armed in {before}"
                self.may_be_on[axis] = True
        motor, stiffness = bench.rig.asked[-1]
        assert math.isfinite(motor)
        assert math.isfinite(stiffness)
        assert abs(motor) <= 70.0 + 1e-9
        assert abs(stiffness) <= 0.75 + 1e-9
        driven = {before, self.state} & DRIVEN
        assert motor == 0.0 or driven, f"{motor} N·m in {self.state}"
        if stiffness != 0.0 and not driven:  # it may go on holding a loaded spring; it never comes back to it
            assert self.may_be_on["stiffness"], f"{stiffness} N·m in {self.state}"
        for axis in AXES:
            if bench.rig._drives[axis].state == "enabled":
                assert self.may_be_on[axis], f"{axis} is enabled in {self.state}"
            elif bench.rig._drives[axis].state in ("disabled", "fault") and self.state not in ("ready", "homing"):
                self.may_be_on[axis] = False  # in those two it may be on its way
        if self.state in ("armed", "running"):
            assert before in ("armed", "running", "ready"), f"{before} to {self.state}"
            assert not bench.report().faults

    @rule(seconds=st.sampled_from([0.002, 0.02, 0.1, 0.4]))
    def pass_time(self, seconds: float) -> None:
        self.turns(max(1, round(seconds / 0.002)))

    @rule()
    def press_stop(self) -> None:
        self.bench.flag.raise_()
        self.turn()
        assert self.state in ("stopping", "stopped", "fault")

    @rule(
        command=st.sampled_from(
            [messages.Home, messages.Arm, messages.Disarm, messages.Follow, messages.Hold, messages.Reset]
        )
    )
    def tell(self, command: type[messages.Command]) -> None:
        self.ask(command())

    @rule(
        link=st.sampled_from([0.0, 0.3, -0.8, 5.0]),
        stiffness=st.sampled_from([0.0, 300.0, -300.0]),
        age=st.sampled_from([0.0, 1.0]),
    )
    def jog(self, link: float, stiffness: float, age: float) -> None:
        self.ask(messages.Jog(link, stiffness, self.bench.now - age))

    @rule(position=st.floats(-2.0, 2.0), speed=st.sampled_from([0.1, 0.8, 3.0]))
    def go_to(self, position: float, speed: float) -> None:
        self.ask(messages.GoTo(position, speed))

    @rule(reference=references)
    def set_reference(self, reference: Reference) -> None:
        self.ask(messages.SetReference(reference))

    @rule(stiffness=st.floats(25.0, 900.0))
    def set_stiffness(self, stiffness: float) -> None:
        self.ask(messages.SetStiffness(ConstantStiffness(stiffness=stiffness)))

    @rule(poles=st.floats(4.0, 40.0), spoilt=st.booleans())
    def install(self, poles: float, spoilt: bool) -> None:
        self.tuning_id += 1
        tuning = self.bench.scenario.tuning.model_copy(update={"controller": StateFeedback(natural_frequency=poles)})
        numbers = prepared(tuning)
        if spoilt:
            numbers[40] = np.nan
        self.ask(messages.Install(tuning, numbers, self.tuning_id))

    @rule(part=parts, cycles=st.sampled_from([1, 2, 3, 6, 12]))
    def miss(self, part: str, cycles: int) -> None:
        self.bench.rig.missed[part] = cycles

    @rule(part=parts, angle=st.sampled_from([0.05, -0.3, 4.0]))
    def jump(self, part: str, angle: float) -> None:
        self.bench.rig.jump_encoder(part, angle)  # type: ignore[arg-type]

    @rule(part=parts)
    def freeze(self, part: str) -> None:
        self.bench.rig.freeze_encoder(part)  # type: ignore[arg-type]

    @rule(axis=axes)
    def fault_drive(self, axis: str) -> None:
        self.bench.rig.fault_drive(axis)  # type: ignore[arg-type]

    @rule(axis=axes)
    def switch_off(self, axis: str) -> None:
        if self.bench.rig._drives[axis].state != "fault":  # type: ignore[index]
            self.bench.rig.switch_off_by_itself(axis)  # type: ignore[arg-type]

    @rule(fault=st.sampled_from([LINK_ENCODER, CORRUPTED, REBOOTED]))
    def report(self, fault: object) -> None:
        self.bench.rig.report(fault)  # type: ignore[arg-type]

    @rule()
    def cut(self) -> None:
        self.bench.rig.cut_bus()

    @rule()
    def mend(self) -> None:
        self.bench.rig.mend()

    @rule(which=st.sampled_from([WEB, LEASE]), alive=st.booleans())
    def beat(self, which: int, alive: bool) -> None:
        self.bench.alive[which] = alive

    @invariant()
    def rows_go_on(self) -> None:
        if self.state != "starting":
            row = self.bench.reader.latest()
            assert row is not None
            assert np.isfinite(row[0])


def test_nothing_moves_unarmed_and_nothing_re_arms_by_itself() -> None:
    run_state_machine_as_test(AnySequence, settings=SETTINGS)


@pytest.mark.parametrize("silent", [WEB, LEASE])
def test_what_was_pressed_while_nobody_was_in_control_does_not_come_back(silent: int) -> None:
    bench = RigBench()
    try:
        bench.armed()
        bench.alive[silent] = False
        bench.pass_s(2.0)
        bench.alive[silent] = True
        bench.send(messages.Jog(0.3, 0.0, bench.now - 1.0))
        bench.pass_s(1.0)
        assert bench.state == "stopped"
        assert bench.enabled() == []
    finally:
        bench.close()
