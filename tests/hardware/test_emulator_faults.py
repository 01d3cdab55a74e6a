"""Each fault on command does what it says, and `clear` takes it back."""

import inspect
import math
import struct

import pytest

from backend.emulator import answers
from backend.emulator.faults import FAULTS, Faults, RefusedRequest
from tests.hardware.emulator_bench import ENABLE, LINK, MOTOR, RESET, SHUTDOWN, STIFFNESS, SWITCH_ON, Bench

ANSWERS = (0x181, 0x182, 0x183)


def answered(bench: Bench, cycles: int = 100) -> int:
    """How many answers come in some cycles."""
    for number in ANSWERS:
        bench.taken(number)
    for _ in range(cycles):
        bench.cycle()
    return sum(len(bench.taken(number)) for number in ANSWERS)


def link(bench: Bench) -> float:
    bench.cycle()
    return float(struct.unpack("<i", bench.taken(0x183)[-1])[0]) * 2.0 * math.pi / 131072


def test_dropped_frames_are_the_share_that_was_asked_for() -> None:
    bench = Bench().enabled()
    assert answered(bench) == 300
    bench.faults.set("frames_dropped", 0.1)
    through = answered(bench, 1000)
    assert through == pytest.approx(3000 * 0.9 * 0.9, rel=0.03)  # the SYNC and the answer
    bench.faults.clear()
    assert answered(bench) == 300


def test_delayed_frames_come_late_in_order_and_all_of_them() -> None:
    bench = Bench().enabled()
    bench.run(0.01)
    bench.faults.set("frames_delayed", 3.0)
    for number in ANSWERS:
        bench.taken(number)
    bench.send(0x80)
    sent = bench.now
    assert [bench.taken(number) for number in ANSWERS] == [[], [], []]
    assert bench.emulator.next_turn() <= sent + 0.003
    bench.now = sent + 0.0029
    bench.emulator.turn(bench.now)
    assert [bench.taken(number) for number in ANSWERS] == [[], [], []]
    bench.now = sent + 0.0031
    bench.emulator.turn(bench.now)
    assert [number for number, _ in bench.frames if number in ANSWERS] == list(ANSWERS)


def test_corrupted_frames_have_a_wrong_length_or_other_bits() -> None:
    bench = Bench()
    bench.nmt(1)
    bench.faults.set("frames_corrupted", 0.3)
    bench.run(1.0)
    frames = bench.taken(0x183)
    short = sum(len(frame) < 4 for frame in frames)
    other = sum(len(frame) == 4 and frame != bytes(4) for frame in frames)
    assert short == pytest.approx(75, abs=25)
    assert other == pytest.approx(75, abs=25)


def test_a_frozen_encoder_shows_the_same_while_the_motor_moves() -> None:
    bench = Bench().enabled(800)
    bench.run(0.1)
    bench.faults.set("encoder_frozen", node=MOTOR)
    frozen = bench.read(MOTOR, 0x6064, signed=True)
    bench.run(0.2)
    assert bench.read(MOTOR, 0x6064, signed=True) == frozen
    assert link(bench) > 0.05
    bench.faults.clear()
    assert bench.read(MOTOR, 0x6064, signed=True) > frozen


@pytest.mark.parametrize("size", [0.5, -0.5])
def test_an_encoder_jumps_by_what_was_asked_for(size: float) -> None:
    bench = Bench().enabled()
    before = link(bench)
    bench.faults.set("encoder_jump", size)
    assert link(bench) - before == pytest.approx(size, abs=1e-4)


@pytest.mark.parametrize(
    ("name", "value", "code", "bit"), [("drive_fault", 0x3210, 0x3210, 4), ("over_temperature", None, 0x4310, 8)]
)
def test_a_drive_s_fault_is_told_brakes_and_cannot_be_reset_while_it_stands(
    name: str, value: float | None, code: int, bit: int
) -> None:
    bench = Bench().enabled(1000)
    bench.run(0.2)
    bench.faults.set(name, value, MOTOR)
    assert bench.emergencies() == [code]
    assert bench.state() == "fault reaction active"
    assert bench.read(MOTOR, 0x603F) == code
    assert bench.read(MOTOR, 0x1001) & bit
    assert bench.read(MOTOR, 0x1003, 1) == code
    bench.run(1.0)
    assert bench.state() == "fault"
    assert abs(bench.emulator.plant.given(0)) < 1e-3
    assert bench.state(STIFFNESS) == "operation enabled"
    for word in (0, RESET, 0):
        bench.command(word, MOTOR)
        assert bench.state() == "fault"
    bench.nmt(129, MOTOR)
    bench.nmt(1, MOTOR)
    assert bench.state() == "fault"  # its cause stands after a restart too
    bench.faults.clear()
    bench.command(0, MOTOR)
    bench.command(RESET, MOTOR)
    assert bench.state() == "switch on disabled"


@pytest.mark.parametrize(("name", "errors"), [("bus_off", [0x40]), ("link_lost", [])])
def test_a_lost_link_is_silent_both_ways_and_only_bus_off_tells_it(name: str, errors: list[int]) -> None:
    bench = Bench().enabled()
    bench.faults.set(name)
    assert answered(bench) == 0
    assert bench.errors == errors
    bench.torques[MOTOR] = 1000
    bench.run(0.1)
    assert bench.emulator.plant.given(0) == 0.0
    bench.faults.clear()
    assert answered(bench) == 300


def test_a_lost_link_stops_drives_that_watch_their_host() -> None:
    bench = Bench()
    for node in (MOTOR, STIFFNESS):
        assert bench.write(node, 0x1016, 1, 127 << 16 | 100, 4) == 0
        assert bench.write(node, 0x6007, 0, 3, 2) == 0
    bench.heartbeats = True
    bench.enabled(1000).run(0.3)
    bench.emulator.watch()
    bench.faults.set("link_lost")
    bench.run(1.0)
    peaks = bench.emulator.peaks()
    assert peaks["states"] == {"motor": "switch on disabled", "stiffness": "switch on disabled"}
    assert 0.1 < peaks["safe_after_s"] < 0.5


def test_a_node_that_restarts_is_silent_boots_and_waits() -> None:
    bench = Bench().enabled(800)
    bench.run(0.1)
    bench.taken(0x701)
    bench.faults.set("node_reboot", node=MOTOR)
    bench.wait(0.002)
    assert abs(bench.emulator.plant.given(0)) < 0.01
    assert answered(bench) == 200
    assert bench.taken(0x701) == []
    bench.wait(0.31)
    assert bench.taken(0x701) == [b"\x00"]
    assert answered(bench) == 200  # pre-operational
    bench.nmt(1, MOTOR)
    for word in (SHUTDOWN, SWITCH_ON, ENABLE):
        bench.command(word)
    bench.run(0.05)
    assert bench.emulator.plant.given(0) == 0.0  # it has no mode any more


def test_a_stiffness_drive_that_restarts_counts_from_another_place() -> None:
    bench = Bench().enabled()
    bench.torques[STIFFNESS] = 100
    bench.run(0.3)
    bench.torques[STIFFNESS] = 0
    assert bench.read(STIFFNESS, 0x6064, signed=True) > 16384
    place = bench.emulator.plant.position(1)
    bench.faults.set("node_reboot", node=STIFFNESS)
    bench.wait(0.31)
    shown = bench.read(STIFFNESS, 0x6064, signed=True) / 16384 * 2.0 * math.pi
    assert shown == pytest.approx(bench.emulator.plant.position(1) - place, abs=1e-3)


def test_a_saturated_drive_gives_less_than_it_is_told_and_shows_it() -> None:
    bench = Bench().enabled(1000)
    bench.faults.set("torque_saturated", 0.1, MOTOR)
    bench.run(0.1)
    assert bench.emulator.plant.given(0) == pytest.approx(7.4, rel=0.01)
    assert bench.read(MOTOR, 0x6077, signed=True) == pytest.approx(296, abs=2)
    assert bench.read(MOTOR, 0x6074, signed=True) == 1000
    assert bench.read(MOTOR, 0x6041) & 0x0800
    bench.faults.clear()
    bench.run(0.1)
    assert bench.emulator.plant.given(0) > 20.0


def test_a_wrong_inertia_makes_the_same_torque_accelerate_less() -> None:
    speeds = []
    for factor in (1.0, 3.0):
        bench = Bench().enabled()
        bench.faults.set("wrong_inertia", factor, MOTOR)
        bench.torques[MOTOR] = 800
        bench.run(0.1)
        speeds.append(bench.emulator.plant.velocity(0))
    assert speeds[0] / speeds[1] == pytest.approx(3.0, rel=0.1)


def test_a_heavier_link_swings_more_slowly_on_its_spring() -> None:
    crossings = []
    for factor in (1.0, 4.0):
        bench = Bench()
        bench.faults.set("wrong_inertia", factor)
        bench.emulator.plant.load(2.0)
        bench.wait(0.005)
        bench.emulator.plant.load(0.0)
        positions = []
        for _ in range(400):
            bench.wait(0.001)
            positions.append(bench.emulator.plant.position(2))
        signs = [index for index in range(1, 400) if positions[index - 1] * positions[index] < 0.0]
        crossings.append(signs[1] - signs[0])
    assert crossings[1] / crossings[0] == pytest.approx(2.0, rel=0.1)


def test_a_load_stays_through_clear_and_deflects_the_spring_against_a_held_motor() -> None:
    bench = Bench()
    assert answers.answer(bench.emulator, bench.faults, {"do": "load", "value": 4.0}) == {"ok": True}
    for axis in (0, 1):
        bench.emulator.plant.brake(axis, 1.0)
    answers.answer(bench.emulator, bench.faults, {"do": "clear"})
    bench.wait(12.0)
    deflection = bench.emulator.plant.position(0) - bench.emulator.plant.position(2)
    spring = 6.2e7 / bench.emulator.plant.position(1) ** 3 * math.sin(0.5 * deflection)
    assert spring == pytest.approx(4.0, rel=1e-2)


@pytest.mark.parametrize(("push", "stop"), [(1.0, 40.0), (-1.0, 2000.0)])
def test_the_stiffness_motor_is_pushed_into_its_stop(push: float, stop: float) -> None:
    bench = Bench().enabled()
    bench.faults.set("end_stop", push)
    bench.run(0.5)
    assert bench.emulator.plant.position(1) == pytest.approx((6.2e7 / stop) ** (1 / 3))


def test_peaks_are_those_since_watch_and_say_when_the_motor_was_without_torque() -> None:
    bench = Bench().enabled(1000)
    bench.run(0.3)
    bench.emulator.watch()
    bench.torques[MOTOR] = 0
    bench.run(0.05)
    assert bench.emulator.peaks()["safe_after_s"] is None  # not yet for long enough
    bench.run(0.1)
    peaks = bench.emulator.peaks()
    assert 0.0 < peaks["safe_after_s"] < 0.01
    assert peaks["peak_motor_torque"] < 25.1
    assert peaks["peak_motor_velocity"] > 1.0
    bench.torques[MOTOR] = 1000
    bench.run(0.01)
    assert bench.emulator.peaks()["safe_after_s"] is None
    bench.emulator.watch()
    assert bench.emulator.peaks()["peak_deflection"] == 0.0


def test_a_motor_that_had_no_torque_is_safe_from_the_watch_on() -> None:
    bench = Bench()
    bench.wait(1.0)
    bench.emulator.watch()
    assert bench.emulator.peaks()["safe_after_s"] is None
    bench.wait(0.11)
    assert bench.emulator.peaks()["safe_after_s"] == 0.0


def test_a_drive_that_comes_back_into_operation_is_told() -> None:
    bench = Bench().enabled()
    assert not bench.emulator.peaks()["re_enabled"]  # it had not left it
    bench.emulator.watch()
    bench.command(0)
    assert not bench.emulator.peaks()["re_enabled"]
    for word in (SHUTDOWN, SWITCH_ON, ENABLE):
        bench.command(word)
    assert bench.emulator.peaks()["re_enabled"]


def test_every_fault_in_the_list_can_be_set_and_cleared_and_is_the_only_way() -> None:
    methods = {name[1:] for name, _ in inspect.getmembers(Faults, inspect.isfunction) if name[1:] in FAULTS}
    assert methods == set(FAULTS)
    for name in FAULTS:
        bench = Bench().enabled()
        assert answers.answer(bench.emulator, bench.faults, {"do": "fault", "name": name}) == {
            "ok": True, "faults": [name],
        }  # fmt: skip
        bench.run(0.5)
        assert answers.answer(bench.emulator, bench.faults, {"do": "clear"}) == {"ok": True, "faults": []}


@pytest.mark.parametrize(
    ("name", "value", "node", "said"),
    [
        ("fire", None, None, "there is no fault 'fire'"),
        ("frames_dropped", 1.5, None, "expected 0 to 1"),
        ("frames_dropped", math.nan, None, "expected 0 to 1"),
        ("drive_fault", None, 3, "expected 1 (motor) or 2 (stiffness)"),
        ("encoder_jump", 0.1, 9, "expected 1 (motor), 2 (stiffness) or 3 (link)"),
        ("wrong_inertia", 2.0, 2, "expected 1 (motor) or 3 (link)"),
    ],
)
def test_what_cannot_be_is_refused_in_a_sentence_and_changes_nothing(
    name: str, value: float | None, node: int | None, said: str
) -> None:
    bench = Bench().enabled()
    with pytest.raises(RefusedRequest) as refusal:
        bench.faults.set(name, value, node)
    assert said in str(refusal.value)
    assert answered(bench) == 300
    assert bench.faults.standing == []


@pytest.mark.parametrize(
    "request_",
    [{}, {"do": "dance"}, {"do": "fault", "name": "drive_fault", "value": []}, {"do": "fault", "name": "drive_fault", "node": "x"},
     {"do": "fault", "name": "encoder_jump", "axis": "moon"}, {"do": "fault", "name": "encoder_jump", "where": "link"},
     {"do": "fault", "name": "encoder_jump", "rad": 0.1}, {"do": "fault", "name": "encoder_frozen", "which": "link"},
     {"do": "load", "value": 1e4}],
)  # fmt: skip
def test_a_request_that_cannot_be_understood_is_answered_by_an_error(request_: dict[str, object]) -> None:
    bench = Bench()
    assert set(answers.answer(bench.emulator, bench.faults, request_)) == {"error"}


def test_a_value_may_be_hexadecimal_and_an_axis_stand_for_its_node() -> None:
    bench = Bench().enabled()
    reply = answers.answer(
        bench.emulator, bench.faults, {"do": "fault", "name": "drive_fault", "value": "0x5113", "node": 2}
    )
    assert reply["ok"]
    assert bench.emergencies(STIFFNESS) == [0x5113]
    assert answers.answer(
        bench.emulator, bench.faults, {"do": "fault", "name": "encoder_jump", "value": 0.1, "axis": "link"}
    )["ok"]
    assert link(bench) == pytest.approx(0.1, abs=1e-3)
    assert bench.emulator.nodes[LINK - 1].number == LINK
