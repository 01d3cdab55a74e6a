"""The objects of CiA 301, 402 and 406 that are used here, and how PDOs are laid out."""

import struct
from dataclasses import dataclass
from typing import NamedTuple

DEVICE_TYPE, DEVICE_NAME, IDENTITY = 0x1000, 0x1008, 0x1018
CONSUMER_HEARTBEAT, PRODUCER_HEARTBEAT, ERROR_BEHAVIOUR = 0x1016, 0x1017, 0x1029
ABORT_CONNECTION, ERROR_CODE = 0x6007, 0x603F
CONTROL_WORD, STATUS_WORD = 0x6040, 0x6041
QUICK_STOP_OPTION, FAULT_REACTION_OPTION = 0x605A, 0x605E
MODE, MODE_DISPLAY, SUPPORTED_MODES = 0x6060, 0x6061, 0x6502
POSITION, TARGET_TORQUE, MAX_TORQUE, RATED_TORQUE, TORQUE = 0x6064, 0x6071, 0x6072, 0x6076, 0x6077
QUICK_STOP_DECELERATION, INTERPOLATION_TIME = 0x6085, 0x60C2

CYCLIC_TORQUE = 10
"""Object 0x6060: cyclic synchronous torque."""
CYCLIC_TORQUE_BIT = 1 << 9
"""Its bit in object 0x6502."""

OWN_NODE = 127
"""The number under which this computer sends its heartbeat."""
SYNC_ID, NMT_ID, HEARTBEAT_ID = 0x080, 0x000, 0x700
OPERATIONAL = 0x05

FORMS = {8: "b", 16: "h", 32: "i"}
"""Letters of struct for a signed entry of so many bits."""


@dataclass(frozen=True)
class Entry:
    """One object in a PDO."""

    index: int
    subindex: int
    bits: int
    letter: str  # of struct

    @property
    def number(self) -> int:
        """The entry as a PDO mapping object says it."""
        return self.index << 16 | self.subindex << 8 | self.bits


class Pdo(NamedTuple):
    """A synchronous PDO of a node: where it is configured, its identifier on the bus, and what is in it."""

    communication: int  # object 0x14xx or 0x18xx
    mapping: int  # object 0x16xx or 0x1Axx
    can_id: int
    entries: tuple[Entry, ...]
    deadline_ms: int = 0  # of an RPDO: the drive stops where none has come for so long; 0 = none

    @property
    def form(self) -> str:
        """The content as struct reads it."""
        return "<" + "".join(entry.letter for entry in self.entries)

    @property
    def size(self) -> int:
        """Bytes of a frame."""
        return struct.calcsize(self.form)


def torque_command(node: int, deadline_ms: int) -> Pdo:
    """Return RPDO 1 of a drive: control word and target torque."""
    entries = Entry(CONTROL_WORD, 0, 16, "H"), Entry(TARGET_TORQUE, 0, 16, "h")
    return Pdo(0x1400, 0x1600, 0x200 + node, entries, deadline_ms)


def drive_state(node: int) -> Pdo:
    """Return TPDO 1 of a drive: status word and position."""
    return Pdo(0x1800, 0x1A00, 0x180 + node, (Entry(STATUS_WORD, 0, 16, "H"), Entry(POSITION, 0, 32, "i")))


def drive_torque(node: int, link: Entry | None) -> Pdo:
    """Return TPDO 2 of a drive: the torque it gives, and the link encoder where that is on this drive."""
    entries = (Entry(TORQUE, 0, 16, "h"), *([link] if link else ()))
    return Pdo(0x1801, 0x1A01, 0x280 + node, entries)


def encoder_position(node: int, link: Entry) -> Pdo:
    """Return TPDO 1 of an encoder node."""
    return Pdo(0x1800, 0x1A00, 0x180 + node, (link,))
