"""What a rig stands, as data: its limits, the bits that tell of them, and the numbers that the tick takes."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vssea_core.actuator.parameters import Actuator
from vssea_core.actuator.spring import stiffness_motor_position

RIG_TORQUE, RIG_RATE, RIG_SPEED, RIG_POSITION, RIG_DEFLECTION, RIG_STIFFNESS, BLENDED = (
    256, 512, 1024, 2048, 4096, 8192, 16384,
)  # fmt: skip
BRAKE_TIME_S = 0.05
BRAKE_SHARE = 0.7  # share of the torque limit that the brake takes at the speed limit
FASTEST_APPROACH = 40.0  # 1/s; rate at which speed nears what a border allows
FASTEST_STIFFNESS_APPROACH = 100.0
STIFFNESS_BRAKING_SHARE = 0.5  # share of the stiffness motor's torque that its braking counts on
STIFFNESS_SLACK = 1.0 / 500.0  # share of the stiffness range by which the barrier stands outside what may be commanded
SAG_BANDWIDTH = 4.0  # rad/s; what of the deflection is slower counts as the sag of a load
DIFFERENCE_BANDWIDTH = 500.0  # rad/s; filter of the encoder differences


class RigLimits(NamedTuple):
    """What a rig stands, SI and gear side; theta_ms_stiff belongs to the highest permitted stiffness and is the smaller."""

    motor_torque: float
    motor_torque_rate: float
    motor_speed: float
    stiffness_torque: float
    stiffness_speed: float
    link_low: float
    link_high: float
    braking: float  # deceleration [rad/s^2] that the position limits count on
    deflection: float
    theta_ms_stiff: float
    theta_ms_soft: float


class Bounds(NamedTuple):
    """The limits as the tick takes them, with what of the actuator turns speeds into torques."""

    motor_torque: float
    torque_step: float  # most by which the torque grows in a cycle [N m]
    motor_speed: float
    stiffness_torque: float
    stiffness_speed: float
    link_low: float
    link_high: float
    braking: float
    deflection: float
    theta_ms_stiff: float
    theta_ms_soft: float
    stiffness_braking: float  # rad/s^2
    link_inertia: float
    motor_inertia: float
    stiffness_inertia: float
    spring_constant: float
    approach: float  # 1/s
    stiffness_approach: float
    brake: float  # damping of the model-free brake [N m s/rad]
    difference_keep: float
    difference_gain: float
    sag_gain: float
    stop_stiff: float  # the mechanism's own end stops [rad]
    stop_soft: float


BOUNDS_SIZE = len(Bounds._fields)


def bounds_row(limits: RigLimits, actuator: Actuator, sample_time_s: float) -> NDArray[np.float64]:
    """Return the numbers of Bounds for a rig with this actuator, sampled every `sample_time_s` [s]."""
    motor, mechanism = actuator.motor, actuator.stiffness
    slack = STIFFNESS_SLACK * (limits.theta_ms_soft - limits.theta_ms_stiff)
    keep = math.exp(-min(DIFFERENCE_BANDWIDTH * sample_time_s, 1.0))
    return np.array(
        Bounds(
            limits.motor_torque,
            limits.motor_torque_rate * sample_time_s,
            limits.motor_speed,
            limits.stiffness_torque,
            limits.stiffness_speed,
            limits.link_low,
            limits.link_high,
            limits.braking,
            limits.deflection,
            limits.theta_ms_stiff - slack,
            limits.theta_ms_soft + slack,
            STIFFNESS_BRAKING_SHARE * limits.stiffness_torque / mechanism.inertia,
            actuator.link.inertia,
            motor.inertia,
            mechanism.inertia,
            mechanism.spring_constant,
            min(FASTEST_APPROACH, 0.1 / sample_time_s),
            min(FASTEST_STIFFNESS_APPROACH, 0.2 / sample_time_s),
            min(motor.inertia / BRAKE_TIME_S, BRAKE_SHARE * limits.motor_torque / limits.motor_speed),
            keep,
            (1.0 - keep) / sample_time_s,
            1.0 - math.exp(-SAG_BANDWIDTH * sample_time_s),
            stiffness_motor_position(mechanism.stiffest, mechanism.spring_constant),
            stiffness_motor_position(mechanism.softest, mechanism.spring_constant),
        )
    )
