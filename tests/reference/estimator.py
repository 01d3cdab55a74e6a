"""The observers of all three channels behind one interface: measured values in, what the law knows out."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from .law import Knowledge
from .observer import AuxiliaryObserver, PositionObserver, SampledObserver
from .parameters import Controller, Plant
from .plant import back_torque, spring_torque


@dataclass(frozen=True)
class Measurement:
    """Measured angles [rad] and velocities [rad/s]; link, motor, stiffness motor, each shape (3,)."""

    angles: np.ndarray
    velocities: np.ndarray


def _forces(model: Plant, measured: Measurement, torque: float, torque_ms: float) -> np.ndarray:
    """Modelled accelerations without damping of link, motor and stiffness motor; shape (3,)."""
    delta = measured.angles[1] - measured.angles[0]
    spring = spring_torque(model, delta, measured.angles[2])
    back = back_torque(model, delta, measured.angles[2])
    torques = np.array([spring, torque - spring, torque_ms - back])
    return torques / np.array([model.link_inertia, model.motor_inertia, model.stiffness_inertia])


class Estimator:
    """Observers of one controller; `update` advances them to the present measurement."""

    def __init__(self, controller: Controller, model: Plant, sample_time: float) -> None:
        g, g_ms = controller.observer_bandwidth, controller.stiffness_observer_bandwidth
        self.controller, self.model = controller, model
        self.rates = np.array(
            [
                model.link_damping / model.link_inertia,
                model.motor_damping / model.motor_inertia,
                model.stiffness_damping / model.stiffness_inertia,
            ]
        )
        self.kind = "position" if controller.form == "position" else controller.method
        if self.kind == "position":
            pairs = zip(self.rates, (g, g, g_ms), strict=True)
            self.position = [PositionObserver(rate, bandwidth, sample_time) for rate, bandwidth in pairs]
        elif self.kind == "exact":
            self.sampled = [SampledObserver(bandwidth, sample_time) for bandwidth in (g, g, g_ms)]
        else:
            link, motor, stiffness = (np.array([[0.0, 1.0], [0.0, -rate]]) for rate in self.rates)
            zero = np.zeros((2, 2))
            self.actuator = AuxiliaryObserver(np.block([[link, zero], [zero, motor]]), g, sample_time)
            self.stiffness = AuxiliaryObserver(stiffness, g_ms, sample_time)
        self.previous: Measurement | None = None

    def update(self, measured: Measurement, torque: float, torque_ms: float) -> Knowledge:
        """Estimates at the present tick; torques [N m] are those applied over the period just ended."""
        after = _forces(self.model, measured, torque, torque_ms)
        if self.previous is None:
            self._start(measured, after)
        else:
            self._advance(self.previous, _forces(self.model, self.previous, torque, torque_ms), measured, after)
        self.previous = measured
        return self._knowledge(measured)

    def _start(self, now: Measurement, force: np.ndarray) -> None:
        if self.kind == "position":
            for i, observer in enumerate(self.position):
                observer.start(now.angles[i], force[i])
        elif self.kind == "exact":
            for i, observer in enumerate(self.sampled):
                observer.d = np.array([force[i] - self.rates[i] * now.velocities[i], 0.0, 0.0])
        else:
            self.actuator.start(_state(now, 0, 1), _vector(force, 0, 1))
            self.stiffness.start(_state(now, 2), _vector(force, 2))

    def _advance(self, was: Measurement, before: np.ndarray, now: Measurement, after: np.ndarray) -> None:
        if self.kind == "position":
            for i, observer in enumerate(self.position):
                observer.update(before[i], now.angles[i], after[i])
        elif self.kind == "exact":
            f, f_next = before - self.rates * was.velocities, after - self.rates * now.velocities
            for i, observer in enumerate(self.sampled):
                observer.update(was.velocities[i], f[i], now.velocities[i], f_next[i])
        else:
            for observer, channels in ((self.actuator, (0, 1)), (self.stiffness, (2,))):
                x, x_next = _state(was, *channels), _state(now, *channels)
                observer.update(x, _vector(before, *channels), x_next, _vector(after, *channels))

    def _knowledge(self, now: Measurement) -> Knowledge:
        if self.kind == "position":
            link, motor, stiffness = (observer.x for observer in self.position)
            velocities = (link[1], motor[1], stiffness[1])
            known = _known((link[0], motor[0], now.angles[2]), velocities, link[2:], motor[2:], stiffness[2:])
            return replace(known, theta_ms_estimate=float(stiffness[0]))
        if self.kind == "exact":
            return _known(now.angles, now.velocities, *(observer.d for observer in self.sampled))
        actuator = self.actuator.estimate(_state(now, 0, 1))
        stiffness = self.stiffness.estimate(_state(now, 2))
        return _known(now.angles, now.velocities, actuator[:, 1], actuator[:, 3], stiffness[:, 1])


def _state(measured: Measurement, *channels: int) -> np.ndarray:
    """[theta, omega] of each channel in turn."""
    return np.array([value for i in channels for value in (measured.angles[i], measured.velocities[i])])


def _vector(force: np.ndarray, *channels: int) -> np.ndarray:
    """[0, force] of each channel in turn."""
    return np.array([value for i in channels for value in (0.0, force[i])])


def _known(
    angles: Iterable[float], velocities: Iterable[float], link: np.ndarray, motor: np.ndarray, stiffness: np.ndarray
) -> Knowledge:
    """Knowledge from angles and velocities in the order link, motor, stiffness motor."""
    (theta_l, theta_e, theta_ms), (omega_l, omega_e, omega_ms) = map(float, angles), map(float, velocities)
    return Knowledge(
        theta_l, omega_l, theta_e, omega_e, theta_ms, omega_ms, link.copy(), motor.copy(), stiffness.copy()
    )
