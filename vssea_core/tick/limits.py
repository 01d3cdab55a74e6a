"""The limits of a rig, applied last and told by bits: torque and its rate, speed, position, deflection, stiffness range.

Speed, position and deflection are barriers: they bound the acceleration that the motor may be given, beyond what holds the
spring, so that it meets the border at rest. Held springs are left alone.
"""

import math
from typing import NamedTuple

from vssea_core.actuator.drive import limit_motor_torque, limit_stiffness_torque, thermal_limit
from vssea_core.compiled import inlined
from vssea_core.tick.bounds import RIG_DEFLECTION, RIG_POSITION, RIG_RATE, RIG_SPEED, RIG_STIFFNESS, RIG_TORQUE

LEAST_STIFFNESS = 1.0  # N m/rad


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
