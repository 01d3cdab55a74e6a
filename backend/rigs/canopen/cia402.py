"""The state machine of CiA 402 as one pure function: status word, goal and previous control word -> control word and state.

It never arms again by itself: a fault, or a drive that left operation on its own, ends the wish to be enabled, and only
a new goal renews it. A fault is reset by one rising edge of bit 7, on request.
"""

from enum import StrEnum
from typing import NamedTuple

from backend.rigs.rig import AxisState


class DriveState(StrEnum):
    """The states of a drive, in CiA 402's words."""

    NOT_READY = "not ready to switch on"
    SWITCH_ON_DISABLED = "switch on disabled"
    READY = "ready to switch on"
    SWITCHED_ON = "switched on"
    OPERATION_ENABLED = "operation enabled"
    QUICK_STOP = "quick stop active"
    FAULT_REACTION = "fault reaction active"
    FAULT = "fault"
    UNKNOWN = "no state of CiA 402"


class Goal(StrEnum):
    """Where a drive is to go."""

    DISABLED = "disabled"
    ENABLED = "enabled"
    KEPT = "kept enabled"  # it was in operation; should it leave by itself, that is the end
    STOPPED = "stopped"  # by its own quick stop
    RESET = "reset"  # out of its fault, once


DISABLE_VOLTAGE, SHUTDOWN, SWITCH_ON, ENABLE, QUICK_STOP, FAULT_RESET = 0x00, 0x06, 0x07, 0x0F, 0x02, 0x80
"""Control words, object 0x6040."""


class Step(NamedTuple):
    """What to send next, where the drive is, and the goal from now on."""

    control_word: int
    drive: DriveState
    state: AxisState
    goal: Goal


def drive_state(status_word: int) -> DriveState:
    """Return the state that a status word (0x6041) says; bits 4 and 7 and above are no part of it."""
    return _STATES[status_word & 0x6F]


def _decoded(bits: int) -> DriveState:
    if bits & 0x4F in _WITHOUT_QUICK_STOP_BIT:
        return _WITHOUT_QUICK_STOP_BIT[bits & 0x4F]
    return _WITH_QUICK_STOP_BIT.get(bits & 0x6F, DriveState.UNKNOWN)


_WITHOUT_QUICK_STOP_BIT = {
    0x00: DriveState.NOT_READY,
    0x40: DriveState.SWITCH_ON_DISABLED,
    0x0F: DriveState.FAULT_REACTION,
    0x08: DriveState.FAULT,
}
_WITH_QUICK_STOP_BIT = {
    0x21: DriveState.READY,
    0x23: DriveState.SWITCHED_ON,
    0x27: DriveState.OPERATION_ENABLED,
    0x07: DriveState.QUICK_STOP,
}
_STATES = tuple(_decoded(bits) for bits in range(0x70))

_TO_ENABLE = {
    DriveState.SWITCH_ON_DISABLED: SHUTDOWN,
    DriveState.READY: SWITCH_ON,
    DriveState.SWITCHED_ON: ENABLE,
    DriveState.OPERATION_ENABLED: ENABLE,
    # Straight back to operation: by way of "switch on disabled" an axis that holds would let go first.
    DriveState.QUICK_STOP: ENABLE,
}
_IN_FAULT = (DriveState.FAULT, DriveState.FAULT_REACTION)


def step(status_word: int, goal: Goal, previous: int) -> Step:
    """Return the next control word; `previous` is the one before it.

    The goal that comes back is the one to go on with: KEPT once ENABLED is reached, and DISABLED (STOPPED, where the drive
    holds by its own quick stop) once the drive has left operation by itself.
    """
    drive = drive_state(status_word)
    if drive in _IN_FAULT:
        return _faulted(drive, goal, previous)
    if goal is Goal.RESET:
        goal = Goal.DISABLED
    elif goal is Goal.ENABLED and drive is DriveState.OPERATION_ENABLED:
        goal = Goal.KEPT
    elif goal is Goal.KEPT and drive is not DriveState.OPERATION_ENABLED:
        goal = Goal.STOPPED if drive is DriveState.QUICK_STOP else Goal.DISABLED
    if goal in (Goal.ENABLED, Goal.KEPT):
        word = _TO_ENABLE.get(drive, DISABLE_VOLTAGE)
    elif goal is Goal.STOPPED:
        word = QUICK_STOP
    else:
        word = DISABLE_VOLTAGE
    return Step(word, drive, _axis_state(drive, goal), goal)


def _faulted(drive: DriveState, goal: Goal, previous: int) -> Step:
    if goal is Goal.RESET and drive is DriveState.FAULT:
        if previous & FAULT_RESET:  # an edge needs the bit low first
            return Step(DISABLE_VOLTAGE, drive, "fault", Goal.RESET)
        return Step(FAULT_RESET, drive, "fault", Goal.DISABLED)
    return Step(DISABLE_VOLTAGE, drive, "fault", Goal.DISABLED)


def _axis_state(drive: DriveState, goal: Goal) -> AxisState:
    if drive is DriveState.OPERATION_ENABLED:
        return "enabled" if goal is Goal.KEPT else "stopping"
    if drive is DriveState.QUICK_STOP:
        return "enabling" if goal is Goal.ENABLED else "stopping"
    if drive in (DriveState.UNKNOWN, DriveState.NOT_READY):
        return "unknown"
    return "enabling" if goal is Goal.ENABLED else "disabled"
