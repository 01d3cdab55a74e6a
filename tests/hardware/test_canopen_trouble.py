"""What the bus and its nodes report of themselves: emergencies, restarts, errors, malformed frames."""

import can
import pytest

from backend.rigs.faults import BUS_OFF, CORRUPTED, HOT, LINK_ENCODER, MOTOR_DRIVE, REBOOTED, STIFFNESS_DRIVE
from tests.hardware.fake_bus import frame
from tests.hardware.fake_rig import MOTOR_UNIT, FakeRig, ages, faults


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
    for _ in range(4):
        fake.motor.emergency(0, data=b"\1")
    fake.turn()
    assert faults(fake) == [CORRUPTED]


def test_what_nodes_said_before_they_were_configured_is_no_fault_of_this_session() -> None:
    fake = FakeRig()
    fake.motor.emergency(0x8130)
    fake.stiffness.boot()
    assert faults(fake.ready()) == []


def test_a_node_that_starts_anew_has_lost_its_configuration() -> None:
    fake = FakeRig().ready()
    assert faults(fake) == []
    fake.stiffness.boot()
    fake.turn()
    assert fake.rig.bus_faults() == ((REBOOTED, "stiffness drive, node 2"),)
    assert faults(fake) == [], "told once"


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
    fake.bus.send_error = None
    assert [max(ages(fake.turn())) for _ in range(10)] == [0] * 10, "what was not asked for is not waited for"


def test_a_babbling_bus_does_not_hold_the_loop() -> None:
    fake = FakeRig().ready()
    for _ in range(5000):
        fake.bus.post(frame(0x7E5, b""))
    fake.rig.exchange(0.0, 0.0)
    assert fake.bus.waiting > 4000, "the loop has its time for more than frames of no use"
