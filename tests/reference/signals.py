"""References with their derivatives, by product rule on 9th-order polynomials, and the filtered stiffness reference."""

from __future__ import annotations

from math import comb, pi, sin

import numpy as np
from numpy.polynomial import Polynomial

from .observer import first_order_hold
from .parameters import Plant, Reference, StiffnessReference

SMOOTHSTEP = Polynomial([0, 0, 0, 0, 0, 126, -420, 540, -315, 70])


def smoothstep(t: float, duration: float) -> np.ndarray:
    """9th-order rest-to-rest step from 0 to 1 over `duration` [s] and four derivatives in t; shape (5,)."""
    if duration <= 0.0 or t >= duration:
        return np.array([1.0 if t >= 0.0 else 0.0, 0.0, 0.0, 0.0, 0.0])
    if t <= 0.0:
        return np.zeros(5)
    x = t / duration
    return np.array([(SMOOTHSTEP.deriv(i)(x) if i else SMOOTHSTEP(x)) / duration**i for i in range(5)])


def link_reference(reference: Reference, t: float) -> np.ndarray:
    """[r, r', r'', r''', r''''] at t [s]; shape (5,)."""
    if reference.kind == "step":
        reached = t + 1e-9 >= reference.start_s
        return np.array([reference.offset + (reference.amplitude if reached else 0.0), 0.0, 0.0, 0.0, 0.0])
    if reference.kind == "move":
        course = reference.amplitude * smoothstep(t - reference.start_s, reference.duration_s)
        return course + reference.offset * np.eye(5)[0]
    w = 2.0 * pi * reference.frequency_hz
    wave = np.array([reference.amplitude * w**i * sin(w * t + i * pi / 2.0) for i in range(5)])
    wave[0] += reference.offset
    envelope = smoothstep(t, reference.fade_s)
    return np.array([sum(comb(n, i) * envelope[i] * wave[n - i] for i in range(n + 1)) for n in range(5)])


class StiffnessReferenceFilter:
    """theta_ms reference [r, r', r''] [rad, rad/s, rad/s^2]: the target, held a period, through 1 / (s / w_f + 1)^3."""

    def __init__(self, command: StiffnessReference, model: Plant, sample_time: float) -> None:
        self.command = command
        self.first = model.stiffness_motor_position(command.start)
        self.last = self.first if command.end is None else model.stiffness_motor_position(command.end)
        w = command.filter_bandwidth
        a = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [-(w**3), -3.0 * w**2, -3.0 * w]])
        self.phi, now, after = first_order_hold(a, np.array([[0.0], [0.0], [w**3]]), sample_time)
        self.gamma = (now + after)[:, 0]
        self.state = np.array([self.first, 0.0, 0.0])

    def target(self, t: float) -> float:
        """Unfiltered theta_ms target [rad] at t [s]."""
        course = smoothstep(t - self.command.start_s, self.command.duration_s)[0]
        return self.first + (self.last - self.first) * course

    def advance(self, t: float) -> None:
        """Filter state one period after t, with the target of t held."""
        self.state = self.phi @ self.state + self.gamma * self.target(t)
