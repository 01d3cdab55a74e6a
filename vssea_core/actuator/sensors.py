"""Encoders: positions rounded to whole counts. Velocity signals, where a rig has them, are ideal."""

import math
from typing import NamedTuple

import numpy as np

from vssea_core.actuator.parameters import EquilibriumMotor, Sensors
from vssea_core.compiled import inlined


class Encoders(NamedTuple):
    """Resolution of each encoder at the gear side [rad]; 0 = ideal."""

    link: float
    motor: float
    stiffness_motor: float


class Measurement(NamedTuple):
    """What the controller is given at a tick: positions [rad] and, if the rig has them, velocities [rad/s]."""

    theta_l: float
    theta_e: float
    theta_ms: float
    omega_l: float
    omega_e: float
    omega_ms: float


def encoders(sensors: Sensors, motor: EquilibriumMotor) -> Encoders:
    """Return the resolutions [rad] of `sensors`; the motor's encoder sits before the gear."""
    turn = 2.0 * math.pi
    return Encoders(
        turn / 2**sensors.link_bits if sensors.link_bits else 0.0,
        turn / (sensors.motor_counts * motor.gear_ratio) if sensors.motor_counts else 0.0,
        turn / sensors.stiffness_counts if sensors.stiffness_counts else 0.0,
    )


@inlined
def quantised(angle, resolution):
    """Return `angle` [rad] rounded to the nearest whole count."""
    if resolution == 0.0:
        return angle
    return resolution * np.rint(angle / resolution)


@inlined
def measure(resolution, state):
    """Return the Measurement of a PlantState."""
    return Measurement(
        quantised(state.theta_l, resolution.link),
        quantised(state.theta_e, resolution.motor),
        quantised(state.theta_ms, resolution.stiffness_motor),
        state.omega_l,
        state.omega_e,
        state.omega_ms,
    )
