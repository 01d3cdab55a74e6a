"""Limits of the drives, applied last: peak torque, I^2 t, torque-dependent speed. What was limited is told by bits."""

import math
from typing import NamedTuple

from vssea_core.compiled import inlined

PEAK, CONTINUOUS, SPEED, STIFFNESS_TORQUE, STIFFNESS_SPEED, LEAF_TORQUE, STIFFNESS_RATE, END_STOP = (
    1, 2, 4, 8, 16, 32, 64, 128,
)  # fmt: skip
FOLD_BACK = 0.9  # share of the continuous torque's square at which the peak starts to fold back


class Drives(NamedTuple):
    """Limits of both drives (SI, gear side) and the decay of their thermal averages over one sample."""

    peak_torque: float
    continuous_torque: float
    stall_torque: float
    torque_per_speed: float  # how fast the driving torque falls with speed: stall torque / no-load speed
    stiffness_peak_torque: float
    stiffness_continuous_torque: float
    stiffness_speed: float
    thermal_decay: float  # exp(-T / thermal time)
    leaf_cube: float  # cube of the leaf's torque a N m/rad: it bears leaf_torque (k/1000)^(1/3)


class Heat(NamedTuple):
    """Averaged squares of the motor torques [N^2 m^2]."""

    motor: float
    stiffness_motor: float


@inlined
def thermal_limit(peak, continuous, heat):
    """Return the torque [N m] left by I^2 t: the peak, folding back to the continuous torque as `heat` nears its square."""
    full = continuous * continuous
    if continuous >= peak or heat <= FOLD_BACK * full:
        return peak
    share = (full - heat) / ((1.0 - FOLD_BACK) * full)
    return continuous + (peak - continuous) * min(1.0, max(0.0, share))


@inlined
def limit_motor_torque(drives, heat, torque, omega_e):
    """Return the motor torque [N m] after its limits, the limit in force [N m], and the bits of what limited it."""
    available = thermal_limit(drives.peak_torque, drives.continuous_torque, heat.motor)
    bit = PEAK if available == drives.peak_torque else CONTINUOUS
    if torque * omega_e > 0.0:
        by_speed = max(0.0, drives.stall_torque - drives.torque_per_speed * abs(omega_e))
        if by_speed < available:
            available = by_speed
            bit = SPEED
    if abs(torque) <= available:
        return torque, available, 0
    return math.copysign(available, torque), available, bit


@inlined
def limit_stiffness_torque(drives, heat, torque, omega_ms):
    """Return the stiffness motor's torque [N m] after its limits, and the bits of what limited it."""
    available = thermal_limit(drives.stiffness_peak_torque, drives.stiffness_continuous_torque, heat.stiffness_motor)
    bit = STIFFNESS_TORQUE
    if torque * omega_ms > 0.0 and abs(omega_ms) > drives.stiffness_speed:
        available = 0.0
        bit = STIFFNESS_SPEED
    if abs(torque) <= available:
        return torque, 0
    return math.copysign(available, torque), bit


@inlined
def warmed(drives, heat, torque, stiffness_torque):
    """Return the thermal averages after one sample of the applied torques [N m]."""
    keep = drives.thermal_decay
    gain = 1.0 - keep
    return Heat(
        keep * heat.motor + gain * torque * torque,
        keep * heat.stiffness_motor + gain * stiffness_torque * stiffness_torque,
    )
