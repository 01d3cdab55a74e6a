"""The emulated rig as a host meets it: from SYNC to the last answer, through python-can's own socketcand backend."""

import struct
import time
from pathlib import Path

import can

from backend.emulator.start import EmulatorHandle, start_emulator

SECONDS = 10.0
ANSWERS = {0x181, 0x182, 0x183, 0x281, 0x282}
SECOND_PDO = (
    (0x1A01, 0, 0, 1), (0x1A01, 1, 0x606C0020, 4), (0x1A01, 2, 0x60740010, 4), (0x1A01, 0, 2, 1),
)  # fmt: skip


def main() -> None:
    """Print p50, p99 and the greatest time from SYNC to the last of five answers, and the emulator's processor time."""
    emulator = start_emulator()
    try:
        print(f"idle: {100.0 * _idle(emulator):.1f} % of a core")
        for rate_hz in (500, 1000):
            bus = can.Bus(interface="socketcand", channel="can0", host="127.0.0.1", port=emulator.port)
            print(_measured(emulator, bus, rate_hz))
            bus.shutdown()
    finally:
        emulator.close()


def _idle(emulator: EmulatorHandle) -> float:
    began = _processor_s(emulator)
    time.sleep(3.0)
    return (_processor_s(emulator) - began) / 3.0


def _processor_s(emulator: EmulatorHandle) -> float:
    return 1e-9 * int(Path(f"/proc/{emulator.process.pid}/schedstat").read_text().split()[0])


def _send(bus: can.BusABC, can_id: int, data: bytes = b"") -> None:
    bus.send(can.Message(arbitration_id=can_id, data=data, is_extended_id=False))


def _write(bus: can.BusABC, node: int, index: int, sub: int, value: int, size: int) -> None:
    _send(bus, 0x600 + node, struct.pack("<BHBI", {1: 0x2F, 2: 0x2B, 4: 0x23}[size], index, sub, value))
    while (message := bus.recv(5.0)) is not None:
        if message.arbitration_id == 0x580 + node:
            if message.data[0] != 0x60:
                raise SystemExit(f"node {node} refuses {index:#06x}:{sub}: {bytes(message.data).hex()}")
            return
    raise SystemExit(f"node {node} does not answer")


def _configure(bus: can.BusABC) -> None:
    _send(bus, 0, bytes([129, 0]))
    for node in (1, 2):
        _write(bus, node, 0x6060, 0, 10, 1)
        _write(bus, node, 0x1017, 0, 100, 2)
        _write(bus, node, 0x1016, 1, 127 << 16 | 1000, 4)
        _write(bus, node, 0x1801, 1, 0x80000280 + node, 4)
        for entry in SECOND_PDO:
            _write(bus, node, *entry)
        _write(bus, node, 0x1801, 1, 0x280 + node, 4)
    _write(bus, 3, 0x1017, 0, 100, 2)
    _send(bus, 0, bytes([1, 0]))


def _measured(emulator: EmulatorHandle, bus: can.BusABC, rate_hz: int) -> str:
    _configure(bus)
    period_s, count = 1.0 / rate_hz, round(SECONDS * rate_hz)
    taken: list[float] = []
    lost = 0
    began, processor = time.perf_counter(), _processor_s(emulator)
    due = beat = began
    for cycle in range(count):
        due = max(due + period_s, time.perf_counter() - period_s)  # a late cycle is not followed by a burst
        time.sleep(max(0.0, due - time.perf_counter()))
        word, torque = (6, 7, 15)[min(cycle // 20, 2)], 100 if cycle % 200 < 100 else -100
        for node in (1, 2):
            _send(bus, 0x200 + node, struct.pack("<Hh", word, torque))
        if time.perf_counter() >= beat:
            beat = time.perf_counter() + 0.1
            _send(bus, 0x77F, b"\x05")
        while bus.recv(0.0) is not None:
            pass  # late answers of the cycle before
        sent = time.perf_counter()
        _send(bus, 0x80)
        missing = set(ANSWERS)
        while missing and time.perf_counter() < sent + 0.02:
            message = bus.recv(sent + 0.02 - time.perf_counter())
            missing.discard(message.arbitration_id if message else 0)
        lost += bool(missing)
        taken.append(1e6 * (time.perf_counter() - sent))
    share = (_processor_s(emulator) - processor) / (time.perf_counter() - began)
    states = emulator.control({"do": "state"})["states"]
    taken.sort()
    late = sum(time_us > 0.6e6 * period_s for time_us in taken) / count
    return (
        f"{rate_hz} Hz, {SECONDS:g} s: SYNC to the last of {len(ANSWERS)} answers p50 {taken[count // 2]:.0f} us, "
        f"p99 {taken[99 * count // 100]:.0f} us, greatest {taken[-1]:.0f} us; {100.0 * late:.2f} % after 0.6 of a period, "
        f"{lost} lost; emulator {100.0 * share:.1f} % of a core; both drives {' and '.join(set(states.values()))}"
    )


if __name__ == "__main__":
    main()
