"""Process data objects of an emulated node: mapping as it is written, synchronous and event-driven, with deadlines."""

import math
import struct
from collections.abc import Callable
from typing import TYPE_CHECKING

from canopen.sdo.exceptions import SdoAbortedError

from backend.emulator.objects import BITS, CODES, DUMMIES, ENTRIES, UNUSED

if TYPE_CHECKING:
    from backend.emulator.node import EmulatedNode

SYNCHRONOUS = 240  # transmission types up to here follow SYNC
EVENT_DRIVEN = (254, 255)
LENGTH_WRONG, LENGTH_LONG, OVERDUE = 0x8210, 0x8220, 0x8250
"""Emergencies of receive PDOs: too short and not processed, too long, and none in time."""
NOT_NOW, NOT_MAPPABLE, TOO_LONG, NOT_A_VALUE = 0x08000022, 0x06040041, 0x06040042, 0x06090030
"""Abort codes of CiA 301."""


def check_pdo_write(node: "EmulatedNode", index: int, sub: int, value: int) -> None:
    """Refuse what CiA 301 does not let be written to a PDO's objects. Raises SdoAbortedError."""
    mapping, communication = (index & 0xFE00) in (0x1600, 0x1A00), index & ~0x0200
    exists = not node.value(communication if mapping else index, 1) & UNUSED
    if not mapping:
        if sub == 1 and exists and not value & UNUSED and (value ^ node.value(index, 1)) & 0x7FF:
            raise SdoAbortedError(NOT_NOW)
        if sub == 2 and not (value <= SYNCHRONOUS or value in EVENT_DRIVEN):
            raise SdoAbortedError(NOT_A_VALUE)
        return
    if exists:
        raise SdoAbortedError(NOT_NOW)
    receives = index < 0x1A00
    if sub == 0:
        if value > ENTRIES:
            raise SdoAbortedError(TOO_LONG)
        lengths = [_mapped(node, node.value(index, entry), receives)[2] for entry in range(1, value + 1)]
        if sum(lengths) > 64:
            raise SdoAbortedError(TOO_LONG)
    elif node.value(index, 0) != 0:
        raise SdoAbortedError(NOT_NOW)
    else:
        _mapped(node, value, receives)


def _mapped(node: "EmulatedNode", value: int, receives: bool) -> tuple[int, int, int, int]:
    """Return index, subindex, length in bits and data type of a mapping entry. Raises SdoAbortedError."""
    index, sub, bits = value >> 16, (value >> 8) & 0xFF, value & 0xFF
    if receives and index in DUMMIES:
        kind, fits = DUMMIES[index], True
    else:
        entry = node.entries.get((index, sub))
        if entry is None:
            raise SdoAbortedError(0x06020000)
        kind, fits = entry.kind, entry.mappable and ("w" if receives else "r") in entry.access
    if not fits or bits != BITS.get(kind):
        raise SdoAbortedError(NOT_MAPPABLE)
    return index, sub, bits, kind


class _Pdo:
    def __init__(self, node: "EmulatedNode", number: int, first_index: int) -> None:
        self.node, self.communication, self.mapping = node, first_index + number, first_index + 0x200 + number
        self.cob_id = 0
        self.exists = False
        self.kind = 0
        self.timer_s = 0.0
        self.objects: tuple[tuple[int, int], ...] = ()
        self.layout = struct.Struct("<")
        self._due = 0.0  # of a deadline or an event timer; 0 = none runs

    def deadline(self) -> float:
        """Return when the node has to look at it."""
        return self._due or math.inf

    def configure(self) -> None:
        """Take over what the node's dictionary says."""
        value = self.node.value
        mapped = [
            _mapped(self.node, value(self.mapping, entry), self.mapping < 0x1A00)
            for entry in range(1, value(self.mapping, 0) + 1)
        ]
        self.objects = tuple((index, sub) for index, sub, _, _ in mapped)
        self.layout = struct.Struct("<" + "".join(CODES[kind] for *_, kind in mapped))
        cob_id = value(self.communication, 1)
        self.exists, self.cob_id = not cob_id & UNUSED and bool(mapped), cob_id & 0x7FF
        self.kind, self.timer_s = value(self.communication, 2), 1e-3 * value(self.communication, 5)


class ReceivePdo(_Pdo):
    """What a host sends: kept until SYNC where it is synchronous, with a deadline from one to the next if there is one."""

    def __init__(self, node: "EmulatedNode", number: int) -> None:
        super().__init__(node, number, 0x1400)
        self._pending: tuple[int, ...] | None = None
        self._complaint = 0  # what was last wrong, told once
        self._missed = False
        self._subscribed = 0

    def configure(self) -> None:
        """Take over what the node's dictionary says, and listen."""
        super().configure()
        network = self.node.network
        if self._subscribed:
            network.unsubscribe(self._subscribed, self.receive)
        self._subscribed = self.cob_id if self.exists else 0
        if self.exists:
            network.subscribe(self.cob_id, self.receive)
        self.forget()

    def forget(self) -> None:
        """Drop what has not been taken over, and the deadline."""
        self._pending, self._due, self._complaint, self._missed = None, 0.0, 0, False

    def receive(self, _can_id: int, data: bytearray, _timestamp: float) -> None:
        """Take a frame."""
        if not self.node.is_operational:
            return
        wrong = LENGTH_WRONG if len(data) < self.layout.size else LENGTH_LONG if len(data) > self.layout.size else 0
        if wrong and wrong != self._complaint:
            self.node.emergency(wrong, register=0x10)
        self._complaint = wrong
        if wrong == LENGTH_WRONG:
            return
        if self._missed:
            self._missed = False
            self.node.recovered()
        if self.timer_s:
            self._due = self.node.now + self.timer_s
        values = self.layout.unpack_from(data)
        if self.kind <= SYNCHRONOUS:
            self._pending = values
        else:
            self.node.take(self.objects, values)

    def sync(self) -> None:
        """Take over what came since the last SYNC."""
        if self._pending is not None:
            values, self._pending = self._pending, None
            self.node.take(self.objects, values)

    def overdue(self) -> bool:
        """Return once whether the deadline has passed."""
        if not self._due or self.node.now < self._due:
            return False
        self._due, self._missed = 0.0, True
        return True


class TransmitPdo(_Pdo):
    """What a node sends: with every n-th SYNC, or by its event timer."""

    def __init__(self, node: "EmulatedNode", number: int) -> None:
        super().__init__(node, number, 0x1800)
        self._syncs = 0

    def configure(self) -> None:
        """Take over what the node's dictionary says."""
        super().configure()
        self._syncs, self._due = 0, 0.0

    def sync(self) -> None:
        """Send if it is this SYNC's turn."""
        if not self.exists or not 1 <= self.kind <= SYNCHRONOUS:
            return
        self._syncs += 1
        if self._syncs >= self.kind:
            self._syncs = 0
            self._send()

    def deadline(self) -> float:
        """Return when the event timer runs out."""
        runs = self.exists and self.kind in EVENT_DRIVEN and self.timer_s
        return self._due if runs else math.inf

    def event(self, latch: Callable[[], None]) -> None:
        """Send if the event timer has run out, with values of now."""
        if not self.exists or self.kind not in EVENT_DRIVEN or not self.timer_s or self.node.now < self._due:
            return
        self._due = self.node.now + self.timer_s
        latch()
        self._send()

    def _send(self) -> None:
        values = self.node.values
        self.node.network.send_message(self.cob_id, self.layout.pack(*[values[key] for key in self.objects]))
