"""Nonlinear plant, Eqs. (1)-(4), integrated over one sample period with the torques held."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import cos, sin, sqrt

import numpy as np
from scipy.integrate import solve_ivp

from .parameters import Plant, Term

Disturbance = Callable[[float], float]


def spring_torque(plant: Plant, deflection: float, theta_ms: float) -> float:
    """tau_s [N m], Eq. (3) with the deflection inside the sine."""
    if plant.spring == "linear":
        return plant.spring_constant / (2.0 * theta_ms**3) * deflection
    return plant.spring_constant / theta_ms**3 * sin(deflection / 2.0)


def spring_stiffness(plant: Plant, deflection: float, theta_ms: float) -> float:
    """k = d tau_s / d deflection [N m/rad], Eq. (4)."""
    curve = 1.0 if plant.spring == "linear" else cos(deflection / 2.0)
    return plant.spring_constant / (2.0 * theta_ms**3) * curve


def spring_energy(plant: Plant, deflection: float, theta_ms: float) -> float:
    """Energy V [J] stored in the spring: the integral of tau_s over the deflection."""
    if plant.spring == "linear":
        return plant.spring_constant / (4.0 * theta_ms**3) * deflection**2
    return 2.0 * plant.spring_constant / theta_ms**3 * (1.0 - cos(deflection / 2.0))


def back_torque(plant: Plant, deflection: float, theta_ms: float) -> float:
    """tau_back [N m] on the stiffness motor: dV/d theta_ms (energy), or tau_s as Eq. (2) prints it (paper)."""
    if plant.back_torque == "paper":
        return spring_torque(plant, deflection, theta_ms)
    return -3.0 * spring_energy(plant, deflection, theta_ms) / theta_ms


def disturbance_over_period(terms: Sequence[Term], tick_time: float) -> Disturbance:
    """Sum of the terms active over the whole period that starts at `tick_time` [s], as a function of t [s]."""
    active = [term for term in terms if term.start_s <= tick_time + 1e-9 and tick_time + 1e-9 < term.end_s]

    def value(t: float) -> float:
        return sum(
            term.amplitude
            if term.kind == "constant"
            else term.amplitude * sin(2.0 * np.pi * term.frequency_hz * t + term.phase)
            for term in active
        )

    return value


def derivative(
    plant: Plant,
    t: float,
    state: Sequence[float],
    command: float,
    command_ms: float,
    disturbances: Sequence[Disturbance],
) -> list[float]:
    """Right-hand side of Eqs. (1)-(2); state [theta_l, omega_l, theta_e, omega_e, theta_ms, omega_ms, tau_motor]."""
    theta_l, omega_l, theta_e, omega_e, theta_ms, omega_ms, tau_motor = state
    torque = tau_motor if plant.torque_lag_s > 0.0 else command
    spring = spring_torque(plant, theta_e - theta_l, theta_ms)
    friction = plant.coulomb_friction * omega_e / sqrt(omega_e**2 + plant.friction_velocity**2)
    back = back_torque(plant, theta_e - theta_l, theta_ms)
    link, motor, stiffness_motor = (disturbance(t) for disturbance in disturbances)
    return [
        omega_l,
        (spring - plant.link_damping * omega_l - link) / plant.link_inertia,
        omega_e,
        (torque - spring - plant.motor_damping * omega_e - friction - motor) / plant.motor_inertia,
        omega_ms,
        (command_ms - plant.stiffness_damping * omega_ms - back - stiffness_motor) / plant.stiffness_inertia,
        (command - tau_motor) / plant.torque_lag_s if plant.torque_lag_s > 0.0 else 0.0,
    ]


def advance(
    plant: Plant,
    state: np.ndarray,
    tick_time: float,
    sample_time: float,
    command: float,
    command_ms: float,
    disturbances: Sequence[Disturbance],
    integrator: str = "dop853",
    substeps: int = 4,
) -> np.ndarray:
    """State (7,) after one period [s] with both torques [N m] held; `rk` is a fast fourth-order scheme."""

    def slope(t: float, x: np.ndarray) -> np.ndarray:
        return np.array(derivative(plant, t, x.tolist(), command, command_ms, disturbances))

    if integrator == "dop853":
        end = tick_time + sample_time
        solution = solve_ivp(slope, (tick_time, end), state, method="DOP853", rtol=1e-12, atol=1e-14)
        return _without_lag_state(plant, solution.y[:, -1], command)
    h = sample_time / substeps
    for i in range(substeps):
        t = tick_time + i * h
        k1 = slope(t, state)
        k2 = slope(t + h / 2, state + h / 2 * k1)
        k3 = slope(t + h / 2, state + h / 2 * k2)
        k4 = slope(t + h, state + h * k3)
        state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return _without_lag_state(plant, state, command)


def _without_lag_state(plant: Plant, state: np.ndarray, command: float) -> np.ndarray:
    """The state with tau_motor set to the command where the torque loop has no lag."""
    if plant.torque_lag_s > 0.0:
        return state
    return np.append(state[:6], command)
