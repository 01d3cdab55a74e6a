"""The last way out of a rig, whatever happened: torques to zero, drives off, bus closed. It uses no law and no state."""

from collections.abc import Callable
from contextlib import suppress

from backend.rigs.rig import AXES, Rig, RigError

RAMP_CYCLES = 25
OFF_CYCLES = 100
OFF = ("disabled", "fault", "unknown")


def leave(
    rig: Rig, motor_torque: float, stiffness_torque: float, wait: Callable[[], object], *, loaded: bool = False
) -> None:
    """Take the torques [N m] last asked for to zero, disable both axes and close the bus; `wait` waits for a cycle.

    The stiffness axis of a `loaded` spring is left to its drive, which goes on holding it.
    """
    try:
        if loaded:
            with suppress(RigError):
                rig.stop("stiffness")
                stiffness_torque = 0.0
        with suppress(RigError):
            if motor_torque != 0.0 or stiffness_torque != 0.0:
                for cycle in range(RAMP_CYCLES - 1, -1, -1):
                    rig.exchange(motor_torque * cycle / RAMP_CYCLES, stiffness_torque * cycle / RAMP_CYCLES)
                    wait()
        for axis in AXES:
            with suppress(RigError):
                if not (loaded and axis == "stiffness"):
                    rig.disarm(axis)
        with suppress(RigError):
            for _ in range(OFF_CYCLES):
                rig.exchange(0.0, 0.0)
                if all(rig.axis(axis).state in (*OFF, *(("stopping",) if loaded else ())) for axis in AXES):
                    break
                wait()
    finally:
        rig.close()
