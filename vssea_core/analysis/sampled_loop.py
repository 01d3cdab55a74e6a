"""Stability of the sampled closed loop: the position loop and the stiffness axis, each on its own about rest.

At zero deflection neither moves the other: the spring's torque on the stiffness motor is of second order.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vssea_core.actuator.parameters import Timing
from vssea_core.actuator.spring import stiffness_motor_position
from vssea_core.analysis.assembly import NO_INPUTS, assembled, single_step_plant
from vssea_core.analysis.loop import STABLE_RADIUS, Pieces
from vssea_core.analysis.operating_point import LinearPlant, OperatingPoint
from vssea_core.analysis.probe import STIFFNESS_OBSERVED, STIFFNESS_STATES, probe_stiffness_axis
from vssea_core.control.prepared import prepare
from vssea_core.control.tuning import Tuning

Numbers = NDArray[np.float64]


@dataclass(frozen=True)
class Stability:
    """The largest closed-loop multiplier a sample and its frequency [rad/s]."""

    radius: float
    frequency: float

    @property
    def stable(self) -> bool:
        """Whether every disturbance of the loop dies out."""
        return self.radius < STABLE_RADIUS


def closed_loop_matrix(
    tuning: Tuning, timing: Timing, torque_lag_s: float, stiffness: float, plant: LinearPlant | None = None
) -> Numbers:
    """Return the matrix (n, n) of the sampled position loop at `stiffness` [N m/rad] (loop.LoopModel.A).

    `plant` is the tuning's own model with `torque_lag_s` if None. Raises ValueError if the controller has no linear loop.
    """
    plant = plant or LinearPlant.of_model(tuning, torque_lag_s)
    A, _, _, _ = Pieces(OperatingPoint(tuning, timing, stiffness, plant)).system(plant, NO_INPUTS)
    return A


def stiffness_axis_matrix(
    tuning: Tuning, timing: Timing, stiffness: float, inertia: float | None = None, damping: float | None = None
) -> Numbers:
    """Return the matrix (n, n) of the sampled stiffness axis, Eq. (19), at `stiffness` [N m/rad], the spring unloaded.

    `inertia` [kg m^2] and `damping` [N m s/rad] of the true stiffness motor are the model's if None.
    """
    model, period = tuning.model, timing.sample_time_s
    theta_ms = stiffness_motor_position(stiffness, model.spring_constant)
    numbers = LinearPlant.of_model(tuning).numbers()
    numbers = numbers._replace(
        per_stiffness_inertia=1.0 / (model.stiffness_inertia if inertia is None else inertia),
        stiffness_damping=model.stiffness_damping if damping is None else damping,
        theta_ms_soft=math.inf,
    )
    plant = np.zeros((STIFFNESS_STATES, STIFFNESS_STATES + 1))
    observer = np.zeros((STIFFNESS_OBSERVED, STIFFNESS_OBSERVED + STIFFNESS_STATES + 1))
    law = np.zeros(STIFFNESS_OBSERVED + 1)
    delayed = timing.compute_delay_samples != 0
    probe_stiffness_axis(
        np.array(numbers),
        prepare(tuning, period, (stiffness, stiffness)),
        theta_ms,
        period,
        delayed,
        plant,
        observer,
        law,
    )
    whole = single_step_plant(plant, STIFFNESS_STATES)
    measured, estimates = np.arange(STIFFNESS_STATES), np.zeros(2, dtype=np.int64)
    A: Numbers = assembled(whole, measured, observer, law, estimates, 0, False, delayed, NO_INPUTS)[0]
    return A


def stability(
    tuning: Tuning, timing: Timing, torque_lag_s: float, stiffness: float, plant: LinearPlant | None = None
) -> Stability:
    """Return the Stability of the sampled loop at `stiffness` [N m/rad]: the worse of position loop and stiffness axis."""
    position = _stability(closed_loop_matrix(tuning, timing, torque_lag_s, stiffness, plant), timing)
    return max(position, stiffness_axis_stability(tuning, timing, stiffness), key=lambda each: each.radius)


def stiffness_axis_stability(tuning: Tuning, timing: Timing, stiffness: float) -> Stability:
    """Return the Stability of the stiffness axis alone, on the tuning's own model."""
    return _stability(stiffness_axis_matrix(tuning, timing, stiffness), timing)


def _stability(matrix: Numbers, timing: Timing) -> Stability:
    if not np.isfinite(matrix).all():
        return Stability(math.inf, 0.0)
    multipliers = np.linalg.eigvals(matrix)
    largest = multipliers[np.argmax(np.abs(multipliers))]
    return Stability(float(abs(largest)), float(abs(np.angle(largest)) / timing.sample_time_s))
