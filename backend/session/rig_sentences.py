"""What a session on a rig says of itself: its state with the reason, and what to do."""

from backend.loop.messages import State
from backend.rigs.faults import FAULTS
from backend.session.rig_state import RigState

AT_REST = ("drives off", "the stiffness axis holds")


def rig_sentence(state: State, reason: str | None, time_s: float, by: str | None, rig: RigState) -> str:
    """Return what the rig is doing, and why."""
    motion = rig.motion
    match state:
        case "starting":
            return reason or f"Connecting rig {rig.name}"
        case "connected":
            return "Connected: drives off, not homed. Home the stiffness axis to arm"
        case "homing":
            return "Homing: the stiffness axis looks for its end stops"
        case "ready":
            return "Ready: drives off, homed. Arm to hold the link where it is"
        case "armed":
            return f"Armed: {motion or 'holding'}"
        case "running":
            return f"Running: {motion or 'moving'}"
        case "stopping":
            return f"Stopping: braking{f' ({reason})' if reason else ''}"
        case "stopped":
            return _stopped(reason, time_s, by, motion)
        case "fault":
            return _fault(reason, rig)
        case _:
            return state.capitalize()


def _stopped(reason: str | None, time_s: float, by: str | None, motion: str) -> str:
    if by is not None:
        return f"Stopped by {by} at {time_s:.1f} s{f': {motion}' if motion in AT_REST else ''}. Reset to go on"
    return f"Stopped at {time_s:.1f} s: {reason or 'Reset to go on'}"


def _fault(reason: str | None, rig: RigState) -> str:
    """Return number and sentence: of the first fault that latched, else of the one that the reason tells of."""
    if not rig.lost and rig.fault_sentence() is not None:
        return f"Fault {rig.fault_sentence()}"
    text = reason or "the rig is at fault. Reset when its cause is gone"
    number = next((fault.number for fault in FAULTS if text.startswith(fault.cause)), None)
    return f"Fault: {text}" if number is None else f"Fault {number}: {text}"
