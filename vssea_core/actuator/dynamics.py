"""The plant over one sample period: Eqs. (1)-(2), one Dormand-Prince step of order 5.

Torques are held by the drives over the period, so the solution is smooth and one step of order 5 is more accurate than
several of order 4. The torque-loop lag is not a state of the integration (it would force steps of its own length):
theta_e = theta~ + q, with J_e q'' + b_e q' = tau - u in closed form, and theta~ is integrated.
"""

import math
from typing import NamedTuple

from vssea_core.actuator.spring import leaf
from vssea_core.actuator.stages import POSITION_WEIGHTS as X
from vssea_core.actuator.stages import VELOCITY_WEIGHTS as V
from vssea_core.actuator.stages import moved_1, moved_2, moved_3, moved_4, moved_5
from vssea_core.actuator.surroundings import met_load
from vssea_core.compiled import entry, inlined
from vssea_core.fused import fused
from vssea_core.signals.disturbances import C2, C3, C4, C5, loads_of_step


class Plant(NamedTuple):
    """The true parameters as the kernel takes them (SI, gear side; see actuator.parameters)."""

    per_link_inertia: float  # 1/J: a product costs less than a quotient
    link_damping: float
    per_motor_inertia: float
    motor_damping: float
    coulomb_friction: float
    friction_velocity: float
    spring_constant: float
    per_stiffness_inertia: float
    stiffness_damping: float
    theta_ms_stiff: float  # end stops [rad]; the stiff one is the smaller
    theta_ms_soft: float
    paper_back_torque: float  # 1 = Eq. (2) as printed
    substeps: float  # steps a period while the dry friction is sharp


class PlantState(NamedTuple):
    """Positions [rad], velocities [rad/s] and the lagged motor torque [N m]."""

    theta_l: float
    omega_l: float
    theta_e: float
    omega_e: float
    theta_ms: float
    omega_ms: float
    motor_torque: float


FINEST = 8
"""Steps of the finest integration for each step of the fine one."""
UNLOADED = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
SHARP_TURN = 1.0
"""Share of the friction's smoothing velocity that may pass in one period before the finest integration is needed."""


@inlined
def dry_friction(plant, omega):
    """Return the Coulomb friction torque [N m], smooth through zero: tau_c v / sqrt(v^2 + eps^2)."""
    if plant.coulomb_friction == 0.0:
        return 0.0
    eps = plant.friction_velocity
    return plant.coulomb_friction * omega / math.sqrt(omega * omega + eps * eps)


@inlined
def accelerations(plant, met, positions, velocities, q, q_rate, tau_e, tau_ms, load_l, load_e):
    """Return theta_l'', theta~'', theta_ms'' [rad/s^2] at (theta_l, theta~, theta_ms) and their rates, Eqs. (1)-(2).

    `q`, `q_rate` are the lag's share of theta_e and theta_e'; `load_l`, `load_e` the disturbance torques [N m] that are
    functions of time; `met` the rows and tick time of what depends on the link's state, or None (compiled without it).
    """
    theta_l, theta_e, theta_ms = positions
    omega_l, omega_e, omega_ms = velocities
    if met is not None:
        load_l += met_load(met[0], met[1], theta_l, omega_l)
    spring = leaf(theta_e + q - theta_l, theta_ms)
    tau_s = plant.spring_constant * spring.torque
    tau_back = tau_s if plant.paper_back_torque != 0.0 else plant.spring_constant * spring.back
    load_e += dry_friction(plant, omega_e + q_rate)
    return (  # the damping of q' is in q
        fused(-plant.link_damping, omega_l, tau_s - load_l) * plant.per_link_inertia,
        fused(-plant.motor_damping, omega_e, tau_e - load_e - tau_s) * plant.per_motor_inertia,
        fused(-plant.stiffness_damping, omega_ms, tau_ms - tau_back) * plant.per_stiffness_inertia,
    )


class LagShares(NamedTuple):
    """What the lag adds to theta_e and theta_e' per N m of torque gap, at the five later instants of a step."""

    q2: float
    q3: float
    q4: float
    q5: float
    q6: float
    rate2: float
    rate3: float
    rate4: float
    rate5: float
    rate6: float
    left: float  # share of the gap that is left at the step's end


@inlined
def lag_share(slow, fast, scale, time):
    """Return q and q' of J_e q'' + b_e q' = exp(-fast t), q(0) = q'(0) = 0, at `time` [s]."""
    a, b = -math.expm1(-slow * time), -math.expm1(-fast * time)
    return scale * (a / slow - b / fast), scale * (b - a)


@entry
def lag_shares(lag_s, per_inertia, damping, step_s):
    """Return the LagShares of a step of `step_s` [s] on an inertia 1/`per_inertia` [kg m^2] with `damping` [N m s/rad]."""
    if lag_s == 0.0:
        return LagShares(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    slow, fast = max(damping * per_inertia, 1e-9), 1.0 / lag_s
    if abs(fast - slow) < 1e-6 * fast:
        fast *= 1.0 + 1e-6  # the formula divides by their difference
    scale = per_inertia / (fast - slow)
    q2, rate2 = lag_share(slow, fast, scale, C2 * step_s)
    q3, rate3 = lag_share(slow, fast, scale, C3 * step_s)
    q4, rate4 = lag_share(slow, fast, scale, C4 * step_s)
    q5, rate5 = lag_share(slow, fast, scale, C5 * step_s)
    q6, rate6 = lag_share(slow, fast, scale, step_s)
    return LagShares(q2, q3, q4, q5, q6, rate2, rate3, rate4, rate5, rate6, math.exp(-step_s / lag_s))


@inlined
def dormand_prince_step(plant, met, lag, y, gap, tau_e, tau_ms, loads_l, loads_e, loads_ms, h):
    """Return y after one Dormand-Prince step of order 5 and length h [s], with the torques held.

    `gap` is how far the motor's torque still is from `tau_e` [N m] at its start; `loads_l`, `loads_e`, `loads_ms` are the
    disturbance torques [N m] of link, motor and stiffness motor at its six instants; `met` as in `accelerations`.
    """
    x, v, hh = (y[0], y[1], y[2]), (y[3], y[4], y[5]), h * h
    # Minus zero: the compiler may then leave out the sum, and sees that this spring is the one it has computed already.
    a1 = accelerations(plant, met, x, v, -0.0, -0.0, tau_e, tau_ms - loads_ms[0], loads_l[0], loads_e[0])
    x2 = moved_1(x, h * C2, v)
    v2 = moved_1(v, h * V[1][0], a1)
    a2 = accelerations(
        plant, met, x2, v2, gap * lag.q2, gap * lag.rate2, tau_e, tau_ms - loads_ms[1], loads_l[1], loads_e[1]
    )
    x3 = moved_2(x, h * C3, v, hh * X[2][0], a1)
    v3 = moved_2(v, h * V[2][0], a1, h * V[2][1], a2)
    a3 = accelerations(
        plant, met, x3, v3, gap * lag.q3, gap * lag.rate3, tau_e, tau_ms - loads_ms[2], loads_l[2], loads_e[2]
    )
    x4 = moved_3(x, h * C4, v, hh * X[3][0], a1, hh * X[3][1], a2)
    v4 = moved_3(v, h * V[3][0], a1, h * V[3][1], a2, h * V[3][2], a3)
    a4 = accelerations(
        plant, met, x4, v4, gap * lag.q4, gap * lag.rate4, tau_e, tau_ms - loads_ms[3], loads_l[3], loads_e[3]
    )
    x5 = moved_4(x, h * C5, v, hh * X[4][0], a1, hh * X[4][1], a2, hh * X[4][2], a3)
    v5 = moved_4(v, h * V[4][0], a1, h * V[4][1], a2, h * V[4][2], a3, h * V[4][3], a4)
    a5 = accelerations(
        plant, met, x5, v5, gap * lag.q5, gap * lag.rate5, tau_e, tau_ms - loads_ms[4], loads_l[4], loads_e[4]
    )
    x6 = moved_5(x, h, v, hh * X[5][0], a1, hh * X[5][1], a2, hh * X[5][2], a3, hh * X[5][3], a4)
    v6 = moved_5(v, h * V[5][0], a1, h * V[5][1], a2, h * V[5][2], a3, h * V[5][3], a4, h * V[5][4], a5)
    a6 = accelerations(
        plant, met, x6, v6, gap * lag.q6, gap * lag.rate6, tau_e, tau_ms - loads_ms[5], loads_l[5], loads_e[5]
    )
    x = moved_5(x, h, v, hh * X[6][0], a1, hh * X[6][2], a3, hh * X[6][3], a4, hh * X[6][4], a5)
    v = moved_5(v, h * V[6][0], a1, h * V[6][2], a3, h * V[6][3], a4, h * V[6][4], a5, h * V[6][5], a6)
    return x[0], x[1] + gap * lag.q6, x[2], v[0], v[1] + gap * lag.rate6, v[2]


@inlined
def steps_of_period(plant, state, tau_e, sample_time_s):
    """Return how finely a period is to be integrated: 0 = in one step, 1 = finely, 2 = most finely.

    Only dry friction near standstill asks for more than one step. It turns over within a few times its smoothing velocity,
    so what counts is how much of that the motor passes in one period.
    """
    if plant.coulomb_friction == 0.0:
        return 0
    tau_s = plant.spring_constant * leaf(state.theta_e - state.theta_l, state.theta_ms).torque
    force = abs(tau_e - tau_s) + plant.coulomb_friction + abs(state.motor_torque - tau_e)
    passed = force * plant.per_motor_inertia * sample_time_s
    if abs(state.omega_e) > 10.0 * plant.friction_velocity + passed:
        return 0
    return 2 if passed > SHARP_TURN * plant.friction_velocity else 1


@inlined
def stopped(plant, theta_ms, omega_ms):
    """Return position [rad] and velocity [rad/s] of the stiffness motor within its inelastic end stops."""
    if theta_ms < plant.theta_ms_stiff:
        return plant.theta_ms_stiff, max(omega_ms, 0.0)
    if theta_ms > plant.theta_ms_soft:
        return plant.theta_ms_soft, min(omega_ms, 0.0)
    return theta_ms, omega_ms


@inlined
def advance_plant(plant, lags, state, tau_e, tau_ms, link_terms, motor_terms, time, sample_time_s):
    """Return the state one sample period after `time` [s], with the torques [N m] held by the drives, and the loads at `time`.

    `lags` are the LagShares of a step, for each of the three finenesses. The terms are constants and sines on link and
    motor; actuator.parts is for all else.
    """
    y = (state.theta_l, state.theta_e, state.theta_ms, state.omega_l, state.omega_e, state.omega_ms)
    gap = state.motor_torque - tau_e
    fineness = steps_of_period(plant, state, tau_e, sample_time_s)
    steps, lag = 1, lags[0]
    if fineness == 1:
        steps, lag = int(plant.substeps), lags[1]
    elif fineness == 2:
        steps, lag = int(plant.substeps) * FINEST, lags[2]
    h = sample_time_s / steps
    load_l = load_e = 0.0
    for step in range(steps):
        loads_l = loads_of_step(link_terms, time, time + step * h, h, steps == 1)
        loads_e = loads_of_step(motor_terms, time, time + step * h, h, steps == 1)
        if step == 0:
            load_l, load_e = loads_l[0], loads_e[0]
        y = dormand_prince_step(plant, None, lag, y, gap, tau_e, tau_ms, loads_l, loads_e, UNLOADED, h)
        gap *= lag.left
    theta_l, theta_e, theta_ms, omega_l, omega_e, omega_ms = y
    theta_ms, omega_ms = stopped(plant, theta_ms, omega_ms)
    return PlantState(theta_l, omega_l, theta_e, omega_e, theta_ms, omega_ms, tau_e + gap), (load_l, load_e, 0.0)
