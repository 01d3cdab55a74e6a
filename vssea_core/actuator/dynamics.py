"""The plant over one sample period: Eqs. (1)-(2), one Dormand-Prince step of order 5.

Torques are held by the drives over the period, so the solution is smooth and one step of order 5 is more accurate than
several of order 4. The torque-loop lag is not a state of the integration (it would force steps of its own length):
theta_e = theta~ + q, with q'' = (tau - u) / J_e in closed form, and theta~ is integrated.
"""

import math
from typing import NamedTuple

from vssea_core.actuator.spring import back_torque, spring_torque
from vssea_core.actuator.stages import shifted_1, shifted_2, shifted_3, shifted_4, shifted_5
from vssea_core.compiled import inlined
from vssea_core.signals.disturbances import load


class Plant(NamedTuple):
    """The true parameters as the kernel takes them (SI, gear side; see actuator.parameters)."""

    link_inertia: float
    link_damping: float
    motor_inertia: float
    motor_damping: float
    coulomb_friction: float
    friction_velocity: float
    torque_lag_s: float
    spring_constant: float
    stiffness_inertia: float
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


@inlined
def dry_friction(plant, omega):  # type: ignore[no-untyped-def]
    """Return the Coulomb friction torque [N m], smooth through zero: tau_c v / sqrt(v^2 + eps^2)."""
    if plant.coulomb_friction == 0.0:
        return 0.0
    eps = plant.friction_velocity
    return plant.coulomb_friction * omega / math.sqrt(omega * omega + eps * eps)


@inlined
def motion(plant, y, q, q_rate, tau_e, tau_ms, load_l, load_e):  # type: ignore[no-untyped-def]
    """Return the time derivative of y = (theta_l, theta~, theta_ms, omega_l, omega~, omega_ms), Eqs. (1)-(2).

    `q`, `q_rate` are the lag's share of theta_e and theta_e'; `load_l`, `load_e` the disturbance torques [N m].
    """
    theta_l, theta_e, theta_ms, omega_l, omega_e, omega_ms = y
    deflection = theta_e + q - theta_l
    true_omega_e = omega_e + q_rate
    tau_s = spring_torque(plant.spring_constant, deflection, theta_ms)
    if plant.paper_back_torque == 0.0:
        tau_back = back_torque(plant.spring_constant, deflection, theta_ms)
    else:
        tau_back = tau_s
    friction = plant.motor_damping * true_omega_e + dry_friction(plant, true_omega_e)
    a_l = (tau_s - plant.link_damping * omega_l - load_l) / plant.link_inertia
    a_e = (tau_e - tau_s - friction - load_e) / plant.motor_inertia
    a_ms = (tau_ms - plant.stiffness_damping * omega_ms - tau_back) / plant.stiffness_inertia
    return omega_l, omega_e, omega_ms, a_l, a_e, a_ms


@inlined
def lag_shift(plant, gap, time):  # type: ignore[no-untyped-def]
    """Return q [rad], q' [rad/s] after `time` [s] of a torque `gap` [N m] = tau(0) - u that dies with the lag."""
    lag = plant.torque_lag_s
    if lag == 0.0:
        return 0.0, 0.0
    grown = -math.expm1(-time / lag)
    speed = gap / plant.motor_inertia * lag
    return speed * (time - lag * grown), speed * grown


@inlined
def dormand_prince_step(plant, y, gap, tau_e, tau_ms, link_terms, motor_terms, tick_time, time, h):  # type: ignore[no-untyped-def]
    """Return y after one Dormand-Prince step of order 5 and length h [s] from `time`, with the torques held."""
    k1 = motion(plant, y, 0.0, 0.0, tau_e, tau_ms, load(link_terms, tick_time, time), load(motor_terms, tick_time, time))

    t = time + h / 5.0
    q, q_rate = lag_shift(plant, gap, h / 5.0)
    k2 = motion(plant, shifted_1(y, h, 1 / 5, k1), q, q_rate, tau_e, tau_ms,
                load(link_terms, tick_time, t), load(motor_terms, tick_time, t))  # fmt: skip

    t = time + 0.3 * h
    q, q_rate = lag_shift(plant, gap, 0.3 * h)
    k3 = motion(plant, shifted_2(y, h, 3 / 40, k1, 9 / 40, k2), q, q_rate, tau_e, tau_ms,
                load(link_terms, tick_time, t), load(motor_terms, tick_time, t))  # fmt: skip

    t = time + 0.8 * h
    q, q_rate = lag_shift(plant, gap, 0.8 * h)
    k4 = motion(plant, shifted_3(y, h, 44 / 45, k1, -56 / 15, k2, 32 / 9, k3), q, q_rate, tau_e, tau_ms,
                load(link_terms, tick_time, t), load(motor_terms, tick_time, t))  # fmt: skip

    t = time + h * 8.0 / 9.0
    q, q_rate = lag_shift(plant, gap, h * 8.0 / 9.0)
    y5 = shifted_4(y, h, 19372 / 6561, k1, -25360 / 2187, k2, 64448 / 6561, k3, -212 / 729, k4)
    k5 = motion(plant, y5, q, q_rate, tau_e, tau_ms, load(link_terms, tick_time, t), load(motor_terms, tick_time, t))

    t = time + h
    q, q_rate = lag_shift(plant, gap, h)
    y6 = shifted_5(y, h, 9017 / 3168, k1, -355 / 33, k2, 46732 / 5247, k3, 49 / 176, k4, -5103 / 18656, k5)
    k6 = motion(plant, y6, q, q_rate, tau_e, tau_ms, load(link_terms, tick_time, t), load(motor_terms, tick_time, t))

    theta_l, theta_e, theta_ms, omega_l, omega_e, omega_ms = shifted_5(
        y, h, 35 / 384, k1, 500 / 1113, k3, 125 / 192, k4, -2187 / 6784, k5, 11 / 84, k6
    )
    return theta_l, theta_e + q, theta_ms, omega_l, omega_e + q_rate, omega_ms


@inlined
def advance_plant(plant, state, tau_e, tau_ms, link_terms, motor_terms, time, sample_time_s):  # type: ignore[no-untyped-def]
    """Return the state one sample period after `time` [s], with the torques [N m] held by the drives.

    The end stops of the stiffness axis are inelastic. A disturbance term is active over whole periods.
    """
    y = (state.theta_l, state.theta_e, state.theta_ms, state.omega_l, state.omega_e, state.omega_ms)
    torque = state.motor_torque
    steps = 1
    if plant.coulomb_friction != 0.0 and abs(state.omega_e) < 10.0 * plant.friction_velocity:
        steps = int(plant.substeps)
    h = sample_time_s / steps
    for step in range(steps):
        gap = torque - tau_e
        y = dormand_prince_step(plant, y, gap, tau_e, tau_ms, link_terms, motor_terms, time, time + step * h, h)
        if plant.torque_lag_s == 0.0:
            torque = tau_e
        else:
            torque = tau_e + gap * math.exp(-h / plant.torque_lag_s)
    theta_l, theta_e, theta_ms, omega_l, omega_e, omega_ms = y
    if theta_ms < plant.theta_ms_stiff:
        theta_ms, omega_ms = plant.theta_ms_stiff, max(omega_ms, 0.0)
    elif theta_ms > plant.theta_ms_soft:
        theta_ms, omega_ms = plant.theta_ms_soft, min(omega_ms, 0.0)
    return PlantState(theta_l, omega_l, theta_e, omega_e, theta_ms, omega_ms, torque)
