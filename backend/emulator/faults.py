"""Faults on command: each does to cable, node or plant what the real one would. `clear` takes all of them back."""

from collections.abc import Callable
from typing import Any

from backend.emulator.drive import EmulatedDrive
from backend.emulator.emulator import Emulator
from backend.emulator.plant import LINK, MOTOR, STIFFNESS

BUS_OFF_FLAG = 0x40  # CAN_ERR_BUSOFF
OVER_CURRENT, OVER_TEMPERATURE = 0x2310, 0x4310
SendError = Callable[[int], None]
REGISTER = {0x2: 0x02, 0x3: 0x04, 0x4: 0x08, 0x8: 0x10, 0xF: 0x80}
"""Bits of the error register by the first digit of an error code."""
FAULTS = {
    "frames_dropped": "share of all frames that get lost (0.05)",
    "frames_delayed": "ms by which every answer is late (3)",
    "frames_corrupted": "share of all frames that come with a wrong length or a flipped bit (0.05)",
    "encoder_frozen": "an encoder, of the node (3), shows what it shows now",
    "encoder_jump": "rad by which an encoder, of the node (3), shows more from now on (0.5)",
    "drive_fault": "a drive, of the node (1), has an error with this code (0x2310)",
    "over_temperature": "a drive, of the node (1), is too hot: error 0x4310",
    "bus_off": "the CAN controller goes off the bus: an error frame, then silence both ways",
    "link_lost": "silence both ways",
    "node_reboot": "a node (1) restarts and has lost its configuration",
    "torque_saturated": "share of its peak torque that a drive, of the node (1), gives at most (0.05)",
    "wrong_inertia": "factor on the inertia of the link, or of the motor with node 1 (3)",
    "end_stop": "N·m that push the stiffness motor towards its soft end stop, or the stiff one if negative (1)",
}
"""Every fault and what its value means, with the value or node that is taken if none is given."""


class RefusedRequest(ValueError):
    """A fault that is not there, or a value it cannot take; the text says what is expected."""


class Faults:
    """What can be done to an emulator."""

    def __init__(self, emulator: Emulator, send_error: SendError) -> None:
        self._emulator, self._send_error = emulator, send_error
        self.standing: list[str] = []

    def set(self, name: str, value: float | None = None, node: int | None = None) -> None:
        """Set a fault. Raises RefusedRequest."""
        if name not in FAULTS:
            raise RefusedRequest(f"there is no fault {name!r}; expected one of {', '.join(FAULTS)}")
        getattr(self, f"_{name}")(value, node)
        self._emulator.plant.mark()
        if name not in self.standing:
            self.standing.append(name)

    def clear(self) -> None:
        """Take all faults back. What they have left behind stays: a drive's fault waits for its reset."""
        emulator = self._emulator
        emulator.wire.mend()
        emulator.plant.link_factor = emulator.plant.motor_factor = 1.0
        emulator.plant.reform()
        emulator.plant.push(0.0)
        emulator.link.encoder.mend()
        for drive in emulator.drives:
            drive.encoder.mend()
            drive.cause = None
            drive.share = 1.0
            drive.limit()
        self.standing.clear()

    def _drive(self, node: int | None) -> EmulatedDrive:
        for drive in self._emulator.drives:
            if drive.number == (node or 1):
                return drive
        raise RefusedRequest(f"node {node} is no drive; expected 1 (motor) or 2 (stiffness)")

    def _axis(self, node: int | None) -> tuple[int, Any]:
        number = 3 if node is None else node
        for axis, emulated in ((MOTOR, self._emulator.motor), (STIFFNESS, self._emulator.stiffness)):
            if emulated.number == number:
                return axis, emulated.encoder
        if number != self._emulator.link.number:
            raise RefusedRequest(f"node {node} is not there; expected 1 (motor), 2 (stiffness) or 3 (link)")
        return LINK, self._emulator.link.encoder

    def _frames_dropped(self, value: float | None, _node: int | None) -> None:
        self._emulator.wire.dropped = _share(value, 0.05)

    def _frames_delayed(self, value: float | None, _node: int | None) -> None:
        self._emulator.wire.delay_s = 1e-3 * _within(value, 3.0, 0.0, 1000.0, "ms")

    def _frames_corrupted(self, value: float | None, _node: int | None) -> None:
        self._emulator.wire.corrupted = _share(value, 0.05)

    def _encoder_frozen(self, _value: float | None, node: int | None) -> None:
        axis, encoder = self._axis(node)
        encoder.freeze(self._emulator.plant.position(axis))

    def _encoder_jump(self, value: float | None, node: int | None) -> None:
        _, encoder = self._axis(node)
        encoder.jump = _within(value, 0.5, -1000.0, 1000.0, "rad")

    def _drive_fault(self, value: float | None, node: int | None) -> None:
        code = int(_within(value, OVER_CURRENT, 0x1000, 0xFFFF, "as an error code"))
        self._fail(self._drive(node), code)

    def _over_temperature(self, _value: float | None, node: int | None) -> None:
        self._fail(self._drive(node), OVER_TEMPERATURE)

    def _fail(self, drive: EmulatedDrive, code: int) -> None:
        drive.cause = code, REGISTER.get(code >> 12, 0)
        drive.fail(*drive.cause)

    def _bus_off(self, _value: float | None, _node: int | None) -> None:
        self._send_error(BUS_OFF_FLAG)
        self._emulator.wire.cut = True

    def _link_lost(self, _value: float | None, _node: int | None) -> None:
        self._emulator.wire.cut = True

    def _node_reboot(self, _value: float | None, node: int | None) -> None:
        number = 1 if node is None else node
        for emulated in self._emulator.nodes:
            if emulated.number == number:
                emulated.restart()
                return
        raise RefusedRequest(f"node {node} is not there; expected 1, 2 or 3")

    def _torque_saturated(self, value: float | None, node: int | None) -> None:
        drive = self._drive(node)
        drive.share = _share(value, 0.05)
        drive.limit()

    def _wrong_inertia(self, value: float | None, node: int | None) -> None:
        factor, plant = _within(value, 3.0, 0.05, 50.0, "as a factor"), self._emulator.plant
        if node not in (None, 1, 3):
            raise RefusedRequest(f"node {node} has no inertia to change; expected 1 (motor) or 3 (link)")
        if node == 1:
            plant.motor_factor = factor
        else:
            plant.link_factor = factor
        plant.reform()

    def _end_stop(self, value: float | None, _node: int | None) -> None:
        self._emulator.plant.push(_within(value, 1.0, -20.0, 20.0, "N·m"))


def _share(value: float | None, usual: float) -> float:
    return _within(value, usual, 0.0, 1.0, "as a share")


def load(emulator: Emulator, torque: float | None) -> None:
    """Load the link with a torque [N m] that stays; nothing is wrong with that. Raises RefusedRequest."""
    emulator.plant.load(_within(torque, 0.0, -100.0, 100.0, "N·m"))


def _within(value: float | None, usual: float, low: float, high: float, unit: str) -> float:
    number = usual if value is None else value
    if not low <= number <= high:  # not a number is refused too
        raise RefusedRequest(f"{number:g} {unit} cannot be; expected {low:g} to {high:g}")
    return number
