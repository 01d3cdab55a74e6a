"""The cyclic exchange: what goes out, in which units, and how an axis goes where it is told."""

import math
import struct

import pytest

from backend.rigs.rig import AXES
from tests.hardware.fake_bus import ANSWER_DELAY_S
from tests.hardware.fake_rig import MOTOR_UNIT, RIG_FILE, FakeRig, ages, changed


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


def test_our_heartbeat_goes_out_eight_times_in_the_time_that_drives_wait() -> None:
    fake = FakeRig().ready()
    fake.turn(cycles=500)
    assert len(fake.bus.sent_to(0x77F)) == pytest.approx(83, abs=2)
    assert set(fake.bus.sent_to(0x77F)) == {b"\5"}


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
