"""Opening the bus, finding the nodes, and closing again."""

import socket
import threading

import can
import pytest

from backend.rigs.canopen import opening
from backend.rigs.canopen.opening import open_bus
from backend.rigs.faults import NO_BUS, WRONG_DEVICE
from backend.rigs.rig import RigError
from backend.rigs.rig_file import Bus
from tests.hardware.fake_rig import FakeRig, changed


def test_a_socketcand_host_that_does_not_listen_is_a_sentence_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        port = unused.getsockname()[1]
        monkeypatch.setattr(can, "Bus", lambda **_: pytest.fail("python-can would try for 10 s"))
        with pytest.raises(RigError, match=f"nothing listens on 127.0.0.1:{port}.*vssea emulator") as refusal:
            open_bus(Bus(interface="socketcand", options={"host": "127.0.0.1", "port": port}))
    assert refusal.value.fault is NO_BUS


def test_socketcand_sends_small_writes_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    given: dict[str, object] = {}
    monkeypatch.setattr(opening, "_refuse_unless_listening", lambda host, port: None)
    monkeypatch.setattr(can, "Bus", lambda **config: given.update(config))
    open_bus(Bus(interface="socketcand", channel="can1", options={"host": "rig", "port": 29536}))
    assert given == {
        "ignore_config": True, "interface": "socketcand", "channel": "can1", "host": "rig", "port": 29536,
        "bitrate": 1_000_000, "tcp_tune": True,
    }  # fmt: skip


@pytest.mark.parametrize(
    "bus",
    [
        Bus(interface="no such interface"),
        Bus(interface="socketcand"),
        Bus(interface="slcan", channel="/no/such/device"),
    ],
)  # fmt: skip
def test_a_bus_that_cannot_be_opened_is_a_fault_with_the_reason(bus: Bus) -> None:
    with pytest.raises(RigError) as refusal:
        open_bus(bus)
    assert refusal.value.fault is NO_BUS
    assert refusal.value.detail


def test_a_node_that_does_not_answer_is_named() -> None:
    fake = FakeRig()
    fake.stiffness.silent = fake.link.silent = True
    with pytest.raises(RigError, match="no answer from stiffness drive, node 2 and link encoder, node 3") as refusal:
        fake.rig.connect()
    assert refusal.value.fault is WRONG_DEVICE


def test_who_answers_is_told_with_name_serial_and_rated_torque() -> None:
    fake = FakeRig()
    fake.rig.connect()
    identity = fake.rig.identify()
    assert identity.kind == "emulated"
    assert identity.devices[0] == ("motor drive, node 1", "VSSEA emulated drive, serial 1001, rated 0.533 N·m")
    assert [where for where, _ in identity.devices] == [
        "motor drive, node 1", "stiffness drive, node 2", "link encoder, node 3",
    ]  # fmt: skip


def test_a_rig_is_real_where_no_device_says_it_is_emulated() -> None:
    fake = FakeRig()
    for drive in (fake.motor, fake.stiffness):
        drive.entries[0x1008, 0] = b"EPOS4"
    fake.rig.connect()
    assert fake.rig.identify().kind == "real"


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"serial": 7}, "motor drive, node 1: serial is 1001, the file says 7"),
        ({"vendor": 0x1A}, "motor drive, node 1: vendor is 0x000000FB, the file says 0x0000001A"),
        ({"device_type": 0x00030192}, "motor drive, node 1: device type is 0x00020192, the file says 0x00030192"),
    ],
)
def test_another_device_than_the_file_names_is_refused(changes: dict[str, int], sentence: str) -> None:
    fake = FakeRig(changed(motor=changes))
    fake.rig.connect()
    with pytest.raises(RigError, match=sentence) as refusal:
        fake.rig.identify()
    assert refusal.value.fault is WRONG_DEVICE


def test_a_drive_in_the_encoders_place_is_refused() -> None:
    fake = FakeRig()
    fake.link.entries[0x1000, 0] = fake.motor.entries[0x1000, 0]
    fake.rig.connect()
    with pytest.raises(RigError, match="link encoder, node 3: device type is 0x00020192, the file says an encoder"):
        fake.rig.identify()


def test_closing_disables_both_drives_ends_their_watch_and_closes_the_bus() -> None:
    fake = FakeRig().armed()
    fake.rig.close()
    for drive in (fake.motor, fake.stiffness):
        assert drive.status == 0x0240
        assert drive.value(0x1016, 1, "<I") == 0, "a watch that goes on would end in a fault"
        assert not drive.operational
    assert fake.bus.closed
    fake.rig.close()


def test_closing_never_raises_and_is_quick_where_nobody_answers() -> None:
    fake = FakeRig().armed()
    for node in (fake.motor, fake.stiffness, fake.link):
        node.silent = True
    fake.turn(cycles=12)
    began = fake.clock.now
    fake.rig.close()
    assert fake.clock.now - began < 0.1
    assert fake.bus.closed


@pytest.mark.parametrize("stage", ["new", "connected", "configured"])
def test_closing_never_raises_where_the_interface_is_gone(stage: str) -> None:
    fake = FakeRig()
    if stage != "new":
        fake.rig.connect()
    if stage == "configured":
        fake.rig.identify()
        fake.rig.configure()
    fake.bus.send_error = OSError(19, "No such device")
    fake.rig.close()
    assert fake.bus.closed == (stage != "new")


def test_no_thread_is_started() -> None:
    before = threading.active_count()
    fake = FakeRig().armed()
    assert threading.active_count() == before
    fake.rig.close()
