"""A CAN bus in memory with an injected clock, and nodes on it: dictionary, SDO server, state machine, synchronous PDOs."""

import heapq
import struct
from collections.abc import Callable
from itertools import count

import can

from tests.injected_clock import Clock

SDO_DELAY_S, ANSWER_DELAY_S = 2e-4, 3e-4


class FakeBus:
    """Frames that nodes post arrive when their time has come; waiting for them moves the clock."""

    def __init__(self, clock: Clock) -> None:
        self.clock = clock
        self.sent: list[can.Message] = []
        self.nodes: list[FakeNode] = []
        self.closed = False
        self.send_error: OSError | None = None
        self.channel_info = "memory"
        self._coming: list[tuple[float, int, can.Message]] = []
        self._number = count()

    def send(self, message: can.Message, timeout: float | None = None) -> None:
        if self.send_error:
            raise self.send_error
        sent = frame(message.arbitration_id, bytes(message.data))
        self.sent.append(sent)
        for node in self.nodes:
            node.receive(sent)

    def recv(self, timeout: float) -> can.Message | None:
        if self._coming and self._coming[0][0] <= self.clock.now + timeout:
            due, _, message = heapq.heappop(self._coming)
            self.clock.now = max(self.clock.now, due)
            return message
        self.clock.now += timeout
        return None

    def post(self, message: can.Message, delay_s: float = 0.0) -> None:
        heapq.heappush(self._coming, (self.clock.now + delay_s, next(self._number), message))

    def shutdown(self) -> None:
        self.closed = True

    @property
    def waiting(self) -> int:
        return len(self._coming)

    def sent_to(self, can_id: int) -> list[bytes]:
        return [bytes(message.data) for message in self.sent if message.arbitration_id == can_id]


def frame(can_id: int, data: bytes, **kind: bool) -> can.Message:
    return can.Message(arbitration_id=can_id, is_extended_id=False, data=data, **kind)


class FakeNode:
    """A node with a dictionary; TPDOs as mapped in it, after each SYNC, once started."""

    def __init__(self, bus: FakeBus, number: int, entries: dict[tuple[int, int], bytes]) -> None:
        self.bus, self.number, self.entries = bus, number, entries
        self.operational = False
        self.silent = False
        self.refuses: set[int] = set()
        self.sticks: set[int] = set()
        self.delay_s: Callable[[int], float | None] = lambda place: ANSWER_DELAY_S
        self.spoil: Callable[[bytes], bytes] = bytes
        self.reads: list[tuple[int, int]] = []
        self.writes: list[tuple[int, int]] = []
        self._segments = b""
        bus.nodes.append(self)

    def receive(self, message: can.Message) -> None:
        can_id, data = message.arbitration_id, bytes(message.data)
        if self.silent:
            return
        if can_id == 0x600 + self.number:
            answer = self._served(data)
            if answer:
                self.bus.post(frame(0x580 + self.number, answer), SDO_DELAY_S)
        elif can_id == 0 and data[1] in (0, self.number):
            self.operational = data[0] == 1
        elif can_id == 0x80 and self.operational:
            self.synchronised()
            self.answer()
        elif can_id == 0x200 + self.number and self.operational:
            self.commanded(data)

    def commanded(self, data: bytes) -> None:
        """A drive's own."""

    def synchronised(self) -> None:
        """A drive's own."""

    def answer(self) -> None:
        for place in range(4):
            identifier = self.entries.get((0x1800 + place, 1))
            delay = self.delay_s(place)
            if identifier is None or delay is None or struct.unpack("<I", identifier)[0] >> 31:
                continue
            content = b""
            for entry in range(1, self.entries[0x1A00 + place, 0][0] + 1):
                (number,) = struct.unpack("<I", self.entries[0x1A00 + place, entry])
                content += self.entries[number >> 16, number >> 8 & 0xFF]
            can_id = struct.unpack("<I", identifier)[0] & 0x7FF
            self.bus.post(frame(can_id, self.spoil(content)), delay)

    def emergency(self, code: int, data: bytes | None = None) -> None:
        self.bus.post(frame(0x80 + self.number, struct.pack("<HB5x", code, 1) if data is None else data))

    def boot(self) -> None:
        self.operational = False
        self.bus.post(frame(0x700 + self.number, b"\0"))

    def _served(self, data: bytes) -> bytes:
        command, index, subindex = struct.unpack_from("<BHB", data)
        if command >> 5 == 3:  # next segment
            part, self._segments = self._segments[:7], self._segments[7:]
            return bytes([command & 0x10 | (7 - len(part)) << 1 | (not self._segments)]) + part.ljust(7, b"\0")
        if command == 0x80:
            return b""
        head = struct.pack("<HB", index, subindex)
        value = self.entries.get((index, subindex))
        if value is None or index in self.refuses:
            return b"\x80" + head + struct.pack("<I", 0x06020000)
        if command == 0x40:
            self.reads.append((index, subindex))
            if len(value) > 4:
                self._segments = value
                return b"\x41" + head + struct.pack("<I", len(value))
            return bytes([0x43 | (4 - len(value)) << 2]) + head + value.ljust(4, b"\0")
        size = 4 - (command >> 2 & 3)
        if size != len(value):
            return b"\x80" + head + struct.pack("<I", 0x06070010)
        self.writes.append((index, subindex))
        if index not in self.sticks:
            self.entries[index, subindex] = data[4 : 4 + size]
            if index == 0x6060:
                self.entries[0x6061, 0] = data[4:5]
        return b"\x60" + head + bytes(4)


def _pdos() -> dict[tuple[int, int], bytes]:
    entries: dict[tuple[int, int], bytes] = {}
    for place in range(4):
        for communication, mapping, identifier in ((0x1400, 0x1600, 0x200), (0x1800, 0x1A00, 0x180)):
            entries[communication + place, 1] = struct.pack("<I", 0xC0000000 | identifier + 0x100 * place)
            entries[communication + place, 2] = b"\xff"
            entries[communication + place, 5] = bytes(2)
            entries[mapping + place, 0] = b"\0"
            entries.update({(mapping + place, entry): bytes(4) for entry in range(1, 9)})
    return entries


def _identity(device_type: int, name: str, serial: int) -> dict[tuple[int, int], bytes]:
    numbers = {1: 0xFB, 2: 0x65, 3: 1, 4: serial}
    return {
        (0x1000, 0): struct.pack("<I", device_type),
        (0x1008, 0): name.encode(),
        (0x1017, 0): bytes(2),
        **{(0x1018, place): struct.pack("<I", number) for place, number in numbers.items()},
    }


class FakeDrive(FakeNode):
    """A CiA 402 drive: state machine, torque as asked once enabled; positions are what the test says."""

    def __init__(self, bus: FakeBus, number: int, rated: int, name: str = "VSSEA emulated drive") -> None:
        sizes = {
            (0x603F, 0): 2, (0x6040, 0): 2, (0x6007, 0): 2, (0x605A, 0): 2, (0x605E, 0): 2, (0x6060, 0): 1, (0x6061, 0): 1,
            (0x6064, 0): 4, (0x6071, 0): 2, (0x6072, 0): 2, (0x6077, 0): 2, (0x6085, 0): 4, (0x60C2, 1): 1, (0x60C2, 2): 1,
            (0x1016, 1): 4, (0x1029, 1): 1, (0x60E4, 2): 4,
        }  # fmt: skip
        super().__init__(bus, number, {
            **_identity(0x00020192, name, 1000 + number), **_pdos(), **{key: bytes(size) for key, size in sizes.items()},
            (0x6076, 0): struct.pack("<I", rated), (0x6502, 0): struct.pack("<I", 1 << 9),
        })  # fmt: skip
        self.status = 0x0240
        self.control = self.target = 0
        self.target_control = (0, 0)
        self.words: list[int] = []
        self.torques: list[int] = []

    @property
    def status(self) -> int:
        return struct.unpack("<H", self.entries[0x6041, 0])[0]

    @status.setter
    def status(self, word: int) -> None:
        self.entries[0x6041, 0] = struct.pack("<H", word)

    @property
    def position(self) -> int:
        return struct.unpack("<i", self.entries[0x6064, 0])[0]

    @position.setter
    def position(self, counts: int) -> None:
        self.entries[0x6064, 0] = struct.pack("<I", counts & 0xFFFFFFFF)

    def value(self, index: int, subindex: int = 0, form: str = "<h") -> int:
        return struct.unpack(form, self.entries[index, subindex])[0]

    def fail(self, code: int) -> None:
        self.status = 0x0208
        self.entries[0x603F, 0] = struct.pack("<H", code)
        self.emergency(code)

    def commanded(self, data: bytes) -> None:
        self.target_control = struct.unpack("<Hh", data)

    def synchronised(self) -> None:
        before = self.control
        self.control, self.target = self.target_control
        self.words.append(self.control)
        state, word = self.status & 0x6F, self.control
        if state & 0x4F == 0x08:
            if word & 0x80 and not before & 0x80:
                self.status = 0x0240
        elif not word & 0x02:
            self.status = 0x0240
        elif not word & 0x04:
            self.status = 0x0207 if state in (0x27, 0x07) else 0x0240
        elif state & 0x4F == 0x40:
            self.status = 0x0221 if word & 0x7 == 0x6 else self.status
        elif state in (0x21, 0x23, 0x27):
            self.status = {0x6: 0x0221, 0x7: 0x0223 if state != 0x21 or not word & 8 else 0x0227}[word & 0x7]
            if word & 0xF == 0xF and state in (0x23, 0x27):
                self.status = 0x0227
        elif state == 0x07 and word & 0xF == 0xF:
            self.status = 0x0227
        given = self.target if self.status & 0x6F == 0x27 else 0
        self.torques.append(given)
        self.entries[0x6077, 0] = struct.pack("<h", given)


class FakeEncoder(FakeNode):
    """A CiA 406 encoder."""

    def __init__(self, bus: FakeBus, number: int) -> None:
        super().__init__(bus, number, {**_identity(0x00020196, "encoder", 77), **_pdos(), (0x6004, 0): bytes(4)})

    @property
    def position(self) -> int:
        return struct.unpack("<I", self.entries[0x6004, 0])[0]

    @position.setter
    def position(self, counts: int) -> None:
        self.entries[0x6004, 0] = struct.pack("<I", counts & 0xFFFFFFFF)
