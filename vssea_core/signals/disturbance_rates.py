"""True disturbance torques with their rates and second derivatives, computed from the document for comparison with estimates."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vssea_core.signals.disturbances import GRAVITY, TIME_SLACK_S, Inertia, chirp_law, noise_stream
from vssea_core.signals.documents import (
    ChirpDisturbance,
    ContactDisturbance,
    LinkDisturbance,
    PendulumDisturbance,
    PulseDisturbance,
)
from vssea_core.signals.smooth_noise import SPACING_BANDWIDTH, noise_and_rates

Numbers = NDArray[np.float64]
Rates = tuple[Numbers, Numbers, Numbers]


def load_and_rates(
    terms: Sequence[LinkDisturbance],
    times: Numbers,
    *,
    seed: int = 0,
    on: Inertia = "link",
    position: Numbers | None = None,
    velocity: Numbers | None = None,
) -> Rates:
    """Return the sum of `terms` at tick `times` (n,) [s] as torque [N m], its rate [N m/s] and acceleration [N m/s^2].

    Functions of time are differentiated analytically, noise too; jumps at starts, ends and edges add nothing to the rates.
    Weights and walls need the recorded link `position` (n,) [rad] and `velocity` (n,) [rad/s]; what their rates need besides
    is taken by differences of these records. Raises ValueError if they are missing.
    """
    total = np.zeros((3, len(times)))
    for number, term in enumerate(terms):
        end = math.inf if term.end_s is None else term.end_s
        acts = (term.start_s <= times + TIME_SLACK_S) & (times + TIME_SLACK_S < end)
        match term.kind:
            case "pendulum":
                found = _pendulum(term, times, *_motion(term.kind, position, velocity))
            case "contact":
                found = _contact(term, times, *_motion(term.kind, position, velocity))
            case "constant":
                found = _sine(0.0, 0.0, 0.0, times, offset=term.torque)
            case "sine":
                found = _sine(term.amplitude, term.frequency_hz, term.phase, times)
            case "multisine":
                found = _sine(0.0, 0.0, 0.0, times)
                for part in term.components:
                    sine = _sine(part.amplitude, part.frequency_hz, part.phase, times)
                    found = (found[0] + sine[0], found[1] + sine[1], found[2] + sine[2])
            case "pulse":
                found = _pulse(term, times)
            case "chirp":
                found = _chirp(term, times)
            case "noise":
                spacing = term.bandwidth_hz / SPACING_BANDWIDTH
                shapes = noise_and_rates(spacing, seed, noise_stream(on, number), times)
                found = (term.rms * shapes[0], term.rms * shapes[1], term.rms * shapes[2])
        total += np.where(acts, np.array(found), 0.0)
    return total[0], total[1], total[2]


def _motion(kind: str, position: Numbers | None, velocity: Numbers | None) -> tuple[Numbers, Numbers]:
    if position is None or velocity is None:
        raise ValueError(
            f"the rates of a {kind} depend on the link's motion; expected its recorded position and velocity"
        )
    return position, velocity


def _sine(amplitude: float, frequency_hz: float, phase: float, times: Numbers, offset: float = 0.0) -> Rates:
    w = 2.0 * math.pi * frequency_hz
    sine, cosine = amplitude * np.sin(w * times + phase), amplitude * np.cos(w * times + phase)
    return offset + sine, w * cosine, -w * w * sine


def _pulse(term: PulseDisturbance, times: Numbers) -> Rates:
    since = times + TIME_SLACK_S - term.start_s
    if term.repeat:
        since = since - np.floor(since / term.period_s) * term.period_s
    still = np.zeros(len(times))
    return np.where(since < term.width_s, term.torque, 0.0), still, still


def _chirp(term: ChirpDisturbance, times: Numbers) -> Rates:
    low, growth, duration, logarithmic = chirp_law(
        term.start_frequency_hz, term.end_frequency_hz, term.duration_s, term.sweep
    )
    since = times - term.start_s
    swept = np.clip(since, 0.0, duration)
    sweeping = (since >= 0.0) & (since < duration)
    if logarithmic:
        w = low * np.exp(growth * swept)
        angle, w1 = low * np.expm1(growth * swept) / growth, growth * w
    else:
        w = low + growth * swept
        angle, w1 = swept * (low + 0.5 * growth * swept), np.full(len(times), growth)
    angle, w1 = angle + w * (since - swept), np.where(sweeping, w1, 0.0)
    sine, cosine = term.amplitude * np.sin(angle), term.amplitude * np.cos(angle)
    return sine, w * cosine, w1 * cosine - w * w * sine


def _pendulum(term: PendulumDisturbance, times: Numbers, position: Numbers, velocity: Numbers) -> Rates:
    weight = GRAVITY * term.mass * term.length
    acceleration = np.gradient(velocity, times)
    sine, cosine = weight * np.sin(position), weight * np.cos(position)
    return sine, cosine * velocity, cosine * acceleration - sine * velocity**2


def _contact(term: ContactDisturbance, times: Numbers, position: Numbers, velocity: Numbers) -> Rates:
    side = 1.0 if term.side == "above" else -1.0
    depth = side * (position - term.position)
    push = np.maximum(0.0, term.stiffness * depth + term.damping * side * velocity)
    torque = side * np.where(depth > 0.0, push, 0.0)
    rate = np.gradient(torque, times)
    return torque, rate, np.gradient(rate, times)
