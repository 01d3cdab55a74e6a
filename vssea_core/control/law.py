"""Error state, both control laws and the one map from snap to torque: Eqs. (6)-(10) and (14)-(16), without the misprints.

Both laws only choose the link's snap nu = theta_l''''; the map turns it into motor torque with every term of a spring whose
stiffness moves, and with the algebraic loop of Eqs. (9) and (16) solved.
"""

import math
from typing import NamedTuple

from vssea_core.actuator.spring import leaf
from vssea_core.compiled import inlined

STATE_FEEDBACK, SLIDING_MODE, BASELINE = 0.0, 1.0, 2.0
SGN, LAYER, TANH, SUPER_TWISTING = 0.0, 1.0, 2.0, 3.0
VELOCITY_FORM, POSITION_FORM, NO_OBSERVER = 0.0, 1.0, 2.0


class Law(NamedTuple):
    """Gains and the controller's model as the kernel takes them; the first GAINS of them may follow the stiffness."""

    k1: float
    k2: float
    k3: float
    k4: float
    s1: float
    s2: float
    s3: float
    x1: float  # baseline: u = -x1 theta_l - x2 omega_l - x3 theta_e - x4 omega_e + prefilter r
    x2: float
    x3: float
    x4: float
    prefilter: float
    controller: float  # STATE_FEEDBACK, SLIDING_MODE or BASELINE
    switch: float  # SGN, LAYER, TANH or SUPER_TWISTING
    switching_gain: float
    layer_width: float
    twisting_gain: float
    observer: float  # VELOCITY_FORM, POSITION_FORM or NO_OBSERVER
    predict: float  # 1 = act on the state predicted over the compute delay
    period: float  # T [s]
    difference_keep: (
        float  # filtered encoder differences: w+ = keep w + gain (theta+ - theta); gain 0 = measured velocities
    )
    difference_gain: float
    link_inertia: float
    link_damping: float
    motor_inertia: float
    motor_damping: float
    spring_constant: float
    stiffness_inertia: float
    stiffness_damping: float
    stiffness_p: float  # w^2 of the stiffness loop
    stiffness_d: float  # 2 z w
    rate_share: float  # 1 = the theta_ms' term of tau_s' is known to the law, 0 = left out
    moving_share: float  # 1 = the theta_ms terms of R are known to it, 0 = left out


GAINS = 12


class Target(NamedTuple):
    """A reference and its four derivatives [rad, rad/s, ...]."""

    r: float
    r1: float
    r2: float
    r3: float
    r4: float


class StiffnessTarget(NamedTuple):
    """Reference of the stiffness motor [rad] and two derivatives; the second is continuous."""

    r: float
    r1: float
    r2: float


class Terms(NamedTuple):
    """What one tick computed, term by term."""

    e1: float
    e2: float
    e3: float
    e4: float
    sigma: float
    snap: float
    motor_torque: float
    stiffness_torque: float
    twisting: float  # integral of the super-twisting law after this sample, if no limit holds the torque back


@inlined
def switched(switch, sigma, layer_width):
    """Return sgn(sigma), or what stands for it over +-layer_width: its saturation or tanh."""
    if switch == LAYER:
        return min(1.0, max(-1.0, sigma / layer_width))
    if switch == TANH:
        return math.tanh(sigma / layer_width)
    return math.copysign(1.0, sigma) if sigma != 0.0 else 0.0


@inlined
def reaching(law, sigma, twisting):
    """Return the snap [rad/s^4] that drives sigma to zero, Eq. (16), and the super-twisting integral one sample later."""
    sign = switched(law.switch, sigma, law.layer_width)
    if law.switch == SUPER_TWISTING:
        pull = 1.5 * math.sqrt(law.twisting_gain * abs(sigma)) * sign
        return pull + twisting, twisting + 1.1 * law.twisting_gain * law.period * sign
    return law.switching_gain * sign, 0.0


@inlined
def chosen_snap(law, sigma, e1, e2, e3, e4, r4, twisting):
    """Return nu [rad/s^4], Eq. (9) for state feedback and Eq. (16) for sliding mode, and the super-twisting integral."""
    if law.controller == SLIDING_MODE:
        pull, following = reaching(law, sigma, twisting)
        return r4 + law.s1 * e2 + law.s2 * e3 + law.s3 * e4 + pull, following
    return r4 + law.k1 * e1 + law.k2 * e2 + law.k3 * e3 + law.k4 * e4, 0.0


@inlined
def baseline_torque(law, link, motor, r):
    """Return u = -K x + N_r r [N m] of Fig. 2: state feedback on (A, B) of Eq. (5), without observer."""
    return law.prefilter * r - law.x1 * link.theta - law.x2 * link.omega - law.x3 * motor.theta - law.x4 * motor.omega


@inlined
def act(law, memory, target, stiffness_target):
    """Return the Terms of this tick from the observers' memory and both references."""
    link, motor, stiffness = memory.link, memory.motor, memory.stiffness
    theta_ms = stiffness.measured
    spring = leaf(motor.theta - link.theta, theta_ms)
    tau_s = law.spring_constant * spring.torque
    k = law.spring_constant * spring.stiffness

    per_theta, per_inertia = 1.0 / theta_ms, 1.0 / law.link_inertia
    known_rate = law.rate_share * stiffness.omega * per_theta
    ms_rate = law.moving_share * stiffness.omega * per_theta
    ms_acceleration = law.moving_share * stiffness_target.r2 * per_theta
    deflection_rate = motor.omega - link.omega
    tau_s_rate = k * deflection_rate - 3.0 * tau_s * known_rate
    beta = law.link_damping * per_inertia
    a_l = tau_s * per_inertia - beta * link.omega - link.d
    j_l = tau_s_rate * per_inertia - beta * a_l - link.d1

    e1 = target.r - link.theta
    e2 = target.r1 - link.omega
    e3 = target.r2 - a_l
    e4 = target.r3 - j_l
    sigma = law.s1 * e1 + law.s2 * e2 + law.s3 * e3 + e4
    snap, twisting = chosen_snap(law, sigma, e1, e2, e3, e4, target.r4, memory.twisting)

    moving = (
        -0.25 * tau_s * deflection_rate * deflection_rate
        - 6.0 * k * deflection_rate * ms_rate
        + 12.0 * tau_s * ms_rate * ms_rate
        - 3.0 * tau_s * ms_acceleration
    )
    a_e = a_l + (law.link_inertia * (snap + link.d2) + law.link_damping * j_l - moving) / k
    motor_torque = law.motor_inertia * (a_e + motor.d) + tau_s + law.motor_damping * motor.omega
    if law.controller == BASELINE:
        motor_torque, snap = baseline_torque(law, link, motor, target.r), 0.0

    asked = (
        stiffness_target.r2
        + law.stiffness_p * (stiffness_target.r - stiffness.theta)
        + law.stiffness_d * (stiffness_target.r1 - stiffness.omega)
    )
    stiffness_torque = (
        law.stiffness_inertia * (asked + stiffness.d)
        + law.stiffness_damping * stiffness.omega
        + law.spring_constant * memory.spring.back
    )
    return Terms(e1, e2, e3, e4, sigma, snap, motor_torque, stiffness_torque, twisting)
