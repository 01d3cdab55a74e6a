"""What the drives are told before anything moves."""

import struct

import pytest

from backend.rigs.faults import CONFIGURATION
from backend.rigs.rig import RigError
from tests.hardware.fake_rig import FakeRig, changed


def mapped(fake_node: object, mapping: int) -> list[int]:
    entries = fake_node.entries  # type: ignore[attr-defined]
    return [struct.unpack("<I", entries[mapping, place])[0] for place in range(1, entries[mapping, 0][0] + 1)]


def test_the_pdos_are_laid_out_and_synchronous() -> None:
    fake = FakeRig().ready()
    for number, drive in ((1, fake.motor), (2, fake.stiffness)):
        assert mapped(drive, 0x1600) == [0x60400010, 0x60710010]
        assert mapped(drive, 0x1A00) == [0x60410010, 0x60640020]
        assert mapped(drive, 0x1A01) == [0x60770010]
        for communication, identifier in ((0x1400, 0x200), (0x1800, 0x180), (0x1801, 0x280)):
            assert drive.value(communication, 1, "<I") == 0x40000000 | identifier + number, "the RTR bit stays as it is"
            assert drive.entries[communication, 2] == b"\1"
    assert mapped(fake.link, 0x1A00) == [0x60040020]


def test_pdos_that_nobody_reads_are_switched_off() -> None:
    fake = FakeRig()
    for node in (fake.motor, fake.link):
        node.entries[0x1802, 1] = struct.pack("<I", 0x40000380 + node.number)
    fake.ready()
    for node in (fake.motor, fake.link):
        assert struct.unpack("<I", node.entries[0x1802, 1])[0] >> 31


def test_each_axis_is_told_what_to_do_when_this_computer_is_gone() -> None:
    fake = FakeRig().ready()
    for drive, quick_stop in ((fake.motor, 2), (fake.stiffness, 6)):
        assert drive.value(0x6007) == 3, "quick stop, not coasting"
        assert drive.value(0x605A) == quick_stop, (
            "the equilibrium motor lets go after its ramp, the stiffness motor holds"
        )
        assert drive.value(0x605E) == 2
        assert drive.value(0x1016, 1, "<I") == 127 << 16 | 100
        assert drive.value(0x1017, 0, "<H") == 100
        assert drive.value(0x1400, 5, "<H") == 50
        assert drive.value(0x1029, 1, "<B") == 1, "it stays in the cycle, so that one sees how it stands"
        assert drive.value(0x6060, 0, "<b") == 10
        assert drive.value(0x6071) == 0
        assert (drive.value(0x60C2, 1, "<B"), drive.value(0x60C2, 2, "<b")) == (2, -3)
        assert drive.operational


def test_the_drives_own_torque_limit_is_the_files() -> None:
    fake = FakeRig().ready()
    assert fake.motor.value(0x6072, 0, "<H") == int(74.0 / (0.533 * 0.7 * 100.0) * 1000.0)
    assert fake.stiffness.value(0x6072, 0, "<H") == int(0.79 / 0.44 * 1000.0)


def test_the_quick_stop_ramp_is_the_drives_own_unless_the_file_has_one() -> None:
    assert (0x6085, 0) not in FakeRig().ready().motor.writes
    assert FakeRig(changed(motor={"quick_stop_deceleration": 5000})).ready().motor.value(0x6085, 0, "<I") == 5000


def test_all_that_is_written_is_read_back() -> None:
    drive = FakeRig().ready().motor
    assert {0x1400, 0x1600, 0x1800, 0x1A00, 0x1A01, 0x6060, 0x6072, 0x6007, 0x605A, 0x605E, 0x1016} <= {
        i for i, _ in drive.writes
    }
    assert set(drive.writes) <= set(drive.reads)


@pytest.mark.parametrize("index", [0x1016, 0x6007, 0x605A, 0x605E, 0x6072])
@pytest.mark.parametrize("how", ["refuses", "sticks"])
def test_a_drive_without_a_safety_object_is_refused_unless_the_file_accepts_it(index: int, how: str) -> None:
    fake = FakeRig()
    getattr(fake.stiffness, how).add(index)
    with pytest.raises(
        RigError, match=f"stiffness drive, node 2: 0x{index:04X}.*list 0x{index:04X} in `without`"
    ) as refusal:
        fake.ready()
    assert refusal.value.fault is CONFIGURATION
    fake = FakeRig(changed(stiffness={"without": [index]}))
    getattr(fake.stiffness, how).add(index)
    assert [f"0x{index:04X}" in words for words in fake.ready().rig.without] == [True]


@pytest.mark.parametrize("index", [0x6060, 0x1400, 0x1600, 0x1A00, 0x1800])
def test_what_the_exchange_needs_is_never_accepted_missing(index: int) -> None:
    fake = FakeRig()
    fake.motor.sticks.add(index)
    with pytest.raises(RigError, match=f"motor drive, node 1: 0x{index:04X}") as refusal:
        fake.ready()
    assert refusal.value.fault is CONFIGURATION


def test_a_drive_that_stays_in_another_mode_is_refused() -> None:
    fake = FakeRig()
    fake.motor.refuses.add(0x6060)
    with pytest.raises(RigError, match=r"0x6060 mode of operation: .*object does not exist"):
        fake.ready()
    fake = FakeRig()
    fake.motor.entries.pop((0x6060, 0))
    fake.motor.entries[0x6060, 0] = b"\x0a"
    fake.motor.sticks.add(0x6060)
    fake.motor.entries[0x6061, 0] = b"\x08"
    with pytest.raises(RigError, match="mode of operation is 8, expected 10"):
        fake.ready()


def test_what_is_only_of_use_is_reported_by_name() -> None:
    fake = FakeRig()
    fake.motor.refuses |= {0x60C2, 0x1017}
    fake.stiffness.entries.pop((0x1400, 5))
    fake.ready()
    told = " ".join(fake.rig.without)
    assert "0x60C2:01" in told
    assert "0x1017 heartbeat" in told
    assert "stiffness drive, node 2: 0x1400:05 RPDO deadline" in told
    assert [what for what, _ in fake.rig.identify().devices].count("not taken over") == len(fake.rig.without)


def test_a_fixed_layout_is_taken_as_it_is_where_it_fits() -> None:
    fake = FakeRig()
    fake.link.entries[0x1A00, 0] = b"\1"
    fake.link.entries[0x1A00, 1] = struct.pack("<I", 0x60040020)
    fake.link.sticks.add(0x1A00)
    fake.ready()
    assert not any(index == 0x1A00 for index, _ in fake.link.writes)


def test_the_second_encoder_of_a_drive_comes_with_its_torque() -> None:
    link = {"source": "stiffness_drive", "node": None, "index": 0x60E4, "subindex": 2, "bits": 32}
    fake = FakeRig(changed(link=link))
    fake.bus.nodes.remove(fake.link)
    fake.ready()
    assert mapped(fake.stiffness, 0x1A01) == [0x60770010, 0x60E40220]
    fake.stiffness.entries[0x60E4, 2] = struct.pack("<i", 131_072 // 8)
    measured = fake.turn()
    assert measured.link_position == pytest.approx(0.7853981633974483)
    assert measured.link_age == 0
    fake.stiffness.delay_s = lambda place: None
    assert fake.turn().link_age == 1


def test_a_drive_that_was_left_in_fault_tells_why_and_stays_so() -> None:
    fake = FakeRig()
    fake.motor.status = 0x0208
    fake.motor.entries[0x603F, 0] = struct.pack("<H", 0x8130)
    fake.ready()
    fake.turn(cycles=3)
    status = fake.rig.axis("motor")
    assert (status.state, status.error_words) == ("fault", "0x8130 the heartbeat of this computer stayed away")
    assert set(fake.motor.words) == {0}


def test_a_drive_found_holding_goes_on_holding_until_it_is_told_otherwise() -> None:
    fake = FakeRig()
    fake.stiffness.status = 0x0207
    fake.stiffness.entries[0x6040, 0] = struct.pack("<H", 2)
    fake.stiffness.target_control = (2, 0)
    fake.ready()
    fake.turn(cycles=5)
    assert fake.rig.axis("stiffness").words == "quick stop active"
    fake.rig.disarm("stiffness")
    fake.turn(cycles=2)
    assert fake.rig.axis("stiffness").state == "disabled"


def test_a_drive_that_says_no_rated_torque_is_refused() -> None:
    fake = FakeRig()
    fake.motor.entries[0x6076, 0] = bytes(4)
    with pytest.raises(RigError, match="motor drive, node 1: rated torque") as refusal:
        fake.ready()
    assert refusal.value.fault is CONFIGURATION


def test_a_torque_limit_that_the_drive_cannot_resolve_is_refused() -> None:
    with pytest.raises(RigError, match=r"torque_limit 0.01 N·m is less than the drive can resolve") as refusal:
        FakeRig(changed(motor={"torque_limit": 0.01})).ready()
    assert refusal.value.fault is CONFIGURATION
