"""Sampled closed loop about rest as one matrix: linear spring, constant stiffness, nominal observer and law."""

from __future__ import annotations

import numpy as np
from scipy.linalg import expm

from .observer import PositionObserver, SampledObserver, first_order_hold
from .parameters import Controller, Plant


def sampled_plant(plant: Plant, stiffness: float, sample_time: float) -> tuple[np.ndarray, np.ndarray]:
    """(Phi, gamma) of Eq. (5) with the torque held; with a lag the fifth state is the motor torque [N m]."""
    jl, bl, je, be = plant.link_inertia, plant.link_damping, plant.motor_inertia, plant.motor_damping
    n = 5 if plant.torque_lag_s > 0.0 else 4
    a, b = np.zeros((n, n)), np.zeros(n)
    a[0, 1] = a[2, 3] = 1.0
    a[1, :3] = np.array([-stiffness, -bl, stiffness]) / jl
    a[3, :4] = np.array([stiffness, 0.0, -stiffness, -be]) / je
    if n == 5:
        a[3, 4], a[4, 4], b[4] = 1.0 / je, -1.0 / plant.torque_lag_s, 1.0 / plant.torque_lag_s
    else:
        b[3] = 1.0 / je
    block = np.zeros((n + 1, n + 1))
    block[:n, :n], block[:n, n] = a, b
    exponential = expm(block * sample_time)
    return exponential[:n, :n], exponential[:n, n]


def law_rows(gains: np.ndarray, model: Plant, stiffness: float) -> tuple[np.ndarray, np.ndarray]:
    """(c_x (4,), c_d (4,)) with u = c_x x + c_d [d_l, d_l', d_l'', d_e], for gains K (4,)."""
    beta, w2 = model.link_damping / model.link_inertia, stiffness / model.link_inertia
    je = model.motor_inertia
    kappa = model.link_inertia * je / stiffness
    k1, k2, k3, k4 = gains
    acceleration = np.array([-w2, -beta, w2, 0.0])
    jerk = np.array([0.0, -w2, 0.0, w2]) - beta * acceleration
    snap = -np.array([k1, k2, 0.0, 0.0]) - k3 * acceleration - k4 * jerk
    spring = stiffness * np.array([-1.0, 0.0, 1.0, 0.0])
    c_x = (
        je * acceleration + kappa * (snap + beta * jerk) + spring + model.motor_damping * np.array([0.0, 0.0, 0.0, 1.0])
    )
    c_d = kappa * np.array([k3 - beta * k4 + beta**2 - w2, k4 - beta, 1.0, w2])
    return c_x, c_d


def gains_of(controller: Controller) -> np.ndarray:
    """K (4,) of the law; inside its boundary layer sliding mode is state feedback with l = rho / phi."""
    if controller.law == "state_feedback":
        return controller.feedback_gains()
    s1, s2, s3 = controller.surface_gains()
    slope = controller.switching_gain / controller.boundary_layer
    return np.array([slope * s1, s1 + slope * s2, s2 + slope * s3, s3 + slope])


def _velocity_block(controller: Controller, sample_time: float) -> tuple[np.ndarray, ...]:
    """(Phi_d, h, b_0, b_1): d[k+1] = Phi_d d[k] + h (v[k+1] - v[k]) + b_0 f[k+] + b_1 f[k+1-]."""
    g = controller.observer_bandwidth
    if controller.method == "exact":
        observer = SampledObserver(g, sample_time)
        half = observer.gain * sample_time / 2.0
        return observer.phi - np.outer(observer.gain, observer.c), -observer.gain, half, half
    gains = np.array([3.0 * g, 3.0 * g**2, g**3])
    a = np.column_stack([-gains, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    phi, now, after = first_order_hold(a, np.column_stack([gains, a @ -gains]), sample_time)
    # d = a - G v: the held and the ramp part of v give -h v[k] and +h v[k+1] since Phi G + now + after = G
    return phi, after[:, 1] - gains, now[:, 0], after[:, 0]


def closed_loop_matrix(
    controller: Controller,
    plant: Plant,
    model: Plant,
    stiffness: float,
    model_stiffness: float,
    sample_time: float,
    delay: int,
) -> np.ndarray:
    """Matrix of xi[k+1] = M xi[k], xi = [x, (tau_motor), observer link, observer motor, (delayed u)].

    Observer blocks have 3 states (velocity form) or 5 (position form); `plant` is true, `model` what the controller
    assumes; stiffnesses in N m/rad, `delay` 0 or 1 samples.
    """
    phi, gamma = sampled_plant(plant, stiffness, sample_time)
    n, m = len(gamma), 5 if controller.form == "position" else 3
    size = n + 2 * m + delay
    everything = np.eye(size)
    x, link, motor = everything[:4], everything[n : n + m], everything[n + m : n + 2 * m]
    c_x, c_d = law_rows(gains_of(controller), model, model_stiffness)
    if controller.form == "position":
        known, estimates = np.vstack([link[:2], motor[:2]]), np.vstack([link[2:], motor[2]])
    else:
        known, estimates = x, np.vstack([link, motor[0]])
    decided = c_x @ known + c_d @ estimates
    applied = everything[-1] if delay else decided

    x_next = phi @ everything[:n] + np.outer(gamma, applied)
    jl, je = model.link_inertia, model.motor_inertia
    rates = (model.link_damping / jl, model.motor_damping / je)
    rows = [x_next]
    for i, block in enumerate((link, motor)):
        angle, speed = 2 * i, 2 * i + 1
        force = model_stiffness * np.array([-1.0, 0.0, 1.0, 0.0]) * (1.0 / jl if i == 0 else -1.0 / je)
        drive = applied / je if i == 1 else np.zeros(size)
        before, after = force @ x + drive, force @ x_next[:4] + drive
        if controller.form == "position":
            observer = PositionObserver(rates[i], controller.observer_bandwidth, sample_time)
            predicted = observer.a @ block + np.outer(observer.now, before) + np.outer(observer.next, after)
            rows.append(predicted + np.outer(observer.gain, x_next[angle] - predicted[0]))
        else:
            phi_d, h, b0, b1 = _velocity_block(controller, sample_time)
            before, after = before - rates[i] * x[speed], after - rates[i] * x_next[speed]
            rows.append(
                phi_d @ block + np.outer(h, x_next[speed] - x[speed]) + np.outer(b0, before) + np.outer(b1, after)
            )
    if delay:
        rows.append(decided[None, :])
    return np.vstack(rows)
