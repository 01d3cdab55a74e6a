"""Faults: each latches with its number, takes both axes to safety, and is taken back only when its cause is gone."""

import math
from collections.abc import Callable, Iterator

import numpy as np
import pytest

from backend.loop import messages
from backend.loop.messages import State
from backend.rigs.faults import (
    BUS_OFF,
    CORRUPTED,
    DEFLECTION,
    DISTURBANCE,
    ENABLE_TIMEOUT,
    END_STOP,
    FOLLOWING,
    HOMING,
    HOT,
    LEFT_ENABLED,
    LINK_ENCODER,
    LINK_FROZEN,
    LINK_JUMP,
    LINK_OVERSPEED,
    MOTOR_DRIVE,
    MOTOR_JUMP,
    NOT_A_NUMBER,
    OUTSIDE,
    REBOOTED,
    STIFFNESS_DRIVE,
    STIFFNESS_JUMP,
    TORQUE_NOT_GIVEN,
    Fault,
)  # fmt: skip
from backend.rigs.rig import AXES, Axis, AxisStatus, RigError
from tests.hardware.rig_loop_bench import SCENARIO, RigBench, T, prepared
from vssea_core.actuator.parameters import Actuator, StiffnessMechanism
from vssea_core.signals.documents import ConstantDisturbance, Disturbances


@pytest.fixture
def bench() -> Iterator[RigBench]:
    opened = RigBench()
    yield opened
    opened.close()


Break = Callable[[RigBench], None]


def load(torque: float) -> Break:
    return lambda bench: bench.rig.set_disturbances(Disturbances(link=(ConstantDisturbance(torque=torque),)))


def kick(bench: RigBench) -> None:
    """A load that throws the link."""
    load(-14.0)(bench)


CAUSES: list[tuple[str, Fault, Break, float]] = [
    ("motor drive", MOTOR_DRIVE, lambda b: b.rig.fault_drive("motor"), T),
    ("stiffness drive", STIFFNESS_DRIVE, lambda b: b.rig.fault_drive("stiffness"), T),
    ("hot", HOT, lambda b: b.rig.fault_drive("motor", 0x4210, "over-temperature"), T),
    ("left", LEFT_ENABLED, lambda b: b.rig.switch_off_by_itself("stiffness"), T),
    ("left, motor", LEFT_ENABLED, lambda b: b.rig.switch_off_by_itself("motor"), T),
    ("link jump", LINK_JUMP, lambda b: b.rig.jump_encoder("link", 0.05), T),
    ("motor jump", MOTOR_JUMP, lambda b: b.rig.jump_encoder("motor", 0.02), T),
    ("stiffness jump", STIFFNESS_JUMP, lambda b: b.rig.jump_encoder("stiffness", 3.0), T),
    ("link frozen", LINK_FROZEN, lambda b: b.rig.freeze_encoder("link"), 0.4),
    ("encoder emergency", LINK_ENCODER, lambda b: b.rig.report(LINK_ENCODER, "error 0x5000"), T),
    ("corrupted", CORRUPTED, lambda b: b.rig.report(CORRUPTED, "5 frames"), T),
    ("rebooted", REBOOTED, lambda b: b.rig.report(REBOOTED, "node 2"), T),
    ("bus off", BUS_OFF, lambda b: b.rig.report(BUS_OFF), T),
    ("weak motor", TORQUE_NOT_GIVEN, lambda b: b.rig.spoiled.update(motor_torque_seen=0.0), 1.5),
    ("link overspeed", LINK_OVERSPEED, kick, 1.0),
    ("outside", OUTSIDE, lambda b: b.rig.spoiled.update(link_position=1.7), T),
    ("position is no number", CORRUPTED, lambda b: b.rig.spoiled.update(motor_position=math.nan), T),
]


@pytest.mark.parametrize(("name", "fault", "break_it", "within_s"), CAUSES, ids=[case[0] for case in CAUSES])
def test_a_fault_latches_in_time_and_takes_both_axes_to_safety(
    bench: RigBench, name: str, fault: Fault, break_it: Break, within_s: float
) -> None:
    bench.armed()
    bench.follow()
    bench.pass_s(1.2)
    assert (bench.state, bench.report().faults) == ("running", ())
    break_it(bench)
    begun = bench.now
    while not bench.has(fault):
        assert bench.now - begun < within_s + T, f"{bench.state}, {bench.report().faults}"
        bench.turn()
    bench.until("fault", most_s=2.0)
    assert bench.report().faults[0].sentence == bench.reason()
    assert bench.report().faults[0].at_s == pytest.approx(bench.channel("time")[-1], abs=3.0)
    bench.pass_s(0.7)
    assert bench.rig.axis("motor").state in ("disabled", "fault")
    assert bench.rig.given[0] == 0.0
    bench.pass_s(3.0)
    assert "running" not in bench.changes()[bench.changes().index("stopping") :]


def test_the_controller_that_computes_no_number_is_a_fault_and_sends_none(bench: RigBench) -> None:
    bench.armed()
    bench.follow()
    bench.pass_s(0.5)
    tuning = bench.scenario.tuning
    bench.do(
        messages.Install(tuning, prepared(tuning) * np.where(np.arange(len(prepared(tuning))) == 40, np.nan, 1.0), 2)
    )
    bench.turns(3)
    assert bench.has(NOT_A_NUMBER)
    bench.until("fault", most_s=2.0)
    assert np.isfinite(bench.rig.asked).all()
    bench.pass_s(0.2)
    assert bench.enabled() == []


@pytest.mark.parametrize("axis", AXES)
def test_a_drive_fault_stops_the_other_axis_in_the_same_turn(bench: RigBench, axis: Axis) -> None:
    bench.armed()
    bench.follow()
    bench.pass_s(0.8)
    bench.rig.fault_drive(axis)
    bench.turn()
    assert bench.state == "stopping"
    bench.until("fault", most_s=2.0)
    assert bench.enabled() == []


@pytest.mark.parametrize("state", ["connected", "ready", "stopped"])
def test_a_fault_of_a_rig_that_is_off_is_one_at_once(bench: RigBench, state: State) -> None:
    bench.connect()
    if state != "connected":
        bench.home()
    if state == "stopped":
        bench.stop()
    bench.rig.fault_drive("motor", 0x3210, "over-voltage")
    bench.turn()
    assert bench.state == "fault"
    assert "0x3210, over-voltage" in str(bench.reason())


def test_reset_is_refused_while_the_cause_stands_and_leads_to_ready_when_it_is_gone(bench: RigBench) -> None:
    bench.armed()
    bench.rig.fault_drive("motor")
    bench.turn()
    bench.until("fault", most_s=2.0)
    assert "still reports error 0x2310" in bench.refused(messages.Reset())
    assert bench.state == "fault"
    assert bench.report().faults[0].stands
    bench.rig.mend()
    bench.do(messages.Reset())
    assert bench.state == "ready"
    assert bench.enabled() == []
    bench.turn()
    assert bench.report().faults == ()
    assert bench.report().cannot_arm == ()
    bench.arm()


def test_reset_is_refused_while_a_node_is_silent(bench: RigBench) -> None:
    bench.armed()
    bench.rig.silence("link")
    bench.until("fault", most_s=4.0)
    assert "silent for 10 cycles" in bench.refused(messages.Reset())
    bench.rig.mend()
    bench.pass_s(0.4)
    bench.do(messages.Reset())
    assert bench.state == "ready"


def test_a_rebooted_node_needs_another_connection(bench: RigBench) -> None:
    bench.armed()
    bench.rig.report(REBOOTED, "node 2")
    bench.until("fault", most_s=4.0)
    bench.pass_s(5.0)
    assert "connect again" in bench.refused(messages.Reset())


def test_a_link_outside_its_limits_is_moved_back_by_hand_before_the_reset(bench: RigBench) -> None:
    bench.armed()
    bench.rig.spoiled = {"link_position": 1.7, "motor_position": 1.7}
    bench.turn()
    bench.until("fault", most_s=4.0)
    bench.rig.spoiled = {"link_position": 1.66, "motor_position": 1.66}
    bench.pass_s(1.0)
    assert "limits" in bench.refused(messages.Reset())
    bench.rig.spoiled = {}
    bench.pass_s(0.5)
    bench.do(messages.Reset())


@pytest.mark.parametrize("fault", [STIFFNESS_JUMP, END_STOP])
def test_after_losing_its_place_the_stiffness_axis_has_to_be_homed_again(bench: RigBench, fault: Fault) -> None:
    bench.armed()
    if fault is STIFFNESS_JUMP:
        bench.rig.jump_encoder("stiffness", 3.0)
    else:
        bench.rig.spoiled = {"stiffness_position": 115.0}
    bench.turn()
    bench.rig.spoiled = {}
    assert bench.has(fault)
    bench.until("fault", most_s=4.0)
    bench.pass_s(1.0)
    bench.do(messages.Reset())
    assert bench.state == "connected"
    assert "home it" in bench.refused(messages.Arm())
    bench.home()
    bench.arm()


def test_a_load_that_deflects_the_spring_too_far_is_a_fault(bench: RigBench) -> None:
    bench.armed()
    bench.rig.spoiled = {"motor_position": bench.rig.plant.theta_e + 0.76}
    bench.turn()
    assert bench.has(DEFLECTION)


def test_a_second_fault_during_the_stop_latches_behind_the_first(bench: RigBench) -> None:
    bench.armed()
    bench.follow()
    bench.pass_s(0.6)
    bench.rig.jump_encoder("link", 0.05)
    bench.turn()
    bench.rig.fault_drive("motor")
    bench.until("fault", most_s=2.0)
    assert bench.faults()[:2] == [LINK_JUMP.number, MOTOR_DRIVE.number]
    assert LINK_JUMP.cause in str(bench.reason())


def test_a_fault_during_a_stop_on_request_ends_at_fault(bench: RigBench) -> None:
    bench.armed()
    bench.stop()
    bench.rig.fault_drive("stiffness")
    bench.until("fault", "stopped", most_s=2.0)
    assert bench.state == "fault"


def test_drives_that_do_not_come_into_operation_are_a_fault_after_a_second(bench: RigBench) -> None:
    bench.connect()
    bench.home()
    bench.rig.never_enables = True
    begun = bench.now
    assert "drive did not come into operation" in bench.refused(messages.Arm())
    assert 1.0 <= bench.now - begun < 1.1
    bench.until("fault", most_s=1.5)
    assert bench.has(ENABLE_TIMEOUT)


def test_a_stiffness_drive_that_does_not_come_into_operation_ends_homing(bench: RigBench) -> None:
    bench.connect()
    bench.rig.never_enables = True
    bench.do(messages.Home())
    assert 0.99 <= bench.until("stopping", "fault", most_s=2.0) < 1.1
    bench.until("fault", most_s=2.0)
    assert bench.has(ENABLE_TIMEOUT)


def test_homing_that_finds_another_span_is_a_fault_with_its_figures() -> None:
    bench = RigBench(
        truth=SCENARIO.model_copy(update={"actuator": Actuator(stiffness=StiffnessMechanism(softest=22.0))})
    )
    try:
        bench.connect()
        bench.do(messages.Home())
        bench.until("fault", most_s=5.0)
        assert bench.has(HOMING)
        assert "the stops are 80.7 rad apart, expected 84.3 ± 1.7 rad" in str(bench.reason())
        assert bench.enabled() == []
        assert not bench.report().homed
        bench.pass_s(0.5)
        bench.do(messages.Reset())
        assert bench.state == "connected"
    finally:
        bench.close()


def test_a_model_whose_observer_blames_the_rig_is_a_fault(bench: RigBench) -> None:
    bench.armed()
    bench.follow()
    bench.pass_s(0.5)
    model = bench.scenario.tuning.model.model_copy(update={"motor_inertia": 60.0, "link_inertia": 4.0})
    wrong = bench.scenario.tuning.model_copy(update={"model": model})
    bench.do(messages.Install(wrong, prepared(wrong), 2))
    bench.until("stopping", "fault", most_s=6.0)
    assert bench.report().faults[0].number in (DISTURBANCE.number, FOLLOWING.number, OUTSIDE.number)
    bench.until("fault", most_s=2.0)
    bench.pass_s(1.0)
    assert abs(bench.rig.plant.omega_e) < 0.05


def test_an_exchange_that_fails_is_a_missed_cycle_and_latches_its_fault(
    bench: RigBench, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench.armed()

    def fails(motor_torque: float, stiffness_torque: float) -> None:
        raise RigError(BUS_OFF, "controller is off")

    monkeypatch.setattr(bench.rig, "exchange", fails)
    bench.turn()
    assert bench.faults() == [BUS_OFF.number]
    bench.until("fault", most_s=3.0)


def test_after_a_fault_the_exchange_goes_on_without_torque_and_is_recorded(bench: RigBench) -> None:
    bench.armed()
    bench.rig.report(LINK_ENCODER)
    bench.until("fault", most_s=4.0)
    bench.pass_s(1.0)
    before = bench.reader.written
    bench.pass_s(1.0)
    assert bench.reader.written - before == 500
    assert (np.array(bench.rig.asked[-500:]) == 0.0).all()
    assert np.isfinite(bench.channel("link_position")).all()


def test_a_fault_is_reported_in_its_own_turn(bench: RigBench) -> None:
    bench.armed()
    bench.turns(3)
    bench.pipe.outbox.clear()
    bench.rig.jump_encoder("link", 0.05)
    bench.turn()
    kinds = [type(report) for report in bench.pipe.outbox]
    assert messages.Changed in kinds
    assert bench.faults() == [LINK_JUMP.number]


def test_a_drive_that_recovers_by_itself_is_not_brought_back(bench: RigBench) -> None:
    """The rig is told to leave the axis off, whatever the drive does later."""
    bench.armed()
    bench.rig.orders.clear()
    bench.rig.fault_drive("stiffness")
    bench.turn()
    assert ("disarm", "stiffness") in bench.rig.orders
    bench.stop()
    bench.rig.fault_drive("motor")
    bench.turn()
    assert ("disarm", "motor") in bench.rig.orders
    bench.rig.mend()
    for axis in AXES:
        bench.rig.reset(axis)
    bench.pass_s(2.0)
    assert bench.state == "fault"
    assert bench.enabled() == []


def test_a_drive_that_never_says_it_is_off_does_not_keep_the_rig_stopping(
    bench: RigBench, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench.armed()
    monkeypatch.setattr(bench.rig, "axis", lambda axis: AxisStatus(axis, "enabled", "operation enabled"))
    bench.stop()
    assert bench.until("stopped", most_s=3.0) <= 2.6
    assert bench.rig.asked[-1][0] == 0.0
