"""The power state machine of CiA 402, pure: state and controlword in, state out. What a drive does on the way is the drive's."""

from enum import Enum
from typing import NamedTuple


class State(Enum):
    """A state, by its words."""

    NOT_READY = "not ready to switch on"
    DISABLED = "switch on disabled"
    READY = "ready to switch on"
    SWITCHED_ON = "switched on"
    ENABLED = "operation enabled"
    QUICK_STOP = "quick stop active"
    REACTION = "fault reaction active"
    FAULT = "fault"


class Command(Enum):
    """What a controlword commands."""

    SHUTDOWN = "shutdown"
    SWITCH_ON = "switch on, or disable operation"
    ENABLE = "enable operation"
    DISABLE_VOLTAGE = "disable voltage"
    QUICK_STOP = "quick stop"


STATUS_BITS = {
    State.NOT_READY: 0x0000,
    State.DISABLED: 0x0040,
    State.READY: 0x0021,
    State.SWITCHED_ON: 0x0023,
    State.ENABLED: 0x0027,
    State.QUICK_STOP: 0x0007,
    State.REACTION: 0x000F,
    State.FAULT: 0x0008,
}
"""Bits 0-3, 5 and 6 of the statusword."""
FAULT_RESET, HALT = 0x0080, 0x0100  # bits of the controlword
VOLTAGE, WARNING, REMOTE, TARGET_REACHED, LIMITED, FOLLOWS = 0x0010, 0x0080, 0x0200, 0x0400, 0x0800, 0x1000
"""Further bits of the statusword: voltage enabled, warning, remote, target reached, internal limit, follows the command."""
POWERED = (State.SWITCHED_ON, State.ENABLED, State.QUICK_STOP)
STAYS = (5, 6)
"""Quick stop option codes that end in quick stop active; with 0, 1 and 2 the drive goes to switch on disabled."""

_TRANSITIONS = {
    (State.DISABLED, Command.SHUTDOWN): State.READY,
    (State.READY, Command.SWITCH_ON): State.SWITCHED_ON,
    (State.READY, Command.ENABLE): State.SWITCHED_ON,  # on the way to operation enabled, one state a controlword
    (State.READY, Command.DISABLE_VOLTAGE): State.DISABLED,
    (State.READY, Command.QUICK_STOP): State.DISABLED,
    (State.SWITCHED_ON, Command.SHUTDOWN): State.READY,
    (State.SWITCHED_ON, Command.ENABLE): State.ENABLED,
    (State.SWITCHED_ON, Command.DISABLE_VOLTAGE): State.DISABLED,
    (State.SWITCHED_ON, Command.QUICK_STOP): State.DISABLED,
    (State.ENABLED, Command.SWITCH_ON): State.SWITCHED_ON,
    (State.ENABLED, Command.SHUTDOWN): State.READY,
    (State.ENABLED, Command.DISABLE_VOLTAGE): State.DISABLED,
    (State.ENABLED, Command.QUICK_STOP): State.QUICK_STOP,
    (State.QUICK_STOP, Command.DISABLE_VOLTAGE): State.DISABLED,
}


class Controlled(NamedTuple):
    """What a controlword leads to."""

    state: State
    resets: bool = False  # the fault was reset


def command_of(controlword: int) -> Command:
    """Return the command in bits 0 to 3 of a controlword."""
    if not controlword & 0x02:
        return Command.DISABLE_VOLTAGE
    if not controlword & 0x04:
        return Command.QUICK_STOP
    if not controlword & 0x01:
        return Command.SHUTDOWN
    return Command.ENABLE if controlword & 0x08 else Command.SWITCH_ON


def controlled(state: State, controlword: int, previous: int, quick_stop_option: int, fault_stands: bool) -> Controlled:
    """Return the state after a `controlword` that follows the `previous` one.

    A fault is left only by a rising edge of bit 7, and only when its cause is gone. Quick stop active is left towards
    operation only where its option code stays in it, and only by a command that was not there before.
    """
    if state is State.FAULT:
        resets = bool(controlword & FAULT_RESET & ~previous) and not fault_stands
        return Controlled(State.DISABLED if resets else State.FAULT, resets)
    command = command_of(controlword)
    if state is State.QUICK_STOP and command is Command.ENABLE:
        again = quick_stop_option in STAYS and command_of(previous) is not Command.ENABLE
        return Controlled(State.ENABLED if again else state)
    return Controlled(_TRANSITIONS.get((state, command), state))
