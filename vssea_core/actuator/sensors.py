"""Sensors: encoders round positions to whole counts; seeded noise on positions and on velocity signals, if wanted."""

import math
from typing import NamedTuple

import numpy as np

from vssea_core.actuator.parameters import EquilibriumMotor, Sensors
from vssea_core.compiled import called, inlined
from vssea_core.signals.noise import SENSORS, four_normals


class Encoders(NamedTuple):
    """Resolution of each encoder at the gear side [rad]; 0 = ideal."""

    link: float
    motor: float
    stiffness_motor: float


class Noise(NamedTuple):
    """Root mean squares of the sensors' noise [rad, rad/s], the seed, and 1 if there is any."""

    link: float = 0.0
    motor: float = 0.0
    stiffness_motor: float = 0.0
    velocity: float = 0.0
    seed: float = 0.0
    any: float = 0.0


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


def noise_of(sensors: Sensors, seed: int) -> Noise:
    """Return the noise of `sensors` with the scenario's seed."""
    sizes = sensors.link_noise, sensors.motor_noise, sensors.stiffness_noise, sensors.velocity_noise
    return Noise(*sizes, float(seed), float(any(sizes)))


@inlined
def quantised(angle, resolution):
    """Return `angle` [rad] rounded to the nearest whole count."""
    if resolution == 0.0:
        return angle
    return resolution * np.rint(angle / resolution)


@called
def disturbed(noise, state, sample):
    """Return the Measurement of a PlantState by ideal encoders with the noise of a sample."""
    a = four_normals(noise.seed, SENSORS, 2 * sample)
    b = four_normals(noise.seed, SENSORS, 2 * sample + 1)
    return Measurement(
        state.theta_l + noise.link * a[0],
        state.theta_e + noise.motor * a[1],
        state.theta_ms + noise.stiffness_motor * a[2],
        state.omega_l + noise.velocity * b[0],
        state.omega_e + noise.velocity * b[1],
        state.omega_ms + noise.velocity * b[2],
    )


@inlined
def measure(resolution, noise, state, sample):
    """Return the Measurement of a PlantState at sample number `sample`."""
    seen = Measurement(state.theta_l, state.theta_e, state.theta_ms, state.omega_l, state.omega_e, state.omega_ms)
    if noise.any != 0.0:
        seen = disturbed(noise, state, sample)
    return Measurement(
        quantised(seen.theta_l, resolution.link),
        quantised(seen.theta_e, resolution.motor),
        quantised(seen.theta_ms, resolution.stiffness_motor),
        seen.omega_l,
        seen.omega_e,
        seen.omega_ms,
    )
