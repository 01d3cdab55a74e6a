"""What the error codes of emergency objects and of 0x603F mean, in the ranges of CiA 301 and CiA 402."""

from backend.rigs.faults import HOT, Fault

_EXACT = {
    0x2310: "over-current",
    0x2320: "short circuit or earth leakage at the output",
    0x3210: "over-voltage of the supply",
    0x3220: "under-voltage of the supply",
    0x4210: "over-temperature of the power stage",
    0x4310: "over-temperature of the drive",
    0x5113: "logic supply too low",
    0x5441: "the enable input was taken away",
    0x6100: "internal software error",
    0x7121: "motor blocked",
    0x7305: "incremental encoder 1 fault",
    0x7306: "incremental encoder 2 fault",
    0x8110: "CAN overrun",
    0x8120: "CAN in error passive mode",
    0x8130: "the heartbeat of this computer stayed away",
    0x8140: "recovered from bus-off",
    0x8150: "identifier of another node in use",
    0x8210: "PDO not processed: wrong length",
    0x8220: "PDO too long",
    0x8240: "unexpected length of SYNC",
    0x8250: "torque commands stayed away (RPDO deadline)",
    0x8311: "excess torque",
    0x8400: "velocity control error",
    0x8611: "following error of the drive",
    0x8612: "reference limit",
}
_RANGES = {
    0x10: "generic error",
    0x20: "current",
    0x21: "current at the input",
    0x22: "current inside the drive",
    0x23: "current at the output",
    0x30: "voltage",
    0x31: "voltage of the mains",
    0x32: "voltage inside the drive",
    0x33: "voltage at the output",
    0x40: "temperature",
    0x41: "ambient temperature",
    0x42: "temperature of the drive",
    0x43: "temperature of the drive",
    0x44: "temperature of the motor",
    0x50: "hardware of the device",
    0x60: "software of the device",
    0x70: "additional modules",
    0x71: "motor or brake",
    0x72: "measuring circuit",
    0x73: "sensor",
    0x80: "monitoring",
    0x81: "communication",
    0x82: "protocol error",
    0x83: "torque control",
    0x84: "velocity control",
    0x85: "position control",
    0x86: "positioning",
    0x90: "external error",
    0xF0: "additional functions",
    0xFF: "specific to this device",
}


def error_words(code: int) -> str:
    """Return what an error code says, with its number; "" for none."""
    if code & 0xFF00 == 0:
        return ""
    words = _EXACT.get(code) or _RANGES.get(code >> 8) or _RANGES.get(code >> 8 & 0xF0) or "unknown error"
    return f"0x{code:04X} {words}"


def fault_of(code: int, device: Fault) -> Fault:
    """Return the fault that an error code is: over-temperature, or that of the `device` that sent it."""
    return HOT if code & 0xF000 == 0x4000 else device
