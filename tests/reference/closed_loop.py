"""One closed-loop run: measure, observe, law, limit, apply; every tick is recorded."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .estimator import Estimator, Measurement
from .law import link_torque, stiffness_torque
from .parameters import Config, Limits
from .plant import advance, back_torque, disturbance_over_period
from .sensors import quantise
from .signals import StiffnessReferenceFilter, link_reference


def limited(limits: Limits, torque: float, motor_speed: float) -> float:
    """Torque [N m] within the peak and, while it drives, within the limit that the winding sets at the true speed [rad/s]."""
    bound = limits.peak_torque
    if torque * motor_speed > 0.0 and np.isfinite(limits.no_load_speed):
        bound = min(bound, max(0.0, limits.stall_torque * (1.0 - abs(motor_speed) / limits.no_load_speed)))
    return float(np.clip(torque, -bound, bound))


class Sensors:
    """Quantised angles, with true velocities or filtered differences of the angles."""

    def __init__(self, config: Config) -> None:
        encoders = config.encoders
        self.resolutions = (encoders.link, encoders.motor, encoders.stiffness_motor)
        self.decay = np.exp(-config.controller.difference_filter * config.sample_time_s)
        self.difference = config.controller.difference_filter > 0.0
        self.sample_time = config.sample_time_s
        self.last: Measurement | None = None

    def read(self, state: np.ndarray) -> Measurement:
        """Measured angles and velocities of plant state (7,)."""
        angles = np.array([quantise(a, r) for a, r in zip(state[0:6:2], self.resolutions, strict=True)])
        velocities = np.array(state[1:6:2])
        if self.difference:
            raw = (angles - self.last.angles) / self.sample_time if self.last else np.zeros(3)
            old = self.last.velocities if self.last else np.zeros(3)
            velocities = self.decay * old + (1.0 - self.decay) * raw
        self.last = Measurement(angles, velocities)
        return self.last


def simulate(config: Config) -> dict[str, np.ndarray]:
    """Run `config`; returns arrays with one row a tick k, values at t_k and the torques decided or applied from t_k on.

    Keys: t, state (n, 7), reference (n, 5), stiffness_reference (n, 3), error (n, 4), sigma, snap, torque_unlimited,
    torque_limited, torque_applied (over [t_k, t_k + T)), stiffness_torque (applied), link, motor, stiffness_motor
    (n, 3: d, d', d''), known (n, 6: angles and velocities the law used), tracking_error (r - true theta_l).
    """
    plant, controller, dt = config.plant, config.controller, config.sample_time_s
    model = config.model if config.model is not None else replace(plant, coulomb_friction=0.0)
    sensors, estimator = Sensors(config), Estimator(controller, model, dt)
    stiffness_reference = StiffnessReferenceFilter(config.stiffness, model, dt)
    state = np.array([*config.initial_state, stiffness_reference.first, 0.0, config.initial_torque])
    preload = back_torque(plant, state[2] - state[0], state[4])
    feed, feed_ms = config.initial_torque, preload
    waiting, waiting_ms = config.initial_torque, preload
    rows: dict[str, list] = {}
    for k in range(round(config.duration_s / dt)):
        t = k * dt
        measured = sensors.read(state)
        known = estimator.update(measured, feed, feed_ms)
        deflection = measured.angles[1] - measured.angles[0]
        reference, wanted = link_reference(config.reference, t), stiffness_reference.state
        decided = link_torque(controller, model, reference, known, wanted[2], feed)
        torque = limited(config.limits, decided["torque"], state[3])
        torque_ms = stiffness_torque(controller, model, wanted, known, deflection)
        peak = config.limits.stiffness_peak_torque
        torque_ms = float(np.clip(torque_ms, -peak, peak))
        applied, applied_ms = (waiting, waiting_ms) if config.delay_samples else (torque, torque_ms)
        row = {
            "t": t,
            "state": state,
            "reference": reference,
            "stiffness_reference": wanted,
            "error": decided["error"],
            "sigma": decided["sigma"],
            "snap": decided["snap"],
            "torque_unlimited": decided["torque"],
            "torque_limited": torque,
            "torque_applied": applied,
            "stiffness_torque": applied_ms,
            "link": known.link,
            "motor": known.motor,
            "stiffness_motor": known.stiffness_motor,
            "known": [known.theta_l, known.omega_l, known.theta_e, known.omega_e, known.theta_ms, known.omega_ms],
            "tracking_error": reference[0] - state[0],
        }
        for name, value in row.items():
            rows.setdefault(name, []).append(value)
        terms = (config.link_disturbance, config.motor_disturbance, config.stiffness_disturbance)
        disturbances = [disturbance_over_period(channel, t) for channel in terms]
        state = advance(plant, state, t, dt, applied, applied_ms, disturbances, config.integrator)
        stiffness_reference.advance(t)
        waiting, waiting_ms = torque, torque_ms
        feed, feed_ms = (applied if controller.torque_feed == "applied" else decided["torque"]), applied_ms
    return {name: np.array(values) for name, values in rows.items()}
