"""Object dictionaries in code: one line an object, and from it what canopen serves over SDO."""

from collections.abc import Iterable
from dataclasses import dataclass

from canopen import objectdictionary as od

U8, U16, U32 = od.UNSIGNED8, od.UNSIGNED16, od.UNSIGNED32
I8, I16, I32 = od.INTEGER8, od.INTEGER16, od.INTEGER32
TEXT = od.VISIBLE_STRING
CODES = {U8: "B", U16: "H", U32: "I", I8: "b", I16: "h", I32: "i"}
"""How struct packs each type, little endian."""
BITS = {U8: 8, U16: 16, U32: 32, I8: 8, I16: 16, I32: 32}
PDOS = 4  # receive and transmit PDOs of a node
ENTRIES = 8  # objects that a PDO can hold
UNUSED = 0x80000000  # bit 31 of a COB-ID: the PDO does not exist
DUMMIES = {0x0002: I8, 0x0003: I16, 0x0004: I32, 0x0005: U8, 0x0006: U16, 0x0007: U32}
"""Data types that fill a receive PDO where nothing is meant."""


@dataclass(frozen=True)
class Entry:
    """One object: where, what, how it may be used, and the only values it takes where not all are meant."""

    index: int
    sub: int
    name: str
    kind: int
    access: str = "rw"
    default: int | str = 0
    mappable: bool = False
    allowed: tuple[int, ...] = ()


def dictionary(entries: Iterable[Entry]) -> od.ObjectDictionary:
    """Return the object dictionary of `entries`; an index with more than subindex 0 is a record."""
    objects = od.ObjectDictionary()
    grouped: dict[int, list[Entry]] = {}
    for entry in entries:
        grouped.setdefault(entry.index, []).append(entry)
    for index, members in sorted(grouped.items()):
        variables = [_variable(entry) for entry in members]
        if len(members) == 1 and members[0].sub == 0:
            objects.add_object(variables[0])
            continue
        record = od.ODRecord(f"{members[0].name.rsplit(', ', 1)[0]}, {index:04X}", index)
        for variable in variables:
            record.add_member(variable)
        objects.add_object(record)
    return objects


def _variable(entry: Entry) -> od.ODVariable:
    variable = od.ODVariable(f"{entry.name}, {entry.index:04X}:{entry.sub}", entry.index, entry.sub)
    variable.data_type, variable.access_type = entry.kind, entry.access
    variable.default, variable.pdo_mappable = entry.default, entry.mappable  # type: ignore[assignment]
    return variable


def communication_objects(
    node: int, device_type: int, name: str, product: int, serial: int, consumers: int = 2
) -> list[Entry]:
    """Return what every CANopen node has, CiA 301, without PDOs."""
    errors = [Entry(0x1003, sub, f"error history, {sub}", U32, "ro") for sub in range(1, 9)]
    heard = [Entry(0x1016, sub, f"consumer heartbeat time, {sub}", U32) for sub in range(1, consumers + 1)]
    return [
        Entry(0x1000, 0, "device type", U32, "ro", device_type),
        Entry(0x1001, 0, "error register", U8, "ro", 0, True),
        Entry(0x1003, 0, "error history, number", U8, "rw", 0, False, (0,)),
        *errors,
        Entry(0x1005, 0, "COB-ID of SYNC", U32, "rw", 0x80, False, (0x80,)),
        Entry(0x1006, 0, "communication cycle period", U32),
        Entry(0x1008, 0, "device name", TEXT, "ro", name),
        Entry(0x1009, 0, "hardware version", TEXT, "ro", "emulated"),
        Entry(0x100A, 0, "software version", TEXT, "ro", "1"),
        Entry(0x1014, 0, "COB-ID of emergency", U32, "rw", 0x80 + node, False, (0x80 + node, UNUSED | (0x80 + node))),
        Entry(0x1016, 0, "consumer heartbeat time, number", U8, "ro", consumers),
        *heard,
        Entry(0x1017, 0, "producer heartbeat time", U16),
        Entry(0x1018, 0, "identity, number", U8, "ro", 4),
        Entry(0x1018, 1, "identity, vendor", U32, "ro", 0x00564541),
        Entry(0x1018, 2, "identity, product", U32, "ro", product),
        Entry(0x1018, 3, "identity, revision", U32, "ro", 0x00010000),
        Entry(0x1018, 4, "identity, serial", U32, "ro", serial),
        Entry(0x1029, 0, "error behaviour, number", U8, "ro", 1),
        Entry(0x1029, 1, "error behaviour, communication", U8, "rw", 0, False, (0, 1, 2)),
    ]


def receive_pdo(number: int, cob_id: int, mapping: tuple[int, ...] = ()) -> list[Entry]:
    """Return communication and mapping objects of a receive PDO (0 = the first)."""
    index = 0x1400 + number
    return [
        Entry(index, 0, "receive PDO, highest subindex", U8, "ro", 5),
        Entry(index, 1, "receive PDO, COB-ID", U32, "rw", cob_id if mapping else UNUSED | cob_id),
        Entry(index, 2, "receive PDO, transmission type", U8, "rw", 1),
        Entry(index, 3, "receive PDO, inhibit time", U16),
        Entry(index, 5, "receive PDO, event timer", U16),
        *_mapping(0x1600 + number, "receive PDO mapping", mapping),
    ]


def transmit_pdo(number: int, cob_id: int, mapping: tuple[int, ...] = ()) -> list[Entry]:
    """Return communication and mapping objects of a transmit PDO (0 = the first)."""
    index = 0x1800 + number
    return [
        Entry(index, 0, "transmit PDO, highest subindex", U8, "ro", 6),
        Entry(index, 1, "transmit PDO, COB-ID", U32, "rw", cob_id if mapping else UNUSED | cob_id),
        Entry(index, 2, "transmit PDO, transmission type", U8, "rw", 1),
        Entry(index, 3, "transmit PDO, inhibit time", U16),
        Entry(index, 5, "transmit PDO, event timer", U16),
        Entry(index, 6, "transmit PDO, SYNC start value", U8, "rw", 0, False, (0,)),
        *_mapping(0x1A00 + number, "transmit PDO mapping", mapping),
    ]


def _mapping(index: int, name: str, mapping: tuple[int, ...]) -> list[Entry]:
    filled = (*mapping, *(0,) * (ENTRIES - len(mapping)))
    return [
        Entry(index, 0, f"{name}, number", U8, "rw", len(mapping)),
        *(Entry(index, sub, f"{name}, {sub}", U32, "rw", value) for sub, value in enumerate(filled, 1)),
    ]
