"""Object dictionaries of the emulated drives (CiA 402) and of the link encoder (CiA 406)."""

from backend.emulator.objects import (
    I8,
    I16,
    I32,
    PDOS,
    U8,
    U16,
    U32,
    Entry,
    communication_objects,
    receive_pdo,
    transmit_pdo,
)

CYCLIC_TORQUE = 10
DRIVE_NAME, ENCODER_NAME = "VSSEA emulated drive", "VSSEA emulated encoder"
SERVO_DRIVE, ROTARY_ENCODER = 0x00020192, 0x00010196
COUNTS_PER_TURN, LINK_COUNTS = 16384, 131072
CONTROLWORD, TARGET_TORQUE = 0x6040_0010, 0x6071_0010
STATUSWORD, POSITION, TORQUE_ACTUAL, LINK_POSITION = 0x6041_0010, 0x6064_0020, 0x6077_0010, 0x6004_0020


def drive_objects(
    node: int, which: str, rated_torque: int, rated_current: int, max_torque: int, deceleration: int, ratio: int
) -> list[Entry]:
    """Return the objects of a drive.

    Rated torque [uN m] and current [mA] of its motor, its greatest torque [per thousand of rated], its quick stop's
    deceleration [counts/s^2], and the ratio of its gear.
    """
    pdos = receive_pdo(0, 0x200 + node, (CONTROLWORD, TARGET_TORQUE))
    pdos += transmit_pdo(0, 0x180 + node, (STATUSWORD, POSITION, TORQUE_ACTUAL))
    for pdo in range(1, PDOS):
        pdos += receive_pdo(pdo, 0x200 + 0x100 * pdo + node)
        pdos += transmit_pdo(pdo, 0x180 + 0x100 * pdo + node)
    return [
        *communication_objects(node, SERVO_DRIVE, f"{DRIVE_NAME} ({which})", product=402, serial=1000 + node),
        *pdos,
        Entry(0x6007, 0, "abort connection option code", I16, "rw", 1, False, (0, 1, 2, 3)),
        Entry(0x603F, 0, "error code", U16, "ro", 0, True),
        Entry(0x6040, 0, "controlword", U16, "rw", 0, True),
        Entry(0x6041, 0, "statusword", U16, "ro", 0, True),
        Entry(0x605A, 0, "quick stop option code", I16, "rw", 2, False, (0, 1, 2, 5, 6)),
        Entry(0x605B, 0, "shutdown option code", I16, "rw", 0, False, (0, 1)),
        Entry(0x605C, 0, "disable operation option code", I16, "rw", 1, False, (0, 1)),
        Entry(0x605D, 0, "halt option code", I16, "rw", 1, False, (1, 2)),
        Entry(0x605E, 0, "fault reaction option code", I16, "rw", 2, False, (0, 1, 2)),
        Entry(0x6060, 0, "modes of operation", I8, "rw", 0, True, (0, CYCLIC_TORQUE)),
        Entry(0x6061, 0, "modes of operation display", I8, "ro", 0, True),
        Entry(0x6064, 0, "position actual value", I32, "ro", 0, True),
        Entry(0x606C, 0, "velocity actual value", I32, "ro", 0, True),
        Entry(0x6071, 0, "target torque", I16, "rw", 0, True),
        Entry(0x6072, 0, "max torque", U16, "rw", max_torque, True),
        Entry(0x6074, 0, "torque demand", I16, "ro", 0, True),
        Entry(0x6075, 0, "motor rated current", U32, "ro", rated_current),
        Entry(0x6076, 0, "motor rated torque", U32, "ro", rated_torque),
        Entry(0x6077, 0, "torque actual value", I16, "ro", 0, True),
        Entry(0x6078, 0, "current actual value", I16, "ro", 0, True),
        Entry(0x6079, 0, "DC link circuit voltage", U32, "ro", 24_000, True),
        Entry(0x6084, 0, "profile deceleration", U32, "rw", deceleration // 2),
        Entry(0x6085, 0, "quick stop deceleration", U32, "rw", deceleration),
        Entry(0x608F, 0, "position encoder resolution, number", U8, "ro", 2),
        Entry(0x608F, 1, "position encoder resolution, increments", U32, "ro", COUNTS_PER_TURN),
        Entry(0x608F, 2, "position encoder resolution, turns", U32, "ro", 1),
        Entry(0x6091, 0, "gear ratio, number", U8, "ro", 2),
        Entry(0x6091, 1, "gear ratio, motor turns", U32, "ro", ratio),
        Entry(0x6091, 2, "gear ratio, shaft turns", U32, "ro", 1),
        Entry(0x60B2, 0, "torque offset", I16, "rw", 0, True),
        Entry(0x60C2, 0, "interpolation time period, number", U8, "ro", 2),
        Entry(0x60C2, 1, "interpolation time period, value", U8, "rw", 1),
        Entry(0x60C2, 2, "interpolation time period, index", I8, "rw", -3),
        Entry(0x6502, 0, "supported drive modes", U32, "ro", 1 << (CYCLIC_TORQUE - 1)),
    ]


def encoder_objects(node: int) -> list[Entry]:
    """Return the objects of the link encoder; positions below zero are two's complement."""
    pdos = transmit_pdo(0, 0x180 + node, (LINK_POSITION,))
    for pdo in range(1, PDOS):
        pdos += transmit_pdo(pdo, 0x180 + 0x100 * pdo + node)
    return [
        *communication_objects(node, ROTARY_ENCODER, ENCODER_NAME, product=406, serial=1000 + node),
        *pdos,
        Entry(0x6000, 0, "operating parameters", U16, "rw", 0),
        Entry(0x6001, 0, "measuring units per revolution", U32, "ro", LINK_COUNTS),
        Entry(0x6002, 0, "total measuring range", U32, "ro", 0xFFFFFFFF),
        Entry(0x6004, 0, "position value", U32, "ro", 0, True),
        Entry(0x6500, 0, "operating status", U16, "ro", 0),
        Entry(0x6501, 0, "single-turn resolution", U32, "ro", LINK_COUNTS),
        Entry(0x6502, 0, "number of distinguishable revolutions", U16, "ro", 32768),
        Entry(0x6503, 0, "alarms", U16, "ro", 0, True),
    ]
