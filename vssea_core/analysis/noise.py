"""What a tuning costs and gives, in figures a user knows: torque noise of the present encoders, and the meaning of g."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import solve_discrete_lyapunov

from vssea_core.actuator.sensors import Encoders
from vssea_core.analysis.assembly import NOISE, TORQUE
from vssea_core.analysis.frequency_response import balancing
from vssea_core.analysis.loop import LoopModel
from vssea_core.analysis.margins import finite
from vssea_core.analysis.sensitivities import first_below, map_at, require_stable

ONE_HZ = 2.0 * math.pi


@dataclass(frozen=True)
class TorqueNoise:
    """RMS torque [N m] and RMS of its change from sample to sample, from encoder counts taken as white noise."""

    rms: float
    chatter: float

    def document(self) -> dict[str, float]:
        """Return plain numbers."""
        return {"rms": self.rms, "chatter": self.chatter}


def torque_noise(loop: LoopModel, encoders: Encoders) -> TorqueNoise:
    """Return the TorqueNoise of `loop` with errors of `encoders` of variance LSB^2 / 12, white, link and motor independent.

    The stationary covariance solves a discrete Lyapunov equation. Raises ValueError if the closed loop is unstable.
    """
    require_stable(loop)
    deviation = np.array([encoders.link, encoders.motor]) / math.sqrt(12.0)
    scale = balancing(loop.A)
    A = loop.A * scale[None, :] / scale[:, None]
    B = loop.B[:, NOISE : NOISE + 2] * deviation / scale[:, None]
    C = loop.C[TORQUE] * scale
    D = loop.D[TORQUE, NOISE : NOISE + 2] * deviation
    X = solve_discrete_lyapunov(A, B @ B.T)
    variance = C @ X @ C + D @ D
    following = C @ (A @ X @ C + B @ D)
    return TorqueNoise(math.sqrt(max(variance, 0.0)), math.sqrt(max(2.0 * (variance - following), 0.0)))


@dataclass(frozen=True)
class ObserverFigures:
    """What the knob g means here; frequencies in rad/s, NaN where the loop has no such figure."""

    estimate_bandwidth: float  # -3 dB of link disturbance -> its estimate [rad/s]
    motor_estimate_bandwidth: float  # the same for the motor's [rad/s]
    estimate_error_1hz: float  # |1 - estimate| for a link disturbance of 1 Hz
    tracking_error_1hz: float  # error per reference at 1 Hz, all derivatives given [rad/rad]
    disturbance_error_1hz: float  # error per link disturbance at 1 Hz [rad/(N m)]
    noise: TorqueNoise

    def document(self) -> dict[str, Any]:
        """Return plain numbers; None for what does not exist."""
        return {
            "estimate_bandwidth": finite(self.estimate_bandwidth),
            "motor_estimate_bandwidth": finite(self.motor_estimate_bandwidth),
            "estimate_error_1hz": self.estimate_error_1hz,
            "tracking_error_1hz": self.tracking_error_1hz,
            "disturbance_error_1hz": self.disturbance_error_1hz,
            "noise": self.noise.document(),
        }


def observer_figures(loop: LoopModel, encoders: Encoders) -> ObserverFigures:
    """Return the ObserverFigures of `loop` with `encoders`. Raises ValueError if the closed loop is unstable."""
    require_stable(loop)
    half_power = math.sqrt(0.5)

    def at_one_hz(name: str) -> complex:
        return complex(map_at(loop, name, np.array([ONE_HZ]))[0])

    return ObserverFigures(
        first_below(loop, "link_estimate", half_power),
        first_below(loop, "motor_estimate", half_power),
        abs(1.0 - at_one_hz("link_estimate")),
        abs(at_one_hz("reference_to_error")),
        abs(at_one_hz("link_disturbance_to_error")),
        torque_noise(loop, encoders),
    )
