"""A host for the emulator without sockets and without waiting: SDO, PDOs, SYNC and heartbeats at a time that is told."""

import struct
from typing import Any

from backend.emulator.emulator import Emulator
from backend.emulator.faults import Faults
from backend.emulator.plant import default_actuator
from vssea_core.actuator.parameters import Actuator

MOTOR, STIFFNESS, LINK = 1, 2, 3
HOST = 127
SHUTDOWN, SWITCH_ON, ENABLE, QUICK_STOP, DISABLE_VOLTAGE, RESET, HALT = 0x06, 0x07, 0x0F, 0x02, 0x00, 0x80, 0x010F
SIZES = {1: 0x2F, 2: 0x2B, 4: 0x23}
MASK = 0x6F  # the state's bits in a statusword
WORDS = {
    "switch on disabled": 0x40,
    "ready to switch on": 0x21,
    "switched on": 0x23,
    "operation enabled": 0x27,
    "quick stop active": 0x07,
    "fault reaction active": 0x0F,
    "fault": 0x08,
}


class Bench:
    """An emulator, and what came out of it."""

    def __init__(self, actuator: Actuator | None = None, **options: Any) -> None:
        self.frames: list[tuple[int, bytes]] = []
        self.errors: list[int] = []
        self.emulator = Emulator(actuator or default_actuator(), lambda *frame: self.frames.append(frame), **options)
        self.faults = Faults(self.emulator, self.errors.append)
        self.now = 0.0
        self.torques = {MOTOR: 0, STIFFNESS: 0}
        self.words = {MOTOR: 0, STIFFNESS: 0}
        self.heartbeats = False

    def send(self, can_id: int, data: bytes = b"") -> None:
        self.emulator.receive(can_id, data, self.now)
        self.emulator.turn(self.now)

    def taken(self, can_id: int) -> list[bytes]:
        """The frames of an identifier so far; they are not shown again."""
        found = [data for number, data in self.frames if number == can_id]
        self.frames = [frame for frame in self.frames if frame[0] != can_id]
        return found

    def read(self, node: int, index: int, sub: int = 0, signed: bool = False) -> int:
        self.taken(0x580 + node)
        self.send(0x600 + node, struct.pack("<BHB4x", 0x40, index, sub))
        (reply,) = self.taken(0x580 + node)
        assert reply[0] & 0xE3 == 0x43, reply.hex()
        return int.from_bytes(reply[4 : 8 - (reply[0] >> 2 & 3)], "little", signed=signed)

    def write(self, node: int, index: int, sub: int, value: int, size: int) -> int:
        """Write an object; return 0 or the abort code."""
        self.taken(0x580 + node)
        self.send(0x600 + node, struct.pack("<BHBI", SIZES[size], index, sub, value & 0xFFFFFFFF))
        (reply,) = self.taken(0x580 + node)
        return 0 if reply[0] == 0x60 else int(struct.unpack("<I", reply[4:])[0])

    def nmt(self, command: int, node: int = 0) -> None:
        self.send(0, bytes([command, node]))

    def cycle(self, period_s: float = 0.002) -> None:
        """One cycle: RPDOs, heartbeat, SYNC."""
        self.now += period_s
        if self.heartbeats:
            self.send(0x700 + HOST, b"\x05")
        for node in (MOTOR, STIFFNESS):
            self.send(0x200 + node, struct.pack("<Hh", self.words[node], self.torques[node]))
        self.send(0x80)

    def wait(self, time_s: float) -> None:
        """Let time pass without a host."""
        end = self.now + time_s
        while self.now < end:
            self.now = min(end, max(self.now, self.emulator.next_turn()))
            self.emulator.turn(self.now)
        self.emulator.advance(self.now)

    def command(self, word: int, *nodes: int) -> None:
        """Send a controlword with one cycle."""
        for node in nodes or (MOTOR, STIFFNESS):
            self.words[node] = word
        self.cycle()

    def enabled(self, torque: int = 0) -> "Bench":
        """Both drives in operation, in cyclic torque mode."""
        for node in (MOTOR, STIFFNESS):
            assert self.write(node, 0x6060, 0, 10, 1) == 0
        self.nmt(1)
        for word in (SHUTDOWN, SWITCH_ON, ENABLE):
            self.command(word)
        self.torques[MOTOR] = torque
        return self

    def run(self, time_s: float) -> None:
        """Cycles for some time."""
        for _ in range(round(time_s / 0.002)):
            self.cycle()

    def state(self, node: int = MOTOR) -> str:
        """The drive's state by the statusword that it answers over SDO."""
        word = self.read(node, 0x6041) & MASK
        found = [words for words, bits in WORDS.items() if bits == (word if bits & 0x20 or bits == 7 else word & 0x4F)]
        (state,) = found
        return state

    def emergencies(self, node: int = MOTOR) -> list[int]:
        """The error codes of a node's emergency objects so far."""
        return [struct.unpack_from("<H", data)[0] for data in self.taken(0x80 + node)]
