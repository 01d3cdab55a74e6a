"""STOP, watchdogs and missing measurements: what stops a rig, how soon, and how it comes to rest. In injected time."""

from collections.abc import Iterator

import numpy as np
import pytest

from backend.loop import messages
from backend.loop.messages import State
from backend.rigs.faults import (
    BUS_SILENT,
    LEASE_EXPIRED,
    LINK_SILENT,
    LOOP_LATE,
    MOTOR_SILENT,
    STIFFNESS_SILENT,
    STOP_REQUESTED,
    WEB_SILENT,
    Fault,
)
from backend.telemetry.beats import LEASE, WEB
from tests.hardware.rig_loop_bench import SCENARIO, RigBench, T
from vssea_core.signals.documents import ConstantDisturbance, Disturbances


@pytest.fixture
def bench() -> Iterator[RigBench]:
    opened = RigBench()
    yield opened
    opened.close()


def come_to(bench: RigBench, state: State) -> None:
    bench.connect()
    if state == "connected":
        return
    if state == "homing":
        bench.do(messages.Home())
        bench.pass_s(0.3)
        return
    bench.home()
    if state == "ready":
        return
    if state == "stopped":
        bench.stop()
        return
    if state == "fault":
        bench.rig.jump_encoder("link", 0.5)
        bench.turn()
        return
    bench.arm()
    if state in ("running", "stopping"):
        bench.follow()
    bench.pass_s(0.7)
    if state == "stopping":
        bench.do(messages.Disarm())
    assert bench.state == state


@pytest.mark.parametrize(
    ("state", "then"),
    [
        ("connected", "stopped"),
        ("homing", "stopping"),
        ("ready", "stopped"),
        ("armed", "stopping"),
        ("running", "stopping"),
        ("stopping", "stopping"),
        ("stopped", "stopped"),
        ("fault", "fault"),
    ],
)
def test_stop_is_obeyed_in_the_same_turn_from_every_state(bench: RigBench, state: State, then: State) -> None:
    come_to(bench, state)
    bench.stop()
    assert bench.state == then
    bench.until("stopped", "fault", most_s=2.0)
    if state != "fault":
        assert bench.state == "stopped"
        assert bench.reason() == STOP_REQUESTED.sentence()
    assert bench.enabled() == []
    assert bench.rig.given == (0.0, 0.0)


def test_stop_is_read_before_commands(bench: RigBench) -> None:
    come_to(bench, "ready")
    number = bench.send(messages.Arm())
    bench.stop()
    assert bench.state == "stopped"
    assert isinstance(bench.answer(number), messages.Refused)
    assert bench.enabled() == []


def test_stop_while_the_drives_come_into_operation_takes_them_off(bench: RigBench) -> None:
    come_to(bench, "ready")
    number = bench.send(messages.Arm())
    bench.turns(3)
    assert bench.answer(number) is None
    bench.stop()
    assert "stopped" in bench.answer(number).sentence  # type: ignore[union-attr]
    bench.until("stopped", most_s=0.1)
    bench.pass_s(0.1)
    assert bench.enabled() == []


@pytest.mark.parametrize("state", ["homing", "armed", "running"])
@pytest.mark.parametrize(("which", "limit_s", "fault"), [(LEASE, 0.4, LEASE_EXPIRED), (WEB, 0.25, WEB_SILENT)])
def test_silence_of_operator_or_server_stops_the_rig_at_its_limit(
    bench: RigBench, state: State, which: int, limit_s: float, fault: Fault
) -> None:
    come_to(bench, state)
    bench.alive[which] = False
    silent = bench.until("stopping", most_s=1.0)
    assert limit_s - T <= silent <= limit_s + 2 * T
    bench.until("stopped", most_s=2.0)
    assert bench.reason() == fault.sentence()
    assert bench.report().faults == ()
    bench.alive[which] = True
    bench.pass_s(1.0)
    assert bench.state == "stopped"  # what comes back does not go on by itself
    assert bench.enabled() == []


@pytest.mark.parametrize("state", ["connected", "ready", "stopped"])
def test_a_rig_that_is_off_needs_neither_operator_nor_server(bench: RigBench, state: State) -> None:
    come_to(bench, state)
    bench.alive = {WEB: False, LEASE: False}
    bench.pass_s(2.0)
    assert bench.state == state


@pytest.mark.parametrize("part", ["link", "motor", "stiffness"])
@pytest.mark.parametrize("cycles", [1, 2])
def test_one_or_two_missed_cycles_are_bridged(bench: RigBench, part: str, cycles: int) -> None:
    come_to(bench, "running")
    bench.pass_s(1.5)
    usual = np.abs(bench.channel("error")[-300:]).max()
    bench.rig.missed = {part: cycles}
    bench.pass_s(0.5)
    assert bench.state == "running"
    assert np.abs(bench.channel("error")[-250:]).max() < 2.0 * usual


def test_torques_are_held_over_a_missed_cycle(bench: RigBench) -> None:
    come_to(bench, "running")
    bench.rig.missed = {"link": 1, "motor": 1, "stiffness": 1}
    bench.turns(2)
    assert bench.rig.asked[-1] == bench.rig.asked[-2]
    bench.turn()
    assert bench.rig.asked[-1] != bench.rig.asked[-2]


@pytest.mark.parametrize("part", ["link", "motor", "stiffness"])
def test_the_third_missed_cycle_stops_both_axes(bench: RigBench, part: str) -> None:
    come_to(bench, "running")
    bench.rig.missed = {part: 5}
    bench.turns(2)
    assert bench.state == "running"
    bench.turn()
    assert bench.state == "stopping"
    bench.until("stopped", most_s=2.0)
    assert "3 cycles" in str(bench.reason())
    assert bench.enabled() == []
    left = {axis for order, axis in bench.rig.orders if order == "stop"}
    assert left == ({part} if part != "link" else set())  # only what cannot be braked is left to its drive
    assert bench.report().faults == ()


@pytest.mark.parametrize(
    ("part", "fault"), [("link", LINK_SILENT), ("motor", MOTOR_SILENT), ("stiffness", STIFFNESS_SILENT)]
)
def test_ten_missed_cycles_of_one_node_are_a_fault_that_takes_both_axes_off(
    bench: RigBench, part: str, fault: Fault
) -> None:
    come_to(bench, "running")
    before = len(bench.rig.orders)
    bench.rig.silence(part)  # type: ignore[arg-type]
    bench.turns(9)
    assert bench.state == "stopping"
    assert bench.report().faults == ()
    bench.turn()
    assert bench.faults() == [fault.number]
    bench.until("fault", most_s=2.0)
    bench.pass_s(0.1)
    assert bench.rig.given[0] == 0.0
    assert abs(bench.rig.plant.omega_e) < 0.05
    bench.pass_s(4.0)
    assert bench.rig.given[0] == 0.0
    # Nobody knows whether the spring is loaded, so the stiffness axis is not let go: the loop holds it, or its drive does.
    assert set(bench.enabled()) <= {"stiffness"}
    assert ("disarm", "stiffness") not in bench.rig.orders[before:]
    assert ("disarm", "motor") in bench.rig.orders[before:]


def test_a_cut_bus_is_the_fault_of_the_bus_and_the_drives_stop_by_themselves(bench: RigBench) -> None:
    come_to(bench, "running")
    bench.rig.cut_bus()
    bench.turns(10)
    assert bench.faults() == [BUS_SILENT.number]
    bench.until("fault", most_s=2.0)
    assert {axis for order, axis in bench.rig.orders if order == "stop"} == {"motor", "stiffness"}


def test_a_silent_node_is_a_fault_of_a_rig_that_is_off_too(bench: RigBench) -> None:
    come_to(bench, "ready")
    bench.rig.silence("link")
    bench.turns(9)
    assert bench.state == "ready"
    bench.turn()
    assert bench.state == "fault"


def test_ten_late_cycles_in_a_row_are_a_fault_of_an_armed_rig(bench: RigBench) -> None:
    come_to(bench, "armed")
    for _ in range(9):
        bench.turn(missed=1)
    bench.turn()
    for _ in range(9):
        bench.turn(missed=1)
    assert bench.state == "armed"
    bench.turn(missed=1)
    assert bench.has(LOOP_LATE)
    bench.until("fault", most_s=2.0)


def test_ten_late_cycles_at_once_are_the_same(bench: RigBench) -> None:
    come_to(bench, "armed")
    bench.turn(missed=10)
    assert bench.has(LOOP_LATE)


def test_the_motor_is_braked_while_the_stiffness_axis_holds_then_both_are_off(bench: RigBench) -> None:
    come_to(bench, "running")
    bench.pass_s(0.2)
    speed, theta_ms = bench.rig.plant.omega_e, bench.rig.plant.theta_ms
    assert abs(speed) > 0.3
    bench.stop()
    begun = len(bench.rig.asked)
    taken = bench.until("stopped", most_s=2.0)
    motor = np.array(bench.rig.asked[begun + 1 :])[:, 0]
    assert (motor * np.sign(speed)).max() < 0.5  # it never drives on
    assert np.abs(motor).max() > 5.0  # it brakes
    assert taken < 1.0
    assert abs(bench.rig.plant.theta_ms - theta_ms) < 1.0
    orders = [axis for order, axis in bench.rig.orders if order == "disarm"]
    assert orders[-2:] == ["motor", "stiffness"]


def test_the_motor_is_off_650_ms_after_a_stop_even_if_it_cannot_be_braked(bench: RigBench) -> None:
    come_to(bench, "armed")
    bench.rig.set_disturbances(Disturbances(motor=(ConstantDisturbance(torque=-40.0),)))
    bench.stop()
    begun = bench.now
    while bench.rig.axis("motor").state == "enabled":
        bench.turn()
    assert 0.6 < bench.now - begun <= 0.65 + 4 * T


def test_the_stiffness_axis_goes_on_holding_a_loaded_spring_until_it_is_unloaded() -> None:
    bench = RigBench()
    try:
        come_to(bench, "armed")
        load = Disturbances(link=(ConstantDisturbance(torque=1.6),))
        bench.rig.set_disturbances(load)
        bench.pass_s(0.8)
        assert bench.state == "armed"
        theta_ms = bench.rig.plant.theta_ms
        bench.stop()
        assert bench.until("stopped", most_s=2.5) > 1.0
        assert bench.enabled() == ["stiffness"]
        bench.pass_s(0.5)
        assert bench.enabled() == ["stiffness"]
        assert abs(bench.rig.plant.theta_ms - theta_ms) < 1.0
        assert bench.report().motion == "the stiffness axis holds"
        assert all(motor == 0.0 for motor, _ in bench.rig.asked[-200:])
        bench.rig.set_disturbances(Disturbances())
        bench.pass_s(20.0)
        assert bench.enabled() == []
        assert bench.report().motion == "drives off"
    finally:
        bench.close()


def test_a_loaded_rig_is_reset_and_armed_again_without_letting_go_of_the_stiffness_axis() -> None:
    bench = RigBench()
    try:
        come_to(bench, "armed")
        bench.rig.set_disturbances(Disturbances(link=(ConstantDisturbance(torque=1.6),)))
        bench.pass_s(0.8)
        bench.stop()
        bench.until("stopped", most_s=2.5)
        bench.pass_s(4.0)
        theta_ms = bench.rig.plant.theta_ms
        bench.do(messages.Reset())
        assert (bench.state, bench.enabled()) == ("ready", ["stiffness"])
        assert "holds a loaded spring" in bench.refused(messages.Home())
        bench.arm()
        bench.pass_s(0.5)
        assert bench.state == "armed"
        assert abs(bench.rig.plant.theta_ms - theta_ms) < 0.5
    finally:
        bench.close()


def test_disarm_comes_to_rest_and_ends_ready(bench: RigBench) -> None:
    come_to(bench, "running")
    bench.do(messages.Disarm())
    bench.until("ready", most_s=4.0)
    assert bench.enabled() == []
    assert bench.changes()[-2:] == ["stopping", "ready"]


def test_stop_during_disarm_ends_stopped(bench: RigBench) -> None:
    come_to(bench, "running")
    bench.do(messages.Disarm())
    bench.turns(5)
    bench.stop()
    bench.until("stopped", "ready", most_s=2.0)
    assert bench.state == "stopped"


def test_homing_that_is_stopped_lets_go_within_50_ms_and_is_not_homed(bench: RigBench) -> None:
    come_to(bench, "homing")
    bench.stop()
    torques = []
    while bench.state == "stopping":
        bench.turn()
        torques.append(abs(bench.rig.given[1]))
    assert len(torques) <= 30
    assert torques == sorted(torques, reverse=True)
    assert not bench.report().homed
    bench.do(messages.Reset())
    assert bench.state == "connected"


def test_a_stopped_rig_goes_on_measuring(bench: RigBench) -> None:
    come_to(bench, "stopped")
    before = bench.reader.written
    bench.turns(100)
    assert bench.reader.written - before == 100
    assert SCENARIO.timing.sample_time_s == pytest.approx(np.diff(bench.channel("time")[-50:]).mean())


def test_after_a_stop_the_reference_rests(bench: RigBench) -> None:
    come_to(bench, "running")
    bench.stop()
    bench.until("stopped", most_s=3.0)
    bench.pass_s(1.0)
    assert np.ptp(bench.channel("reference")[-400:]) == 0.0
