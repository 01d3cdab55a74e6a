"""The emulator as a process, met by python-can's own socketcand backend, by canopen and by the command line."""

import json
import selectors
import socket
import struct
import time
from collections.abc import Iterator

import can
import canopen
import pytest
from canopen.objectdictionary import ODVariable
from canopen.objectdictionary.datatypes import INTEGER8, INTEGER16, INTEGER32, UNSIGNED16, UNSIGNED32, VISIBLE_STRING
from typer.testing import CliRunner

from backend.cli import app
from backend.emulator.can_interface import CanInterface
from backend.emulator.start import EmulatorHandle, start_emulator

pytestmark = pytest.mark.real_time

OBJECTS = {
    0x1000: UNSIGNED32, 0x1008: VISIBLE_STRING, 0x1017: UNSIGNED16, 0x6007: INTEGER16, 0x6060: INTEGER8, 0x6064: INTEGER32,
    0x6071: INTEGER16, 0x6076: UNSIGNED32,
}  # fmt: skip
MOST_CYCLES = 10_000  # within which a motor under its rated torque has turned by a thousand counts


@pytest.fixture(scope="module")
def emulator() -> Iterator[EmulatorHandle]:
    handle = start_emulator()
    yield handle
    handle.close()
    assert not handle.process.is_alive()


@pytest.fixture
def bus(emulator: EmulatorHandle) -> Iterator[can.BusABC]:
    opened = can.Bus(interface="socketcand", channel="can0", host="127.0.0.1", port=emulator.port)
    yield opened
    opened.send(can.Message(arbitration_id=0, data=[129, 0], is_extended_id=False))
    opened.shutdown()
    emulator.control({"do": "clear"})


def dictionary() -> canopen.ObjectDictionary:
    objects = canopen.ObjectDictionary()
    for index, kind in OBJECTS.items():
        variable = ODVariable(f"{index:04X}", index)
        variable.data_type = kind
        objects.add_object(variable)
    record = canopen.objectdictionary.ODRecord("1016", 0x1016)
    consumer = ODVariable("1016.1", 0x1016, 1)
    consumer.data_type = UNSIGNED32
    record.add_member(consumer)
    objects.add_object(record)
    return objects


def exchange(bus: can.BusABC, word: int, torque: int) -> dict[int, bytes]:
    """One cycle; the answers by identifier."""
    for node, asked in ((1, torque), (2, 0)):
        data = struct.pack("<Hh", word, asked)
        bus.send(can.Message(arbitration_id=0x200 + node, data=data, is_extended_id=False))
    bus.send(can.Message(arbitration_id=0x77F, data=[5], is_extended_id=False))
    bus.send(can.Message(arbitration_id=0x80, is_extended_id=False))
    answers: dict[int, bytes] = {}
    until = time.monotonic() + 5.0
    while not {0x181, 0x182, 0x183} <= answers.keys():
        message = bus.recv(until - time.monotonic())
        assert message is not None, f"only {sorted(answers)} answered within 5 s"
        answers[message.arbitration_id] = bytes(message.data)
    return answers


def wait_for(emulator: EmulatorHandle, word: str) -> dict[str, object]:
    until = time.monotonic() + 20.0
    while time.monotonic() < until:
        peaks = emulator.control({"do": "peaks"})
        if peaks["states"]["motor"] == word and peaks["safe_after_s"] is not None:
            return peaks
    pytest.fail(f"the motor drive did not come to {word!r}: {peaks}")


def test_an_independent_host_configures_enables_moves_and_when_it_dies_the_drives_stop_by_themselves(
    emulator: EmulatorHandle, bus: can.BusABC
) -> None:
    network = canopen.Network(bus)
    network.notifier = can.Notifier(bus, network.listeners, 0.1)
    try:
        for number in (1, 2):
            node = network.add_node(canopen.RemoteNode(number, dictionary()))
            node.sdo.RESPONSE_TIMEOUT = 5.0
            assert "VSSEA emulated drive" in node.sdo[0x1008].raw
            assert node.sdo[0x1000].raw == 0x20192
            node.sdo[0x6060].raw = 10
            node.sdo[0x6007].raw = 3
            node.sdo[0x1016][1].raw = 127 << 16 | 500
            with pytest.raises(canopen.SdoAbortedError):
                node.sdo[0x6060].raw = 1
        network.nmt.state = "OPERATIONAL"
    finally:
        network.notifier.stop()
    for word in (6, 7, 15):
        answers = exchange(bus, word, 0)
    assert struct.unpack_from("<H", answers[0x181])[0] & 0x6F == 0x27
    assert struct.unpack_from("<H", answers[0x182])[0] & 0x6F == 0x27
    began = struct.unpack_from("<i", answers[0x181], 2)[0]
    cycles = 0
    while struct.unpack_from("<i", answers[0x181], 2)[0] <= began + 1000:
        cycles += 1
        assert cycles < MOST_CYCLES, "the motor does not move in the direction of its torque"
        answers = exchange(bus, 15, 1000)
    assert emulator.control({"do": "state"})["motor_torque"] > 10.0
    emulator.control({"do": "watch"})
    peaks = wait_for(emulator, "switch on disabled")  # nobody sends any more
    assert abs(peaks["motor_torque"]) < 0.5  # type: ignore[arg-type]
    assert peaks["re_enabled"] is False


def test_every_client_sees_the_frames_of_nodes_and_of_other_clients_but_not_its_own(
    emulator: EmulatorHandle, bus: can.BusABC
) -> None:
    with can.Bus(interface="socketcand", channel="can0", host="127.0.0.1", port=emulator.port) as other:
        other.send(can.Message(arbitration_id=0x7FF, is_extended_id=False))  # its handshake is over
        assert bus.recv(5.0).arbitration_id == 0x7FF  # type: ignore[union-attr]
        bus.send(can.Message(arbitration_id=0x601, data=bytes.fromhex("4000100000000000"), is_extended_id=False))
        assert [other.recv(5.0).arbitration_id for _ in range(2)] == [0x601, 0x581]  # type: ignore[union-attr]
        assert bus.recv(5.0).arbitration_id == 0x581  # type: ignore[union-attr]


def test_bus_off_comes_as_an_error_frame_and_then_nothing(emulator: EmulatorHandle, bus: can.BusABC) -> None:
    bus.send(can.Message(arbitration_id=0x7FF, is_extended_id=False))
    assert emulator.control({"do": "fault", "name": "bus_off"})["ok"]
    message = bus.recv(5.0)
    assert message is not None
    assert message.is_error_frame
    assert message.arbitration_id == 0x40
    bus.send(can.Message(arbitration_id=0x601, data=bytes.fromhex("4000100000000000"), is_extended_id=False))
    assert bus.recv(0.2) is None


def test_a_client_that_speaks_nonsense_harms_nobody(emulator: EmulatorHandle, bus: can.BusABC) -> None:
    with socket.create_connection(("127.0.0.1", emulator.port)) as client:
        client.sendall(b"< open can0 >< rawmode >< send 601 9 1 2 >< send zz 1 1 >>><<< send >" + b"x" * 5000 + b"\xff")
        client.sendall(b"< send 601 2 1 2 >< send 000 1 1 >< send 201 0  >")
    bus.send(can.Message(arbitration_id=0x601, data=bytes.fromhex("4000100000000000"), is_extended_id=False))
    message = bus.recv(5.0)
    while message is not None and message.arbitration_id != 0x581:
        message = bus.recv(5.0)
    assert message is not None


def test_the_control_port_answers_every_line_even_one_that_is_no_request(emulator: EmulatorHandle) -> None:
    with socket.create_connection(("127.0.0.1", emulator.port + 1), 5.0) as client, client.makefile("rwb") as lines:
        lines.write(b'nonsense\n[1]\n{"do": "state"}\n')
        lines.flush()
        replies = [json.loads(lines.readline()) for _ in range(3)]
    assert [set(reply) == {"error"} for reply in replies] == [True, True, False]
    assert replies[2]["stiffness"] == pytest.approx(200.0, rel=0.5)


def test_the_command_line_sets_shows_and_clears_faults(emulator: EmulatorHandle) -> None:
    def command(*words: str) -> tuple[int, str]:
        result = CliRunner().invoke(app, ["emulator", "--port", str(emulator.port), *words])
        return result.exit_code, result.output

    assert command("fault", "drive_fault", "--node", "2", "--value", "0x5113")[0] == 0
    code, text = command("state")
    assert code == 0
    assert json.loads(text)["faults"] == ["drive_fault"]
    assert json.loads(text)["nodes"]["2"]["last_error"] == 0x5113
    assert command("clear")[0] == 0
    assert command("load", "0.5")[0] == 0
    assert command("load", "0")[0] == 0
    assert json.loads(command("state")[1])["faults"] == []
    assert command("watch")[0] == 0
    assert json.loads(command("peaks")[1])["re_enabled"] is False
    code, text = command("fault", "earthquake")
    assert code == 2
    assert "there is no fault 'earthquake'" in text
    assert "torque_saturated" in command("faults")[1]


def test_a_taken_port_is_refused_in_a_sentence(emulator: EmulatorHandle) -> None:
    with pytest.raises(OSError, match=r"the emulator cannot start: .*in use"):
        start_emulator(port=emulator.port)


def test_without_an_emulator_a_command_says_how_to_start_one() -> None:
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    result = CliRunner().invoke(app, ["emulator", "--port", str(port), "state"])
    assert result.exit_code == 2
    assert "start one with: vssea emulator" in result.output


@pytest.mark.parametrize(
    ("interface", "said"), [("socketcan", "does `ip link` list the channel?"), ("virtual", "cannot be waited for")]
)
def test_an_interface_that_cannot_be_is_refused_in_a_sentence(interface: str, said: str) -> None:
    result = CliRunner().invoke(app, ["emulator", "--interface", interface, "--channel", "nosuch0"])
    assert result.exit_code == 2
    assert f"{interface} nosuch0 cannot be opened" in result.output
    assert said in result.output


def test_on_an_interface_of_the_system_frames_go_in_and_out(monkeypatch: pytest.MonkeyPatch) -> None:
    ours, its = socket.socketpair()
    sent: list[can.Message] = []

    class Interface:
        """What python-can opens, with one frame in it."""

        fileno, send, shutdown = its.fileno, staticmethod(sent.append), its.close

        def recv(self, _timeout: float) -> can.Message:
            its.recv(1)
            return can.Message(arbitration_id=0x123, data=[1, 2], is_extended_id=False, timestamp=time.time())

    monkeypatch.setattr(can, "Bus", lambda **_: Interface())
    received: list[tuple[int, bytes]] = []
    with selectors.DefaultSelector() as selector:
        interface = CanInterface(
            "socketcan", "vcan0", selector, lambda number, data, _: received.append((number, data))
        )
        ours.send(b"x")
        for key, events in selector.select(5.0):
            key.data(events)
        interface.send(0x181, b"\x01")
        interface.close()
    ours.close()
    assert received == [(0x123, b"\x01\x02")]
    assert [(message.arbitration_id, bytes(message.data)) for message in sent] == [(0x181, b"\x01")]


@pytest.mark.parametrize(
    ("content", "said"),
    [("{", "Invalid JSON"), ('{"motor": {"inertia": -1}}', "motor.inertia"), (None, "cannot be read")],
)
def test_an_actuator_that_cannot_be_is_refused_before_anything_starts(
    tmp_path_factory: pytest.TempPathFactory, content: str | None, said: str
) -> None:
    file = tmp_path_factory.mktemp("actuator") / "actuator.json"
    if content is not None:
        file.write_text(content)
    result = CliRunner().invoke(app, ["emulator", "--actuator", str(file)])
    assert result.exit_code == 2
    assert said in result.output
