"""The read-only look at a rig."""

import struct

import pytest

from backend.rigs import check
from backend.rigs.canopen import opening
from backend.rigs.check import CheckLine, check_rig
from backend.rigs.faults import NO_BUS
from backend.rigs.rig import RigError
from backend.rigs.rig_file import Bus
from tests.hardware.fake_rig import GEAR_RATIO, FakeRig, changed


@pytest.fixture
def fake(monkeypatch: pytest.MonkeyPatch) -> FakeRig:
    fake = FakeRig()
    monkeypatch.setattr(opening, "open_bus", lambda bus: fake.bus)
    return fake


def lines(fake: FakeRig) -> dict[str, CheckLine]:
    found = check_rig(fake.file, GEAR_RATIO, clock=fake.clock)
    assert all(bool(line["sentence"]) != line["ok"] for line in found), (
        "a sentence where something is wrong, and only there"
    )
    return {line["what"]: line for line in found}


def wrong(fake: FakeRig) -> dict[str, str]:
    return {what: line["sentence"] for what, line in lines(fake).items() if not line["ok"]}


def test_a_rig_as_its_file_says_has_no_wrong_line(fake: FakeRig) -> None:
    found = lines(fake)
    assert wrong(fake) == {}
    assert found["nodes"]["found"] == "1, 2, 3"
    assert found["motor drive, node 1: rated torque"]["found"] == "0.533 N·m"
    assert found["motor drive, node 1: state"]["found"] == "switch on disabled"
    assert fake.bus.closed


def test_nothing_is_written_started_or_commanded(fake: FakeRig) -> None:
    check_rig(fake.file, GEAR_RATIO, clock=fake.clock)
    assert [node.writes for node in fake.bus.nodes] == [[], [], []]
    assert {message.arbitration_id & 0x780 for message in fake.bus.sent} == {0x600}


def test_what_is_wrong_is_told_line_by_line(fake: FakeRig) -> None:
    fake.motor.status = 0x0208
    fake.motor.entries[0x603F, 0] = struct.pack("<H", 0x3220)
    fake.motor.entries[0x6076, 0] = bytes(4)
    fake.stiffness.entries[0x6502, 0] = struct.pack("<I", 0x7)
    fake.stiffness.refuses.add(0x6007)
    fake.link.position = 131072 // 2
    found = wrong(fake)
    assert list(found) == [
        "motor drive, node 1: rated torque",
        "motor drive, node 1: state",
        "stiffness drive, node 2: modes",
        "stiffness drive, node 2: 0x6007 reaction to a lost connection",
        "link position",
    ]
    assert "0x3220 under-voltage" in found["motor drive, node 1: state"]
    assert "Move the link inside its limits" in found["link position"]


def test_a_missing_and_an_unexpected_node_are_seen(fake: FakeRig) -> None:
    fake.stiffness.silent = True
    fake.link.number = 9
    found = lines(fake)
    assert found["nodes"]["found"] == "1, 9"
    assert found["nodes"]["sentence"].startswith("No answer from stiffness drive, node 2 and link encoder, node 3")
    assert not any(what.startswith("stiffness drive") for what in found)


def test_another_device_is_told_with_what_the_file_expects(fake: FakeRig) -> None:
    fake.file = changed(motor={"serial": 7})
    line = lines(fake)["motor drive, node 1: serial"]
    assert (line["found"], line["expected"], line["ok"]) == ("1001", "7", False)


def test_an_object_that_the_file_accepts_to_be_missing_is_no_trouble(fake: FakeRig) -> None:
    fake.file = changed(motor={"without": [0x605E]})
    fake.motor.refuses.add(0x605E)
    line = lines(fake)["motor drive, node 1: 0x605E reaction to a fault"]
    assert (line["expected"], line["ok"]) == ("accepted to be missing", True)


def test_a_wrong_unit_of_torque_is_seen(fake: FakeRig) -> None:
    fake.file = changed(motor={"rated_torque_unit": 1e-9})
    assert "does not fit" in wrong(fake)["motor drive, node 1: rated torque"]


def test_a_bus_that_cannot_be_opened_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(bus: Bus) -> None:
        raise RigError(NO_BUS, "no such device")

    monkeypatch.setattr(opening, "open_bus", refuse)
    (line,) = check.check_rig(changed(), GEAR_RATIO)
    assert not line["ok"]
    assert "no such device" in line["sentence"]
