"""What the rig stands, applied last and told by bits: torque and its rate, speed, position, deflection, stiffness range.

Speed, position and deflection are barriers: they bound the acceleration that the motor may be given, beyond what holds the
spring, so that it meets the border at rest. Held springs are left alone.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vssea_core.actuator.drive import limit_motor_torque, limit_stiffness_torque, thermal_limit
from vssea_core.actuator.parameters import Actuator
from vssea_core.actuator.spring import stiffness_motor_position
from vssea_core.compiled import inlined

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
LEAST_STIFFNESS = 1.0  # N m/rad
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


class Motion(NamedTuple):
    """Where an actuator is, from its encoders alone: positions [rad], filtered differences [rad/s], spring torques [N m]."""

    theta_l: float
    theta_e: float
    theta_ms: float
    omega_l: float
    omega_e: float
    omega_ms: float
    spring_torque: float
    back_torque: float
    stiffness: float  # N m/rad
    sag: float  # slow part of the deflection [rad], which a load on the link makes


@inlined
def allowed_speed(distance, braking, slope):
    """Return the speed [rad/s] at a `distance` [rad] from a border that still allows to stop there, and d speed/d distance.

    sqrt(2 a d), and straight with `slope` [1/s] near the border, so that it is met without a jerk.
    """
    straight = braking / (slope * slope)
    if distance <= 0.0:
        return 0.0, slope
    if distance < straight:
        return slope * distance, slope
    speed = math.sqrt(braking * (2.0 * distance - straight))
    return speed, braking / speed


@inlined
def highest_acceleration(approach, distance, braking, omega, closing):
    """Return the acceleration [rad/s^2] with which `omega` [rad/s] never leaves what `distance` allows; it closes at `closing`."""
    speed, slope = allowed_speed(distance, braking, 0.5 * approach)
    return approach * (speed - omega) - slope * max(closing, 0.0)


@inlined
def swing(bounds, motion):
    """Return how far [rad] the link may yet swing from where the motor holds it: the amplitude of its free oscillation.

    A border for the link's own position would drive that oscillation; its amplitude hardly changes during a swing.
    """
    offset = motion.theta_e - motion.theta_l - motion.sag
    rate = motion.omega_e - motion.omega_l
    per_frequency = bounds.link_inertia / max(motion.stiffness, LEAST_STIFFNESS)
    return math.sqrt(offset * offset + rate * rate * per_frequency) + bounds.braking * per_frequency


@inlined
def upward_bound(bounds, omega, left, deflection_left, link_omega, tau_s):
    """Return the highest motor torque [N m] that speed, position and deflection allow upwards, and the bit of the narrowest."""
    rate = bounds.approach
    highest, bit = rate * (bounds.motor_speed - omega), RIG_SPEED
    by_place = highest_acceleration(rate, left, bounds.braking, omega, omega)
    if by_place < highest:
        highest, bit = by_place, RIG_POSITION
    by_deflection = rate * (link_omega + 0.5 * rate * deflection_left - omega)
    if by_deflection < highest:
        highest, bit = by_deflection, RIG_DEFLECTION
    return tau_s + bounds.motor_inertia * highest, bit


@inlined
def within_barriers(bounds, motion, torque):
    """Return the motor torque [N m] within the barriers, and the bits of what held it back."""
    m = motion
    swings, deflection = swing(bounds, m), m.theta_e - m.theta_l
    left = bounds.link_high - m.theta_e - max(-m.sag, 0.0) - swings
    high, high_bit = upward_bound(bounds, m.omega_e, left, bounds.deflection - deflection, m.omega_l, m.spring_torque)
    left = m.theta_e - max(m.sag, 0.0) - swings - bounds.link_low
    low, low_bit = upward_bound(bounds, -m.omega_e, left, bounds.deflection + deflection, -m.omega_l, -m.spring_torque)
    low = -low
    if low > high and m.omega_e < 0.0:  # two borders at odds: the one ahead has it
        high, high_bit = low, low_bit
    elif low > high:
        low, low_bit = high, high_bit
    if torque > high:
        return high, high_bit
    if torque < low:
        return low, low_bit
    return torque, 0


@inlined
def held_growth(torque, before, step):
    """Return a torque [N m] whose size grew by at most `step` from `before`, counted from zero on a change of sign."""
    most = abs(before) + step if torque * before >= 0.0 else step
    if abs(torque) <= most:
        return torque
    return math.copysign(most, torque)


@inlined
def limit_brake(bounds, drives, heat, torque, before):
    """Return the torque [N m] of the brake within torque, I^2 t and growth, what is available, and the bits."""
    available = min(bounds.motor_torque, thermal_limit(drives.peak_torque, drives.continuous_torque, heat.motor))
    held, bits = torque, 0
    if abs(held) > available:
        held, bits = math.copysign(available, held), RIG_TORQUE
    grown = held_growth(held, before, bounds.torque_step)
    if grown != held:
        bits |= RIG_RATE
    return grown, available, bits


@inlined
def limit_motor(bounds, drives, heat, motion, torque, before):
    """Return the motor torque [N m] after every limit, what is available [N m], and the bits of what limited it.

    The rate holds back every change that is asked; a barrier may take torque off at once, but not let it grow faster.
    """
    held, available, bits = limit_motor_torque(drives, heat, torque, motion.omega_e)
    available = min(available, bounds.motor_torque)
    if abs(held) > bounds.motor_torque:
        held = math.copysign(bounds.motor_torque, held)
        bits |= RIG_TORQUE
    if abs(held - before) > bounds.torque_step:
        held = before + math.copysign(bounds.torque_step, held - before)
        bits |= RIG_RATE
    held, barrier_bits = within_barriers(bounds, motion, held)
    bits |= barrier_bits
    ceiling = min(bounds.motor_torque, thermal_limit(drives.peak_torque, drives.continuous_torque, heat.motor))
    if abs(held) > ceiling:
        held = math.copysign(ceiling, held)
    grown = held_growth(held, before, bounds.torque_step)
    if grown != held:
        bits |= RIG_RATE
    return grown, available, bits


@inlined
def limit_stiffness(bounds, drives, heat, motion, torque):
    """Return the stiffness motor's torque [N m] after every limit, and the bits of what limited it."""
    held, bits = limit_stiffness_torque(drives, heat, torque, motion.omega_ms)
    theta, omega, rate = motion.theta_ms, motion.omega_ms, bounds.stiffness_approach
    slowed, inertia = bounds.stiffness_braking, bounds.stiffness_inertia
    up, up_bit = rate * (bounds.stiffness_speed - omega), RIG_SPEED
    by_place = highest_acceleration(rate, bounds.theta_ms_soft - theta, slowed, omega, omega)
    if by_place < up:
        up, up_bit = by_place, RIG_STIFFNESS
    down, down_bit = rate * (bounds.stiffness_speed + omega), RIG_SPEED
    by_place = highest_acceleration(rate, theta - bounds.theta_ms_stiff, slowed, -omega, -omega)
    if by_place < down:
        down, down_bit = by_place, RIG_STIFFNESS
    if held > motion.back_torque + inertia * up:
        held = motion.back_torque + inertia * up
        bits |= up_bit
    if held < motion.back_torque - inertia * down:
        held = motion.back_torque - inertia * down
        bits |= down_bit
    ceiling = min(
        bounds.stiffness_torque,
        thermal_limit(drives.stiffness_peak_torque, drives.stiffness_continuous_torque, heat.stiffness_motor),
    )
    if abs(held) > ceiling:
        held = math.copysign(ceiling, held)
        bits |= RIG_TORQUE
    return held, bits
