"""The rig over a real socket to a running emulator."""

from collections.abc import Callable

from backend.rigs.canopen import CanopenRig
from backend.rigs.rig import AXES, Measured
from backend.rigs.rig_file import RigFile
from tests.hardware.fake_rig import changed

TORQUE = 12.0
"""N m at the gear side: more than the emulated friction."""
MOST_CYCLES = 5000


def rig_file_at(port: int) -> RigFile:
    """At the lowest rate, whose deadlines a computer with much else to do keeps."""
    return changed(rate_hz=200, bus={"options": {"host": "127.0.0.1", "port": port}})


def turns(rig: CanopenRig, until: Callable[[Measured], bool], motor: float = 0.0, stiffness: float = 0.0) -> Measured:
    """Exchange, each cycle as soon as the one before it is answered, until something is measured."""
    for _ in range(MOST_CYCLES):
        measured = rig.exchange(motor, stiffness)
        if until(measured):
            return measured
    raise TimeoutError(f"not within {MOST_CYCLES} cycles")


def pushed(rig: CanopenRig, until: Callable[[Measured], bool], motor: float = 0.0, stiffness: float = 0.0) -> Measured:
    """As `turns`, arming again where this computer stood still for so long that a drive stopped by itself."""

    def look(measured: Measured) -> bool:
        for axis in AXES:
            if rig.axis(axis).state in ("disabled", "stopping"):
                rig.arm(axis)
        return until(measured)

    return turns(rig, look, motor, stiffness)


def arm_both(rig: CanopenRig) -> None:
    turns(rig, lambda m: max(m.motor_age, m.stiffness_age) == 0)
    pushed(rig, lambda _: all(rig.axis(axis).state == "enabled" for axis in AXES))
    rig.bus_faults()
