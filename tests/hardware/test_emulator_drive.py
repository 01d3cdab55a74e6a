"""What an emulated drive promises its host, in time that is told: torque at SYNC, ramps, and safety without a host."""

import math
import struct

import pytest

from tests.hardware.emulator_bench import (
    DISABLE_VOLTAGE,
    ENABLE,
    HALT,
    HOST,
    LINK,
    MOTOR,
    QUICK_STOP,
    RESET,
    SHUTDOWN,
    STIFFNESS,
    SWITCH_ON,
    Bench,
)

MOVING = 1200  # per thousand of rated: 30 N m at the gear side


def moving(**objects: int) -> Bench:
    """A bench whose motor turns fast; objects by their index in hexadecimal, as x605A=6."""
    bench = Bench()
    for name, value in objects.items():
        assert bench.write(MOTOR, int(name[1:], 16), 0, value, 2) == 0
    bench.enabled(MOVING).run(0.3)
    assert bench.emulator.plant.velocity(0) > 1.0
    return bench


def guarded(bench: Bench, timeout_ms: int = 100) -> Bench:
    """The drives listen for the host's heartbeat."""
    for node in (MOTOR, STIFFNESS):
        assert bench.write(node, 0x1016, 1, HOST << 16 | timeout_ms, 4) == 0
    bench.heartbeats = True
    bench.run(0.05)
    return bench


def torque(bench: Bench) -> float:
    return bench.emulator.plant.given(0)


def test_who_they_are() -> None:
    bench = Bench()
    for node, device in ((MOTOR, 0x00020192), (STIFFNESS, 0x00020192), (LINK, 0x00010196)):
        assert bench.read(node, 0x1000) == device
        assert bench.read(node, 0x1018, 4) == 1000 + node
    assert {data for number in (0x701, 0x702, 0x703) for data in bench.taken(number)} == {b"\x00"}  # boot-up, once each


def test_a_torque_takes_effect_at_sync_and_positions_are_those_of_sync() -> None:
    bench = Bench().enabled()
    bench.run(0.01)
    bench.now += 0.002
    bench.send(0x201, struct.pack("<Hh", ENABLE, 400))
    bench.wait(0.004)
    assert torque(bench) == 0.0
    bench.taken(0x181)
    bench.send(0x80)
    position = round(bench.emulator.plant.position(0) / (2.0 * math.pi) * 1638400)
    bench.wait(0.004)
    assert torque(bench) == pytest.approx(10.0, rel=1e-3)
    (answer,) = bench.taken(0x181)
    assert struct.unpack("<Hih", answer)[1:] == (position, 0)
    assert bench.emulator.plant.position(0) > 0.0


def test_every_sync_brings_one_answer_of_each_mapped_pdo_and_none_when_not_operational() -> None:
    bench = Bench().enabled()
    for number in (0x181, 0x182, 0x183):
        bench.taken(number)
    bench.run(0.02)
    assert [len(bench.taken(number)) for number in (0x181, 0x182, 0x183)] == [10, 10, 10]
    bench.nmt(128, MOTOR)
    bench.run(0.02)
    assert [len(bench.taken(number)) for number in (0x181, 0x182, 0x183)] == [0, 10, 10]


def test_a_pdo_carries_what_is_written_to_its_mapping_every_nth_sync() -> None:
    bench = Bench()
    for index, sub, value, size in (
        (0x1801, 1, 0x80000281, 4), (0x1801, 2, 5, 1), (0x1A01, 0, 0, 1), (0x1A01, 1, 0x606C0020, 4),
        (0x1A01, 2, 0x60610008, 4), (0x1A01, 3, 0x10010008, 4), (0x1A01, 0, 3, 1), (0x1801, 1, 0x281, 4),
    ):  # fmt: skip
        assert bench.write(MOTOR, index, sub, value, size) == 0
    bench.enabled(400).run(0.1)
    frames = bench.taken(0x281)
    assert len(frames) == 53 // 5
    speed, mode, errors = struct.unpack("<iBB", frames[-1])
    assert (mode, errors) == (10, 0)
    assert speed / 1638400 * 2.0 * math.pi == pytest.approx(bench.emulator.plant.velocity(0), rel=0.1)


@pytest.mark.parametrize(
    ("index", "sub", "value", "size", "code"),
    [
        (0x1A00, 0, 0, 1, 0x08000022),  # the PDO exists
        (0x1801, 2, 252, 1, 0x06090030),  # on request: not supported
        (0x1A01, 1, 0x60410020, 4, 0x06040041),  # wrong length
        (0x1A01, 1, 0x60760020, 4, 0x06040041),  # not mappable
        (0x1A01, 1, 0x12340020, 4, 0x06020000),  # not there
        (0x1601, 1, 0x60410010, 4, 0x06040041),  # cannot be written
        (0x1A01, 0, 9, 1, 0x06040042),  # more than a PDO holds
        (0x6060, 0, 8, 1, 0x06090030),  # position mode
        (0x605A, 0, 3, 2, 0x06090030),
        (0x6064, 0, 0, 4, 0x06010002),  # read only
        (0x6071, 0, 0, 4, 0x06070010),  # wrong type
    ],
)
def test_what_cannot_be_is_refused_with_the_standard_s_code(
    index: int, sub: int, value: int, size: int, code: int
) -> None:
    assert Bench().write(MOTOR, index, sub, value, size) == code


def test_without_a_mode_a_drive_in_operation_gives_no_torque() -> None:
    bench = Bench()
    bench.nmt(1)
    for word in (SHUTDOWN, SWITCH_ON, ENABLE):
        bench.command(word)
    bench.torques[MOTOR] = MOVING
    bench.run(0.05)
    assert bench.state() == "operation enabled"
    assert torque(bench) == 0.0
    assert not bench.read(MOTOR, 0x6041) & 0x1000


def test_torque_is_limited_by_0x6072_and_the_statusword_says_so() -> None:
    bench = Bench().enabled()
    assert bench.write(MOTOR, 0x6072, 0, 500, 2) == 0
    bench.torques[MOTOR] = -1000
    bench.run(0.02)
    assert torque(bench) == pytest.approx(-12.5, rel=1e-3)
    assert bench.read(MOTOR, 0x6074, signed=True) == -500


def test_disable_voltage_takes_the_torque_off_at_once() -> None:
    bench = moving()
    bench.command(DISABLE_VOLTAGE, MOTOR)
    bench.wait(0.002)
    assert bench.state() == "switch on disabled"
    assert abs(torque(bench)) < 1e-3
    assert bench.emulator.plant.velocity(0) > 1.0  # it coasts


@pytest.mark.parametrize(
    ("option", "ends_as"),
    [
        (0, "switch on disabled"),
        (1, "switch on disabled"),
        (2, "switch on disabled"),
        (5, "quick stop active"),
        (6, "quick stop active"),
    ],
)
def test_a_quick_stop_goes_by_its_option_code(option: int, ends_as: str) -> None:
    bench = moving(x605A=option)
    speed = bench.emulator.plant.velocity(0)
    bench.command(QUICK_STOP, MOTOR)
    assert bench.state() == ("switch on disabled" if option == 0 else "quick stop active")
    slope = {0: 0.0, 1: 7.5, 5: 7.5, 2: 15.0, 6: 15.0}[option]
    bench.run(0.5 * speed / 15.0)
    if slope:
        assert bench.emulator.plant.velocity(0) == pytest.approx(speed * (1.0 - 7.5 / 15.0 * slope / 15.0), rel=0.1)
    bench.run(1.0)
    assert bench.state() == ends_as
    assert abs(bench.emulator.plant.velocity(0)) < 0.05
    bench.command(ENABLE, MOTOR)
    assert bench.state() == ("operation enabled" if option in (5, 6) else "switch on disabled")


def test_a_quick_stop_that_stays_holds_its_place_against_a_load() -> None:
    bench = moving(x605A=6)
    bench.command(QUICK_STOP, STIFFNESS)
    bench.run(0.2)
    held = bench.emulator.plant.position(1)
    bench.emulator.plant.push(0.3)
    bench.run(0.5)
    assert bench.state(STIFFNESS) == "switch on disabled"  # its own option code is 2
    bench.command(QUICK_STOP, MOTOR)
    bench.run(1.0)
    held = bench.emulator.plant.position(0)
    bench.run(1.0)
    assert bench.emulator.plant.position(0) == pytest.approx(held, abs=1e-3)


def test_halt_slows_down_in_operation_and_its_end_gives_the_torque_back() -> None:
    bench = moving()
    bench.command(HALT, MOTOR)
    bench.run(1.0)
    assert bench.state() == "operation enabled"
    assert abs(bench.emulator.plant.velocity(0)) < 0.05
    assert bench.read(MOTOR, 0x6041) & 0x0400
    bench.command(ENABLE, MOTOR)
    bench.wait(0.002)
    assert torque(bench) == pytest.approx(30.0, rel=1e-3)


def test_disabling_operation_slows_down_first_where_its_option_code_says_so() -> None:
    bench = moving(x605C=1)
    bench.command(SWITCH_ON, MOTOR)
    assert bench.state() == "operation enabled"
    bench.run(1.0)
    assert bench.state() == "switched on"
    at_once = moving(x605C=0)
    at_once.command(SWITCH_ON, MOTOR)
    assert at_once.state() == "switched on"


@pytest.mark.parametrize(
    ("option", "passes", "ends_as"),
    [
        (1, "fault reaction active", "fault"),
        (2, "switch on disabled", "switch on disabled"),
        (3, "quick stop active", "switch on disabled"),
    ],
)
def test_a_killed_host_leaves_no_torque_within_the_heartbeat_time_and_the_ramp(
    option: int, passes: str, ends_as: str
) -> None:
    bench = guarded(moving(x6007=option))
    assert bench.write(MOTOR, 0x1029, 1, 1, 1) == 0
    began = bench.now
    bench.wait(0.0999)
    assert bench.state() == "operation enabled"
    bench.wait(0.0002)
    assert bench.emergencies() == [0x8130]
    assert bench.state() == passes
    bench.wait(2.0)
    assert bench.state() == ends_as
    assert abs(torque(bench)) < 1e-3
    assert abs(bench.emulator.plant.velocity(0)) < 0.05
    assert bench.now - began < 2.2
    bench.run(0.2)  # the host is back and commands operation as if nothing had been
    assert bench.state() == ends_as
    assert not bench.emulator.peaks()["re_enabled"]


def test_a_lost_host_ends_the_exchange_unless_0x1029_keeps_it() -> None:
    bench = guarded(moving())
    bench.heartbeats = False
    bench.run(0.2)
    bench.taken(0x181)
    bench.run(0.02)
    assert bench.taken(0x181) == []  # pre-operational


def test_without_a_heartbeat_ever_heard_nothing_is_watched() -> None:
    bench = moving()
    assert bench.write(MOTOR, 0x1016, 1, HOST << 16 | 100, 4) == 0
    bench.run(0.5)
    assert bench.state() == "operation enabled"


def test_a_host_that_hangs_but_still_beats_is_stopped_by_the_deadline_of_its_pdos() -> None:
    bench = Bench()
    assert bench.write(MOTOR, 0x6007, 0, 3, 2) == 0
    assert bench.write(MOTOR, 0x1400, 5, 20, 2) == 0
    bench.enabled(MOVING).run(0.2)
    bench.wait(0.0199)
    assert bench.state() == "operation enabled"
    bench.wait(0.0002)
    assert bench.emergencies() == [0x8250]
    assert bench.state() == "quick stop active"
    bench.run(1.0)
    assert bench.state() == "switch on disabled"
    assert bench.read(MOTOR, 0x1001) == 0  # heard again
    assert bench.emergencies() == [0]


def test_a_host_that_goes_on_as_if_nothing_had_been_does_not_bring_a_holding_drive_back() -> None:
    bench = Bench()
    for index, value in ((0x6007, 3), (0x605A, 6)):
        assert bench.write(MOTOR, index, 0, value, 2) == 0
    assert bench.write(MOTOR, 0x1400, 5, 20, 2) == 0
    bench.enabled(MOVING).run(0.2)
    bench.wait(0.05)
    bench.run(1.0)  # its controlword still says: enable operation
    assert bench.state() == "quick stop active"
    assert not bench.emulator.peaks()["re_enabled"]


@pytest.mark.parametrize("command", [2, 128, 129, 130])
def test_ending_the_exchange_takes_a_moving_drive_out_of_operation(command: int) -> None:
    bench = moving(x6007=3)
    bench.nmt(command)
    bench.wait(1.5)
    bench.nmt(1)
    assert bench.state() == "switch on disabled"
    assert abs(torque(bench)) < 1e-3


def test_a_reset_node_has_lost_its_configuration_and_says_that_it_is_there() -> None:
    bench = moving(x605A=6)
    bench.taken(0x701)
    bench.nmt(129, MOTOR)
    assert bench.taken(0x701) == [b"\x00"]
    assert bench.read(MOTOR, 0x605A) == 2
    assert bench.read(MOTOR, 0x6060) == 0
    assert bench.state(STIFFNESS) == "operation enabled"


def test_heartbeats_come_at_their_time_and_tell_the_state() -> None:
    bench = Bench()
    bench.taken(0x701)
    assert bench.write(MOTOR, 0x1017, 0, 50, 2) == 0
    bench.wait(0.5)
    assert len(bench.taken(0x701)) == pytest.approx(10, abs=1)
    bench.nmt(1)
    bench.taken(0x701)
    bench.wait(0.1)
    assert set(bench.taken(0x701)) == {b"\x05"}
    bench.nmt(2)
    bench.wait(0.06)
    assert bench.taken(0x701)[-1] == b"\x04"


def test_a_pdo_of_wrong_length_is_told_once_and_a_short_one_is_not_taken() -> None:
    bench = Bench().enabled()
    for _ in range(3):
        bench.send(0x201, struct.pack("<Hb", ENABLE, 100))
    bench.send(0x80)
    assert bench.emergencies() == [0x8210]
    bench.wait(0.002)
    assert torque(bench) == 0.0
    bench.send(0x201, struct.pack("<Hhb", ENABLE, 400, 0))
    bench.send(0x80)
    bench.wait(0.002)
    assert bench.emergencies() == [0x8220]
    assert torque(bench) == pytest.approx(10.0, rel=0.01)


def test_a_fault_is_reset_by_a_rising_edge_and_the_drive_stays_off() -> None:
    bench = moving()
    bench.faults.set("drive_fault", 0x2320, MOTOR)
    bench.run(1.0)
    bench.faults.clear()
    assert bench.state() == "fault"
    for word in (ENABLE, SHUTDOWN, SWITCH_ON, ENABLE):
        bench.command(word, MOTOR)
        assert bench.state() == "fault"
    bench.command(RESET, MOTOR)
    assert bench.state() == "switch on disabled"
    assert bench.read(MOTOR, 0x603F) == 0
    assert bench.emergencies() == [0x2320, 0]
    bench.faults.set("drive_fault", 0x2320, MOTOR)
    bench.faults.clear()
    bench.run(0.1)  # bit 7 is still set: no edge
    assert bench.state() == "fault"


def test_an_event_driven_pdo_comes_by_its_timer_with_values_of_then() -> None:
    bench = Bench()
    assert bench.write(MOTOR, 0x1800, 2, 255, 1) == 0
    assert bench.write(MOTOR, 0x1800, 5, 30, 2) == 0
    bench.nmt(1)
    bench.emulator.plant.give(0, 30.0)
    bench.taken(0x181)
    bench.wait(0.3005)
    frames = bench.taken(0x181)
    assert len(frames) == 10
    assert struct.unpack("<Hih", frames[-1])[1] > struct.unpack("<Hih", frames[-2])[1] > 0
    bench.send(0x80)
    assert bench.taken(0x181) == []


def test_an_event_driven_receive_pdo_takes_effect_at_once() -> None:
    bench = Bench()
    assert bench.write(MOTOR, 0x1400, 2, 255, 1) == 0
    bench.enabled()
    bench.send(0x201, struct.pack("<Hh", ENABLE, 400))
    bench.wait(0.002)
    assert torque(bench) == pytest.approx(10.0, rel=1e-3)
