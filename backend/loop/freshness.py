"""How old measurements may be: one missed cycle is bridged, three stop the rig, ten are a fault, for each node apart."""

from backend.rigs.faults import BUS_SILENT, LINK_SILENT, MOTOR_SILENT, STIFFNESS_SILENT, Fault
from backend.rigs.rig import Measured

BRIDGED, STOPS, FAULTS = 1, 3, 10
"""Ages in cycles from which torques are held, the rig is stopped, and a fault latches."""


def silence(measured: Measured) -> Fault | None:
    """Return the fault of what has been silent for FAULTS cycles; all nodes together are the bus."""
    ages = measured.motor_age, measured.stiffness_age, measured.link_age
    if min(ages) >= FAULTS:
        return BUS_SILENT
    for age, fault in zip(ages, (MOTOR_SILENT, STIFFNESS_SILENT, LINK_SILENT), strict=True):
        if age >= FAULTS:
            return fault
    return None


def oldest(measured: Measured) -> int:
    """Return the age of the oldest of the three measurements [cycles]."""
    return max(measured.link_age, measured.motor_age, measured.stiffness_age)


def missing(measured: Measured, age: int = STOPS) -> str:
    """Return in words which nodes have been silent for `age` cycles or more; empty = none."""
    names = (("motor drive", measured.motor_age), ("stiffness drive", measured.stiffness_age))
    silent = [name for name, of in (*names, ("link encoder", measured.link_age)) if of >= age]
    return ", ".join(f"the {name}" for name in silent)


def stop_sentence(measured: Measured) -> str:
    """Return why a rig with measurements of age STOPS was stopped."""
    who = missing(measured)
    have = "have" if "," in who else "has"
    return f"{who[:1].upper()}{who[1:]} {have} not answered for {STOPS} cycles. Check cable and power, then Reset."
