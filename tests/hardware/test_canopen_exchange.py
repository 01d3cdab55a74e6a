"""The cyclic exchange: what goes out, what counts as this cycle's answer, and how loss and trouble show."""

import math
import struct

import can
import pytest

from backend.rigs.canopen.answer import NEVER
from backend.rigs.faults import (
    BUS_OFF,
    CORRUPTED,
    HOT,
    LINK_ENCODER,
    MOTOR_DRIVE,
    REBOOTED,
    STIFFNESS_DRIVE,
    Fault,
)
from backend.rigs.rig import AXES, Measured
from tests.hardware.fake_bus import ANSWER_DELAY_S, frame
from tests.hardware.fake_rig import RIG_FILE, FakeRig, changed

MOTOR_UNIT = 0.533 * 100.0 * 0.7 / 1000.0


def ages(measured: Measured) -> tuple[int, int, int]:
    return measured.link_age, measured.motor_age, measured.stiffness_age


def faults(fake: FakeRig) -> list[Fault]:
    return [fault for fault, _ in fake.rig.bus_faults()]


def test_a_cycle_is_both_torques_then_sync_then_every_answer() -> None:
    fake = FakeRig().armed()
    fake.bus.sent.clear()
    measured = fake.turn(10.0, 0.2)
    assert [m.arbitration_id for m in fake.bus.sent if m.arbitration_id < 0x700] == [0x201, 0x202, 0x080]
    assert fake.bus.sent_to(0x080) == [b""]
    assert struct.unpack("<Hh", fake.bus.sent_to(0x201)[0]) == (0x0F, round(10.0 / MOTOR_UNIT))
    assert ages(measured) == (0, 0, 0)
    assert fake.rig.health().round_trip_us == pytest.approx(ANSWER_DELAY_S * 1e6)


def test_the_torque_that_is_told_is_the_rounded_one_that_was_sent() -> None:
    fake = FakeRig().armed()
    measured = fake.turn(10.0, 0.2)
    assert measured.motor_torque == pytest.approx(round(10.0 / MOTOR_UNIT) * MOTOR_UNIT)
    assert measured.motor_torque != 10.0
    assert measured.motor_torque_seen == measured.motor_torque
    assert measured.stiffness_torque == pytest.approx(round(0.2 / 0.00044) * 0.00044)
    assert fake.turn(1000.0).motor_torque <= RIG_FILE.motor.torque_limit


def test_without_operation_no_torque_is_sent() -> None:
    fake = FakeRig().ready()
    assert fake.turn(50.0, 0.5, cycles=3).motor_torque == 0.0
    fake.rig.arm("motor")
    while fake.rig.axis("motor").state != "enabled":
        assert fake.turn(50.0, 0.5).motor_torque == 0.0
    assert fake.turn(50.0, 0.5).motor_torque > 0.0
    fake.rig.stop("motor")
    assert fake.turn(50.0, 0.5).motor_torque == 0.0
    assert set(fake.stiffness.torques) == {0}


def test_positions_are_si_at_the_gear_side_with_the_signs_of_the_file() -> None:
    fake = FakeRig(changed(motor={"sign": -1}, link={"sign": -1, "zero": 1000})).ready()
    fake.motor.position, fake.stiffness.position, fake.link.position = 16384 * 100 // 8, 16384 // 4, 1000 + 131072 // 8
    measured = fake.turn()
    assert measured.motor_position == pytest.approx(-math.pi / 4)
    assert measured.stiffness_position == pytest.approx(math.pi / 2)
    assert measured.link_position == pytest.approx(-math.pi / 4)
    fake.rig.home(0.5)
    assert fake.turn().stiffness_position == pytest.approx(math.pi / 2 - 0.5)


def test_a_negative_sign_turns_the_torque_too() -> None:
    fake = FakeRig(changed(motor={"sign": -1})).armed()
    measured = fake.turn(10.0)
    assert fake.motor.torques[-1] == -round(10.0 / MOTOR_UNIT)
    assert measured.motor_torque == measured.motor_torque_seen == pytest.approx(10.0, abs=MOTOR_UNIT)


def test_before_the_first_answer_nothing_is_fresh() -> None:
    fake = FakeRig().ready()
    fake.motor.silent = True
    measured = fake.turn()
    assert measured.motor_age > NEVER
    assert (measured.link_age, measured.stiffness_age) == (0, 0)
    assert fake.rig.axis("motor").state == "unknown"


def test_silence_counts_up_cycle_by_cycle_and_the_last_values_stand() -> None:
    fake = FakeRig().armed()
    fake.link.position = 5000
    before = fake.turn()
    fake.link.silent = fake.motor.silent = True
    for cycle in range(1, 13):
        began = fake.clock.now
        measured = fake.rig.exchange(0.0, 0.0)
        assert fake.clock.now - began == pytest.approx(RIG_FILE.answer_share * fake.rig.period_s)
        fake.clock.now = began + fake.rig.period_s
        assert ages(measured) == (cycle, cycle, 0)
        assert measured.link_position == before.link_position
    assert fake.rig.axis("motor").state == "unknown"
    assert faults(fake) == [], "loss is an age; what follows from it is the loop's"
    fake.link.silent = fake.motor.silent = False
    assert ages(fake.turn()) == (0, 0, 0)


def test_an_answer_after_the_deadline_is_late_and_not_taken_for_the_next_cycles() -> None:
    fake = FakeRig().ready()
    fake.turn(cycles=60)
    fake.link.delay_s = lambda place: 1.5e-3  # later than 1.2 ms, before the next cycle
    for cycle in range(1, 6):
        fake.link.position += 100
        assert fake.turn().link_age == cycle
    assert fake.rig.health().late_answers == 4
    fake.link.delay_s = lambda place: ANSWER_DELAY_S
    measured = fake.turn()
    assert measured.link_age == 0
    assert measured.link_position == pytest.approx(500 * math.tau / 131072)


def test_of_two_answers_in_one_cycle_the_newer_is_this_cycles() -> None:
    fake = FakeRig().ready()
    fake.turn(cycles=60)
    fake.link.delay_s = lambda place: 2.2e-3  # into the next cycle, ahead of that one's answer
    fake.link.position = 100
    assert fake.turn().link_age == 1
    fake.link.delay_s = lambda place: ANSWER_DELAY_S
    fake.link.position = 200
    measured = fake.turn()
    assert measured.link_age == 0
    assert measured.link_position == pytest.approx(200 * math.tau / 131072)
    assert fake.rig.health().late_answers == 1


def test_answers_that_are_always_more_than_a_cycle_late_are_found_out_and_never_fresh_again() -> None:
    fake = FakeRig().ready()
    fake.turn(cycles=10)
    fake.link.delay_s = lambda place: 2.1e-3  # as quick after the next SYNC as any answer
    ages = [fake.turn().link_age for _ in range(60)]
    assert ages[:4] == [1, 0, 0, 0], "taken for new until the cycle without SYNC"
    assert ages[4:] == list(range(1, 57))
    assert fake.rig.health().late_answers > 10
    fake.link.delay_s = lambda place: ANSWER_DELAY_S
    fake.turn(cycles=6)
    assert fake.turn().link_age == 0


@pytest.mark.parametrize("slow_s", [ANSWER_DELAY_S, 1.1e-3])
def test_a_lost_answer_costs_two_cycles_and_never_two_in_a_row(slow_s: float) -> None:
    fake = FakeRig().ready()
    fake.turn(cycles=10)
    for _ in range(20):
        fake.link.delay_s = lambda place: None
        assert fake.turn().link_age == 1
        fake.link.delay_s = lambda place: slow_s
        assert [fake.turn().link_age for _ in range(20)] == [0, 0, 0, 1, *[0] * 16]
    assert fake.rig.health().late_answers == 0


def test_the_cycle_that_settles_a_doubt_is_without_sync_but_not_without_torques() -> None:
    fake = FakeRig().armed()
    fake.turn(10.0)
    fake.link.delay_s = lambda place: None
    fake.turn(10.0)
    fake.link.delay_s = lambda place: ANSWER_DELAY_S
    fake.turn(10.0, cycles=3)
    fake.bus.sent.clear()
    measured = fake.turn(30.0)
    assert [m.arbitration_id for m in fake.bus.sent if m.arbitration_id < 0x700] == [0x201, 0x202]
    assert measured.motor_torque == pytest.approx(10.0, abs=MOTOR_UNIT), "not taken over without SYNC"
    assert fake.turn(30.0).motor_torque == pytest.approx(30.0, abs=MOTOR_UNIT)


def test_a_doubt_waits_for_a_cycle_in_which_nothing_is_missing() -> None:
    fake = FakeRig().ready()
    fake.turn(cycles=10)
    fake.link.delay_s = lambda place: None
    fake.turn()
    fake.link.delay_s = lambda place: ANSWER_DELAY_S
    fake.turn()
    fake.stiffness.delay_s = lambda place: None
    fake.bus.sent.clear()
    fake.turn(cycles=5)
    assert len(fake.bus.sent_to(0x080)) == 5


def test_a_lost_torque_alone_ages_the_axis_only_when_it_stays_away() -> None:
    fake = FakeRig().ready()
    fake.turn()
    fake.motor.delay_s = lambda place: None if place == 1 else ANSWER_DELAY_S
    assert [fake.turn().motor_age for _ in range(12)] == [0] * 9 + [10, 11, 12]


@pytest.mark.parametrize("spoiled", [b"", b"\1\2\3", bytes(8)])
def test_frames_of_a_wrong_length_are_no_answer_and_some_of_them_a_fault(spoiled: bytes) -> None:
    fake = FakeRig().ready()
    fake.turn()
    fake.link.spoil = lambda content: spoiled
    assert [fake.turn().link_age for _ in range(3)] == [1, 2, 3]
    assert faults(fake) == []
    fake.turn(cycles=2)
    assert faults(fake) == [CORRUPTED]
    assert faults(fake) == []


def test_a_status_word_that_is_none_is_no_answer() -> None:
    fake = FakeRig().armed()
    fake.motor.spoil = lambda content: b"\x01" + content[1:]
    measured = fake.turn(10.0, cycles=6)
    assert measured.motor_age >= 6
    assert CORRUPTED in faults(fake)


def test_a_malformed_frame_now_and_then_is_forgiven() -> None:
    fake = FakeRig().ready()
    for _ in range(10):
        fake.link.spoil = lambda content: b""
        fake.turn()
        fake.link.spoil = bytes
        fake.turn(cycles=120)
    assert faults(fake) == []


def test_an_emergency_is_a_fault_of_its_node_with_words() -> None:
    fake = FakeRig().armed()
    fake.motor.emergency(0x2310)
    fake.stiffness.emergency(0x7305)
    fake.link.emergency(0x5000)
    fake.turn()
    assert fake.rig.bus_faults() == (
        (MOTOR_DRIVE, "motor drive, node 1: 0x2310 over-current"),
        (STIFFNESS_DRIVE, "stiffness drive, node 2: 0x7305 incremental encoder 1 fault"),
        (LINK_ENCODER, "link encoder, node 3: 0x5000 hardware of the device"),
    )
    assert fake.rig.axis("motor").error_words == "0x2310 over-current"
    fake.motor.emergency(0)
    fake.turn()
    assert fake.rig.axis("motor").error_code == 0
    assert faults(fake) == []


def test_over_temperature_is_told_apart_and_a_short_emergency_harms_nothing() -> None:
    fake = FakeRig().armed()
    fake.stiffness.emergency(0x4310)
    fake.motor.emergency(0, data=b"\1")
    fake.turn()
    assert faults(fake) == [HOT]


def test_a_node_that_starts_anew_has_lost_its_configuration() -> None:
    fake = FakeRig().ready()
    assert faults(fake) == []
    fake.stiffness.boot()
    fake.turn()
    assert fake.rig.bus_faults() == ((REBOOTED, "stiffness drive, node 2"),)


@pytest.mark.parametrize(("kind", "words"), [(0x40, "bus-off"), (0x20, "no node acknowledges"), (0, "error frame")])
def test_error_frames_are_bus_off_in_words(kind: int, words: str) -> None:
    fake = FakeRig().ready()
    fake.bus.post(can.Message(arbitration_id=kind, is_error_frame=True, data=bytes(8)))
    fake.turn()
    assert fake.rig.bus_faults() == ((BUS_OFF, words),)


def test_an_interface_that_takes_nothing_ages_all_and_is_told_after_three_cycles() -> None:
    fake = FakeRig().armed()
    fake.turn(10.0)
    fake.bus.send_error = OSError(105, "No buffer space available")
    assert ages(fake.turn(30.0, cycles=2)) == (2, 2, 2)
    assert faults(fake) == []
    measured = fake.turn(30.0)
    assert measured.motor_torque == pytest.approx(10.0, abs=MOTOR_UNIT), "the drive has taken nothing else over"
    assert fake.rig.bus_faults() == ((BUS_OFF, "frames cannot be sent: [Errno 105] No buffer space available"),)


def test_our_heartbeat_goes_out_four_times_in_the_time_that_drives_wait() -> None:
    fake = FakeRig().ready()
    fake.turn(cycles=500)
    assert len(fake.bus.sent_to(0x77F)) == pytest.approx(40, abs=2)
    assert set(fake.bus.sent_to(0x77F)) == {b"\5"}


def test_a_babbling_bus_holds_a_cycle_no_longer_than_its_share() -> None:
    fake = FakeRig().ready()
    for _ in range(5000):
        fake.bus.post(frame(0x7E5, b""))
    began = fake.clock.now
    fake.rig.exchange(0.0, 0.0)
    assert fake.clock.now - began <= RIG_FILE.answer_share * fake.rig.period_s + 1e-9


def test_a_fault_takes_the_axis_off_and_only_a_request_and_a_new_arming_bring_it_back() -> None:
    fake = FakeRig().armed()
    fake.motor.fail(0x2310)
    fake.turn(10.0, cycles=2)
    assert fake.rig.axis("motor").state == "fault"
    since = len(fake.motor.words)
    fake.rig.arm("motor")
    fake.turn(10.0, cycles=20)
    assert set(fake.motor.words[since:]) == {0}
    since = len(fake.motor.words)
    fake.rig.reset("motor")
    fake.turn(10.0, cycles=20)
    assert fake.motor.words[since:] == [0x80] + [0] * 19
    assert fake.rig.axis("motor").state == "disabled"
    fake.rig.arm("motor")
    fake.turn(10.0, cycles=4)
    assert fake.rig.axis("motor").state == "enabled"


@pytest.mark.parametrize("axis", AXES)
def test_a_drive_that_leaves_operation_by_itself_stays_out(axis: str) -> None:
    fake = FakeRig().armed()
    drive = fake.motor if axis == "motor" else fake.stiffness
    drive.status = 0x0240
    drive.entries[0x6041, 0] = struct.pack("<H", 0x0240)
    fake.turn(cycles=10)
    assert fake.rig.axis(axis).state == "disabled"  # type: ignore[arg-type]
    assert 0x0F not in drive.words[-9:]


def test_stopping_an_axis_is_its_own_quick_stop() -> None:
    fake = FakeRig().armed()
    fake.rig.stop("stiffness")
    fake.turn(cycles=3)
    assert fake.stiffness.words[-1] == 0x02
    status = fake.rig.axis("stiffness")
    assert (status.state, status.words) == ("stopping", "quick stop active")
    assert fake.rig.axis("motor").state == "enabled"
