"""One tick of the disturbance observers: link, equilibrium motor and stiffness motor, in either form.

Order of a tick: measure, bring the observers up to now with the torque that was *applied* over the last period, then the
law. The spring is remembered as a shape without parameters, so a change of the controller's model changes nothing that
was already estimated.
"""

from typing import NamedTuple

from vssea_core.actuator.spring import leaf
from vssea_core.compiled import inlined
from vssea_core.control.law import NO_OBSERVER, POSITION_FORM


class ObserverGains(NamedTuple):
    """Discrete matrices of one channel (control.observer_design); of the two forms, one is in use."""

    a11: float  # velocity form: d+ = A d + h (v+ - v) + b0 f0 + b1 f1
    a12: float
    a13: float
    a21: float
    a22: float
    a23: float
    a31: float
    a32: float
    a33: float
    h1: float
    h2: float
    h3: float
    b01: float
    b02: float
    b03: float
    b11: float
    b12: float
    b13: float
    theta_w: float  # position form: first two rows of x- = A x + B0 phi0 + B1 phi1
    theta_d: float
    theta_d1: float
    theta_d2: float
    omega_w: float
    omega_d: float
    omega_d1: float
    omega_d2: float
    theta_f0: float
    theta_f1: float
    omega_f0: float
    omega_f1: float
    m1: float  # and its correction x = x- + M (theta - x-[0])
    m2: float
    m3: float
    m4: float
    m5: float
    period: float  # T [s]


class Channel(NamedTuple):
    """What is known of one inertia: position [rad], velocity [rad/s], d, d', d'' [rad/s^2 ...], last measured position."""

    theta: float
    omega: float
    d: float
    d1: float
    d2: float
    measured: float


class Spring(NamedTuple):
    """The spring at the last tick from measured positions, without Y_tau, and whether there was a last tick."""

    torque: float
    back: float
    started: float


class Memory(NamedTuple):
    """All that the controller remembers between two ticks."""

    link: Channel
    motor: Channel
    stiffness: Channel
    spring: Spring
    twisting: float  # integral of the super-twisting law [rad/s^4]


@inlined
def updated_velocity_form(gains, channel, theta, omega, f0, f1):
    """Return the channel one period later: Eq. (22) in d, d', d'', given v = omega and f at both ends of the period."""
    dv = omega - channel.omega
    d, d1, d2 = channel.d, channel.d1, channel.d2
    return Channel(
        theta,
        omega,
        gains.a11 * d + gains.a12 * d1 + gains.a13 * d2 + gains.h1 * dv + gains.b01 * f0 + gains.b11 * f1,
        gains.a21 * d + gains.a22 * d1 + gains.a23 * d2 + gains.h2 * dv + gains.b02 * f0 + gains.b12 * f1,
        gains.a31 * d + gains.a32 * d1 + gains.a33 * d2 + gains.h3 * dv + gains.b03 * f0 + gains.b13 * f1,
        theta,
    )


@inlined
def updated_position_form(gains, channel, theta, phi0, phi1):
    """Return the channel one period later from the measured position `theta`; damping sits in the matrices, not in phi."""
    w, d, d1, d2 = channel.omega, channel.d, channel.d1, channel.d2
    t = gains.period
    angle = (
        channel.theta + gains.theta_w * w + gains.theta_d * d + gains.theta_d1 * d1 + gains.theta_d2 * d2
        + gains.theta_f0 * phi0 + gains.theta_f1 * phi1
    )  # fmt: skip
    speed = (
        gains.omega_w * w + gains.omega_d * d + gains.omega_d1 * d1 + gains.omega_d2 * d2
        + gains.omega_f0 * phi0 + gains.omega_f1 * phi1
    )  # fmt: skip
    innovation = theta - angle
    return Channel(
        angle + gains.m1 * innovation,
        speed + gains.m2 * innovation,
        d + t * d1 + 0.5 * t * t * d2 + gains.m3 * innovation,
        d1 + t * d2 + gains.m4 * innovation,
        d2 + gains.m5 * innovation,
        theta,
    )


@inlined
def started(model, y, applied_e, applied_ms):
    """Return the memory of a first tick: at rest in equilibrium, d = f and d' = d'' = 0 (zero would kick the motor)."""
    spring = leaf(y.theta_e - y.theta_l, y.theta_ms)
    shape = Spring(spring.torque, spring.back, 1.0)
    tau_s = model.spring_constant * shape.torque
    tau_back = model.spring_constant * shape.back
    # Products with 1/J as in `act`: rounded otherwise, they would kick the motor a little.
    d_l = tau_s * (1.0 / model.link_inertia)
    d_e = (applied_e - tau_s) * (1.0 / model.motor_inertia)
    d_ms = (applied_ms - tau_back) * (1.0 / model.stiffness_inertia)
    if model.observer == NO_OBSERVER:
        d_l = d_e = 0.0
    return Memory(
        Channel(y.theta_l, 0.0, d_l, 0.0, 0.0, y.theta_l),
        Channel(y.theta_e, 0.0, d_e, 0.0, 0.0, y.theta_e),
        Channel(y.theta_ms, 0.0, d_ms, 0.0, 0.0, y.theta_ms),
        shape,
        0.0,
    )


@inlined
def observe(prepared, memory, y, applied_e, applied_ms):
    """Return the memory brought up to the measurement `y`, with the torques [N m] applied over the period that ended."""
    law = prepared.law
    if memory.spring.started == 0.0:
        return started(law, y, applied_e, applied_ms)
    spring = leaf(y.theta_e - y.theta_l, y.theta_ms)
    shape = Spring(spring.torque, spring.back, 1.0)
    past = memory.spring
    tau_s0 = law.spring_constant * past.torque
    tau_s1 = law.spring_constant * shape.torque
    back0 = law.spring_constant * past.back
    back1 = law.spring_constant * shape.back
    per_l, per_e, per_ms = 1.0 / law.link_inertia, 1.0 / law.motor_inertia, 1.0 / law.stiffness_inertia
    phi_l0, phi_l1 = tau_s0 * per_l, tau_s1 * per_l
    phi_e0, phi_e1 = (applied_e - tau_s0) * per_e, (applied_e - tau_s1) * per_e
    phi_ms0, phi_ms1 = (applied_ms - back0) * per_ms, (applied_ms - back1) * per_ms
    link, motor, stiffness = memory.link, memory.motor, memory.stiffness
    if law.observer == POSITION_FORM:
        return Memory(
            updated_position_form(prepared.link, link, y.theta_l, phi_l0, phi_l1),
            updated_position_form(prepared.motor, motor, y.theta_e, phi_e0, phi_e1),
            updated_position_form(prepared.stiffness, stiffness, y.theta_ms, phi_ms0, phi_ms1),
            shape,
            memory.twisting,
        )
    omega_l, omega_e, omega_ms = y.omega_l, y.omega_e, y.omega_ms
    if law.difference_gain != 0.0:
        keep, gain = law.difference_keep, law.difference_gain
        omega_l = keep * link.omega + gain * (y.theta_l - link.measured)
        omega_e = keep * motor.omega + gain * (y.theta_e - motor.measured)
        omega_ms = keep * stiffness.omega + gain * (y.theta_ms - stiffness.measured)
    b_l, b_e, b_ms = law.link_damping * per_l, law.motor_damping * per_e, law.stiffness_damping * per_ms
    return Memory(
        updated_velocity_form(
            prepared.link, link, y.theta_l, omega_l, phi_l0 - b_l * link.omega, phi_l1 - b_l * omega_l
        ),
        updated_velocity_form(
            prepared.motor, motor, y.theta_e, omega_e, phi_e0 - b_e * motor.omega, phi_e1 - b_e * omega_e
        ),
        updated_velocity_form(
            prepared.stiffness, stiffness, y.theta_ms, omega_ms,
            phi_ms0 - b_ms * stiffness.omega, phi_ms1 - b_ms * omega_ms,
        ),
        shape,
        memory.twisting,
    )  # fmt: skip
