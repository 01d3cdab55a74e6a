"""One drive in the cycle: the command that goes out, the two answers that come back, and the axis they make."""

import struct

import can

from backend.rigs.canopen.answer import Answer
from backend.rigs.canopen.cia402 import (
    DISABLE_VOLTAGE,
    ENABLE,
    DriveState,
    Goal,
    drive_state,
    step,
)
from backend.rigs.canopen.emergency import error_words
from backend.rigs.canopen.nodes import Node
from backend.rigs.canopen.objects import Pdo
from backend.rigs.canopen.scaling import MotorPosition, TorqueScale
from backend.rigs.rig import Axis, AxisStatus

SILENT_CYCLES = 10
"""From this age on nobody knows where a drive is."""
MOST_TORQUE = 10_000  # thousandths of the rated torque; more is no torque but another object
_COMMAND = struct.Struct("<Hh")
_HOLDING = (DriveState.QUICK_STOP, DriveState.OPERATION_ENABLED)


def is_status(content: tuple[int, ...]) -> bool:
    """Return whether the status word is one of CiA 402."""
    return drive_state(content[0]) is not DriveState.UNKNOWN


def is_torque(content: tuple[int, ...]) -> bool:
    """Return whether a torque can be one."""
    return -MOST_TORQUE <= content[0] <= MOST_TORQUE


class DriveChannel:
    """A configured drive, `found` with that status word; torque [N m] and position [rad] at the gear side.

    A drive that was found holding by its quick stop goes on with it until it is told otherwise.
    """

    def __init__(
        self, axis: Axis, node: Node, found: int, command: Pdo, answers: tuple[Answer, Answer], scale: TorqueScale,
        position: MotorPosition,
    ) -> None:  # fmt: skip
        self.axis = axis
        self.node = node
        self.answer, self.torque_answer = answers
        self.message = can.Message(arbitration_id=command.can_id, is_extended_id=False, data=bytearray(command.size))
        self.goal = Goal.STOPPED if drive_state(found) in _HOLDING else Goal.DISABLED
        self.torque = 0.0
        """What the drive really took over last."""
        self._units = 0
        self.position = 0.0
        self.torque_seen = 0.0
        self._scale, self._counter = scale, position
        self._control_word = DISABLE_VOLTAGE
        self._status_word = found

    @property
    def age(self) -> int:
        """Cycles since the drive was last heard whole."""
        age = self.answer.age
        return age if self.torque_answer.age < SILENT_CYCLES else max(age, self.torque_answer.age)

    def command(self, torque: float) -> None:
        """Write control word and torque into the message; no torque but in operation."""
        if self.answer.content is not None:
            self._status_word = self.answer.content[0]
        word, drive, _, self.goal = step(self._status_word, self.goal, self._control_word)
        is_enabled = word == ENABLE and drive is DriveState.OPERATION_ENABLED
        units = self._scale.units(torque) if is_enabled else 0
        self._control_word = word
        self._units = units
        _COMMAND.pack_into(self.message.data, 0, word, units)

    def settle(self, taken: bool) -> None:
        """Take over what this cycle brought; `taken` says whether the drive has the command."""
        if taken:
            self.torque = self._scale.torque(self._units)
        if self.answer.age == 0 and self.answer.content is not None:
            self.position = self._counter.take(self.answer.content[1])
        if self.torque_answer.age == 0 and self.torque_answer.content is not None:
            self.torque_seen = self._scale.torque(self.torque_answer.content[0])

    def status(self) -> AxisStatus:
        """Return where the drive is, in words."""
        content, code = self.answer.content, self.node.error_code
        word = content[0] if content is not None else 0
        if content is None or self.answer.age >= SILENT_CYCLES:
            return AxisStatus(self.axis, "unknown", "no answer", word, code, error_words(code))
        _, drive, state, _ = step(word, self.goal, self._control_word)
        return AxisStatus(self.axis, state, str(drive), word, code, error_words(code))
