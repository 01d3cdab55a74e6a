"""What becomes of the axes after each fault, beyond the stop that all of them cause."""

from backend.rigs.faults import (
    BUS_OFF,
    BUS_SILENT,
    DEFLECTION,
    END_STOP,
    HOMING,
    LEAF_TORQUE,
    MOTOR_DRIVE,
    MOTOR_FROZEN,
    MOTOR_JUMP,
    MOTOR_SILENT,
    OUTSIDE,
    STIFFNESS_ASTRAY,
    STIFFNESS_DRIVE,
    STIFFNESS_JUMP,
    STIFFNESS_SILENT,
    Fault,
)
from backend.rigs.rig import AXES, Axis

LOST: dict[Fault, tuple[Axis, ...]] = {
    MOTOR_SILENT: ("motor",),
    MOTOR_DRIVE: ("motor",),
    MOTOR_JUMP: ("motor",),
    MOTOR_FROZEN: ("motor",),
    STIFFNESS_SILENT: ("stiffness",),
    STIFFNESS_DRIVE: ("stiffness",),
    STIFFNESS_JUMP: ("stiffness",),
    STIFFNESS_ASTRAY: ("stiffness",),
    BUS_SILENT: AXES,
    BUS_OFF: AXES,
}
"""Faults after which an axis cannot be braked or held by the loop: its drive stops it."""

UNHOMES = (STIFFNESS_JUMP, STIFFNESS_ASTRAY, END_STOP, HOMING)
"""Faults after which theta_ms is not known any more."""

ONLY_DRIVEN = (OUTSIDE, DEFLECTION, LEAF_TORQUE)
"""Conditions that a rig with its drives off may be in; they keep it from being armed."""
