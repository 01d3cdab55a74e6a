"""Where a loop is analysed: a tuning, its timing, a commanded stiffness, and the plant it meets there."""

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Self

import numpy as np
from numpy.typing import NDArray

from vssea_core.actuator.dynamics import Plant, lag_shares
from vssea_core.actuator.parameters import Actuator, Timing
from vssea_core.actuator.spring import stiffness_motor_position
from vssea_core.control.tuning import SlidingMode, Tuning
from vssea_core.simulation.state import plant_numbers


@dataclass(frozen=True)
class LinearPlant:
    """True parameters of the position loop about rest (SI, gear side); dry friction is left out."""

    link_inertia: float
    link_damping: float
    motor_inertia: float
    motor_damping: float
    spring_constant: float
    torque_lag_s: float = 0.0
    torque_delay_s: float = 0.0  # transport delay between the drive's command and its torque, any fraction of a sample

    @classmethod
    def of_model(cls, tuning: Tuning, torque_lag_s: float = 0.0, torque_delay_s: float = 0.0) -> Self:
        """Return the plant that the controller believes in, with a lag and a delay of the torque [s]."""
        model = tuning.model
        return cls(
            model.link_inertia,
            model.link_damping,
            model.motor_inertia,
            model.motor_damping,
            model.spring_constant,
            torque_lag_s,
            torque_delay_s,
        )

    @classmethod
    def of_actuator(cls, actuator: Actuator) -> Self:
        """Return the actuator as it is."""
        link, motor, mechanism = actuator.link, actuator.motor, actuator.stiffness
        return cls(
            link.inertia, link.damping, motor.inertia, motor.damping, mechanism.spring_constant, motor.torque_lag_s,
            motor.torque_delay_s,
        )  # fmt: skip

    def scaled(self, **factors: float) -> Self:
        """Return this plant with fields multiplied by `factors`, e.g. scaled(link_inertia=1.2)."""
        return replace(self, **{name: getattr(self, name) * factor for name, factor in factors.items()})

    def with_delay(self, delay_s: float) -> Self:
        """Return this plant with `delay_s` [s] more transport delay."""
        return replace(self, torque_delay_s=self.torque_delay_s + delay_s)

    def lag(self, step_s: float) -> NDArray[np.float64]:
        """Return the LagShares (11,) of a step of `step_s` [s]. Do not change it: it is kept."""
        return _lag_row(self.torque_lag_s, self.motor_inertia, self.motor_damping, step_s)

    def numbers(self) -> Plant:
        """Return the numbers of the kernel's plant: no dry friction, no end stops."""
        return _FRICTIONLESS._replace(
            per_link_inertia=1.0 / self.link_inertia,
            link_damping=self.link_damping,
            per_motor_inertia=1.0 / self.motor_inertia,
            motor_damping=self.motor_damping,
            spring_constant=self.spring_constant,
        )


@lru_cache(maxsize=1024)
def _lag_row(lag_s: float, inertia: float, damping: float, step_s: float) -> NDArray[np.float64]:
    return np.array(lag_shares(lag_s, 1.0 / inertia, damping, step_s))


_FRICTIONLESS = plant_numbers(Actuator(), 1e-3)._replace(
    coulomb_friction=0.0, theta_ms_stiff=0.0, theta_ms_soft=math.inf, paper_back_torque=0.0, substeps=1.0
)


@dataclass(frozen=True)
class OperatingPoint:
    """A loop to analyse: `stiffness` is the commanded one [N m/rad], at rest, at zero deflection, unlimited."""

    tuning: Tuning
    timing: Timing
    stiffness: float
    plant: LinearPlant

    @property
    def theta_ms(self) -> float:
        """Position of the stiffness motor [rad]: the controller commands it through its own model of the spring."""
        return stiffness_motor_position(self.stiffness, self.tuning.model.spring_constant)

    @property
    def period_s(self) -> float:
        """Sample time T [s]."""
        return self.timing.sample_time_s


def at_model(tuning: Tuning, timing: Timing, stiffness: float, torque_lag_s: float = 0.0) -> OperatingPoint:
    """Return the OperatingPoint of `tuning` on its own model at `stiffness` [N m/rad]."""
    return OperatingPoint(tuning, timing, stiffness, LinearPlant.of_model(tuning, torque_lag_s))


def note_on_linearity(tuning: Tuning) -> str | None:
    """Return what the reader of a linear result has to know of this controller, or None.

    Raises ValueError if the controller has no linear loop.
    """
    controller = tuning.controller
    if not isinstance(controller, SlidingMode):
        return None
    if controller.switch not in LAYERED:
        raise ValueError(
            f"sliding mode with {controller.switch} has no linearisation; choose a boundary layer to analyse it"
        )
    return (
        "sliding mode is linear inside its boundary layer only, where it is state feedback with gain "
        f"ρ/φ = {controller.switching_gain / controller.layer_width:.4g} 1/s"
    )


LAYERED = ("layer", "tanh")
"""Switching functions with a finite slope at zero."""
