"""Control laws: the error state of Eqs. (7)-(10), state feedback (9), sliding mode (14)-(16), stiffness loop (19)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .parameters import Controller, Plant
from .plant import back_torque, spring_stiffness, spring_torque


@dataclass(frozen=True)
class Knowledge:
    """What the law knows at a tick: positions, velocities and [d, d', d''] of link, motor and stiffness motor."""

    theta_l: float
    omega_l: float
    theta_e: float
    omega_e: float
    theta_ms: float  # measured
    omega_ms: float
    link: np.ndarray  # (3,) [rad/s^2, rad/s^3, rad/s^4]
    motor: np.ndarray  # (3,)
    stiffness_motor: np.ndarray  # (3,)
    theta_ms_estimate: float | None = (
        None  # what the position form's observer makes of theta_ms; None = the measured one
    )


def switch(sigma: float, layer: float) -> float:
    """saturation(sigma / layer), or the sign of sigma for a layer of 0."""
    return float(np.clip(sigma / layer, -1.0, 1.0)) if layer > 0.0 else float(np.sign(sigma))


def link_torque(
    controller: Controller,
    model: Plant,
    reference: np.ndarray,
    known: Knowledge,
    theta_ms_acceleration: float,
    previous_torque: float = 0.0,
) -> dict[str, float | np.ndarray]:
    """Motor torque [N m] with the error state e (4,), sigma, and the snap nu [rad/s^4] it realises.

    `previous_torque` [N m] matters only where the algebraic loop is left unsolved: Pi_2'' = theta_e'' - snap is then
    computed with it, and the torque follows from theta_e'' = nu + Pi_2''.
    """
    delta, delta_rate = known.theta_e - known.theta_l, known.omega_e - known.omega_l
    spring = spring_torque(model, delta, known.theta_ms)
    stiffness = spring_stiffness(model, delta, known.theta_ms)
    rate = known.omega_ms / known.theta_ms if controller.stiffness_terms != "none" else 0.0
    spring_rate = stiffness * delta_rate - 3.0 * spring * rate
    j, b = model.link_inertia, model.link_damping
    acceleration = (spring - b * known.omega_l) / j - known.link[0]
    jerk = (spring_rate - b * acceleration) / j - known.link[1]
    error = reference[:4] - np.array([known.theta_l, known.omega_l, acceleration, jerk])

    s = np.append(controller.surface_gains(), 1.0)
    sigma = float(s @ error)
    if controller.law == "state_feedback":
        snap = reference[4] + controller.feedback_gains() @ error
    else:
        snap = reference[4] + s[:3] @ error[1:] + controller.switching_gain * switch(sigma, controller.boundary_layer)

    remainder = -spring / 4.0 * delta_rate**2 if model.spring == "sine" else 0.0
    if controller.stiffness_terms == "all":
        remainder += -6.0 * stiffness * delta_rate * rate + 12.0 * spring * rate**2
        remainder += -3.0 * spring * theta_ms_acceleration / known.theta_ms
    spring_acceleration = j * (snap + known.link[2]) + b * jerk
    motor_acceleration = acceleration + (spring_acceleration - remainder) / stiffness
    if controller.algebraic_loop == "previous":
        resisted = spring + model.motor_damping * known.omega_e
        assumed = (previous_torque - resisted) / model.motor_inertia - known.motor[0]
        assumed_spring = stiffness * (assumed - acceleration) + remainder
        motor_acceleration = snap + assumed - (assumed_spring - b * jerk) / j + known.link[2]
    torque = model.motor_inertia * (motor_acceleration + known.motor[0]) + spring + model.motor_damping * known.omega_e
    return {"torque": float(torque), "error": error, "sigma": sigma, "snap": float(snap)}


def stiffness_torque(
    controller: Controller, model: Plant, reference: np.ndarray, known: Knowledge, measured_deflection: float
) -> float:
    """Stiffness-motor torque [N m], Eq. (19) with r'' and b_ms; `reference` is [r, r', r'']."""
    w, zeta = controller.stiffness_pole, controller.stiffness_damping
    theta_ms = known.theta_ms if known.theta_ms_estimate is None else known.theta_ms_estimate
    acceleration = reference[2] + w**2 * (reference[0] - theta_ms)
    acceleration += 2.0 * zeta * w * (reference[1] - known.omega_ms) + known.stiffness_motor[0]
    back = back_torque(model, measured_deflection, known.theta_ms)
    return float(model.stiffness_inertia * acceleration + model.stiffness_damping * known.omega_ms + back)
