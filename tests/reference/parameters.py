"""Values a reference simulation needs, as plain dataclasses; gear side, SI units, radians."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf, pi
from typing import Literal

import numpy as np


@dataclass(frozen=True)
class Plant:
    """Physical parameters of Eqs. (1)-(4); used once for the true plant and once for the controller's model."""

    link_inertia: float = 0.10  # J_l [kg m^2]
    link_damping: float = 0.10  # b_l [N m s/rad]
    motor_inertia: float = 3.17  # J_e [kg m^2]
    motor_damping: float = 4.0  # b_e [N m s/rad]
    coulomb_friction: float = 0.0  # F_c [N m]
    friction_velocity: float = 5e-3  # eps in v / sqrt(v^2 + eps^2) [rad/s]
    spring_constant: float = 6.2e7  # Y_tau [N m rad^3]
    stiffness_inertia: float = 1.0e-4  # J_ms [kg m^2]
    stiffness_damping: float = 1.0e-4  # b_ms [N m s/rad]
    torque_lag_s: float = 0.0  # 0 = none
    spring: Literal["sine", "linear"] = "sine"
    back_torque: Literal["energy", "paper"] = "energy"

    def stiffness_motor_position(self, stiffness: float) -> float:
        """theta_ms [rad] that gives `stiffness` [N m/rad] at zero deflection, from Eq. (4)."""
        return float(np.cbrt(self.spring_constant / (2.0 * stiffness)))


@dataclass(frozen=True)
class Limits:
    """Torque limits [N m]; speed limit |tau| <= stall (1 - |omega| / no_load) while tau omega > 0."""

    peak_torque: float = inf
    stall_torque: float = inf
    no_load_speed: float = inf
    stiffness_peak_torque: float = inf


@dataclass(frozen=True)
class Encoders:
    """Angle per count [rad], gear side; 0 = ideal."""

    link: float = 0.0
    motor: float = 0.0
    stiffness_motor: float = 0.0

    @staticmethod
    def of_hardware(link_bits: int = 17, motor_counts: int = 16384, gear_ratio: float = 100.0) -> Encoders:
        """Encoders of the actuator: link `link_bits`, both motors `motor_counts` a motor revolution."""
        return Encoders(2 * pi / 2**link_bits, 2 * pi / (motor_counts * gear_ratio), 2 * pi / motor_counts)


@dataclass(frozen=True)
class Controller:
    """Tuning of law and observers (sections 2-5 of the theory)."""

    form: Literal["velocity", "position"] = "velocity"
    method: Literal["exact", "first_order_hold"] = "exact"  # velocity form only
    observer_bandwidth: float = 100.0  # g [rad/s]
    stiffness_observer_bandwidth: float = 100.0  # g of the stiffness channel [rad/s]
    law: Literal["state_feedback", "sliding_mode"] = "state_feedback"
    pole: float = 20.0  # w in (s^2 + 2 zeta w s + w^2)^2 [rad/s]
    damping: float = 1.0  # zeta
    surface_pole: float = 20.0  # p in (s + p)^3 [rad/s]
    switching_gain: float = 5e4  # rho [rad/s^4]
    boundary_layer: float = 500.0  # phi [rad/s^3]; 0 = sgn
    stiffness_pole: float = 120.0  # w of the stiffness loop [rad/s]
    stiffness_damping: float = 1.0  # z of the stiffness loop
    stiffness_terms: Literal["all", "rate", "none"] = "all"  # theta_ms terms kept in tau_s' and R
    algebraic_loop: Literal["solved", "previous"] = "solved"  # previous = the last sample's torque inside Pi_2''
    torque_feed: Literal["applied", "commanded"] = "applied"  # commanded = unlimited, to show wind-up
    difference_filter: float = 0.0  # [rad/s] bandwidth of filtered encoder differences; 0 = velocities are measured

    def feedback_gains(self) -> np.ndarray:
        """K = [k1..k4] of Eq. (9) from (s^2 + 2 zeta w s + w^2)^2; shape (4,)."""
        pair = np.array([1.0, 2 * self.damping * self.pole, self.pole**2])
        return np.convolve(pair, pair)[:0:-1]

    def surface_gains(self) -> np.ndarray:
        """[s1, s2, s3] of Eq. (14) from (s + p)^3; shape (3,)."""
        return np.poly([-self.surface_pole] * 3)[:0:-1]


@dataclass(frozen=True)
class Term:
    """One disturbance term [N m]: constant, or amplitude sin(2 pi f t + phase) with absolute t."""

    amplitude: float
    frequency_hz: float = 0.0
    phase: float = 0.0
    start_s: float = 0.0
    end_s: float = inf
    kind: Literal["constant", "sine"] = "constant"


@dataclass(frozen=True)
class Reference:
    """Link reference: kind, size [rad] and times; `start_s` and `duration_s` belong to move and step."""

    kind: Literal["sine", "move", "step"] = "sine"
    amplitude: float = 0.0
    frequency_hz: float = 0.25
    offset: float = 0.0
    fade_s: float = 0.0
    start_s: float = 0.0
    duration_s: float = 1.0


@dataclass(frozen=True)
class StiffnessReference:
    """Commanded stiffness [N m/rad]: constant `start`, or moved to `end` over `duration_s` from `start_s`."""

    start: float = 200.0
    end: float | None = None
    start_s: float = 0.0
    duration_s: float = 1.0
    filter_bandwidth: float = 100.0  # w_f [rad/s]


@dataclass(frozen=True)
class Config:
    """Everything one closed-loop run needs."""

    plant: Plant = field(default_factory=Plant)
    model: Plant | None = None  # None: the plant without Coulomb friction
    limits: Limits = field(default_factory=Limits)
    encoders: Encoders = field(default_factory=Encoders)
    controller: Controller = field(default_factory=Controller)
    reference: Reference = field(default_factory=Reference)
    stiffness: StiffnessReference = field(default_factory=StiffnessReference)
    link_disturbance: tuple[Term, ...] = ()
    motor_disturbance: tuple[Term, ...] = ()
    stiffness_disturbance: tuple[Term, ...] = ()
    sample_time_s: float = 1e-3
    duration_s: float = 1.0
    delay_samples: int = 0
    initial_state: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)  # theta_l, omega_l, theta_e, omega_e
    initial_torque: float = 0.0  # torque applied before the first tick [N m]
    integrator: Literal["dop853", "rk"] = "dop853"
