"""The sampled position loop of an operating point as matrices: closed, and broken at either place."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vssea_core.analysis.assembly import (
    BREAKS,
    INPUTS,
    LIMITER,
    LINK_DISTURBANCE,
    MOTOR_DISTURBANCE,
    PLANT_TORQUE,
    TORQUE,
    assembled,
    joined_plant,
    kept_entries,
    single_step_plant,
)
from vssea_core.analysis.operating_point import LinearPlant, OperatingPoint, note_on_linearity
from vssea_core.analysis.probe import (
    LAW_COLUMNS,
    LINK_ESTIMATE,
    MEASURED,
    MOTOR_ESTIMATE,
    OBSERVED,
    OBSERVER_COLUMNS,
    OUTPUTS_OF_PLANT,
    PLANT_COLUMNS,
    PLANT_NAMES,
    PLANT_STATES,
    POSITION_NAMES,
    probe_controller,
    probe_plant,
)
from vssea_core.control.prepared import prepare

Numbers = NDArray[np.float64]
System = tuple[Numbers, Numbers, Numbers, Numbers]

INPUT_NAMES = (
    "plant_torque", "limiter_torque", "link_disturbance", "motor_disturbance",
    "reference", "reference_rate", "reference_acceleration", "reference_jerk", "reference_snap",
    "link_position_noise", "motor_position_noise", "link_velocity_noise", "motor_velocity_noise",
)  # fmt: skip
OUTPUT_NAMES = ("torque", "link_position", "link_disturbance_estimate", "motor_disturbance_estimate")
_MEASURED = np.array(MEASURED)
_ESTIMATES = np.array([LINK_ESTIMATE, MOTOR_ESTIMATE])
WHOLE_SAMPLE = 1e-9  # a delay this close [samples] to a whole number is one


@dataclass(frozen=True)
class LoopModel:
    """xi+ = A xi + B w, z = C xi + D w of the closed loop, with the state just after the observers ran.

    Inputs (INPUT_NAMES): torque added at the plant alone [N m]; torque added at the limiter, to plant and observer [N m];
    disturbances [N m], constant over each period; reference and derivatives [rad, rad/s ...]; measurement noise. Outputs
    (OUTPUT_NAMES): demanded torque [N m], link position [rad], disturbance estimates [N m].
    """

    A: Numbers
    B: Numbers
    C: Numbers
    D: Numbers
    states: tuple[str, ...]
    period_s: float
    compute_delay: bool
    note: str | None = None
    looks_ahead: bool = False  # the reference inputs are those of a sample later, as a compensated delay asks for them

    inputs = INPUT_NAMES
    outputs = OUTPUT_NAMES

    @cached_property
    def multipliers(self) -> NDArray[np.complex128]:
        """Eigenvalues (n,) of A: discrete poles of the closed loop."""
        return np.linalg.eigvals(self.A).astype(np.complex128)

    @property
    def radius(self) -> float:
        """Largest |multiplier|; infinite if a number of the loop is."""
        return float(np.abs(self.multipliers).max()) if np.isfinite(self.A).all() else math.inf

    @property
    def stable(self) -> bool:
        """Whether every disturbance of the loop dies out."""
        return self.radius < STABLE_RADIUS

    def broken_at_plant(self) -> System:
        """Return A, B, C, D from the plant's torque to minus the drive's: the observer keeps its own command."""
        return self._broken(PLANT_TORQUE)

    def broken_at_limiter(self) -> System:
        """Return A, B, C, D from the limited torque, fed to plant and observer alike, to minus the demanded one."""
        return self._broken(LIMITER)

    def _broken(self, place: int) -> System:
        into = self.B[:, place : place + 1]
        torque = self.C[TORQUE : TORQUE + 1]
        if place == PLANT_TORQUE and self.compute_delay:  # what reaches the drive is the command of a sample ago
            torque = np.zeros((1, len(self.A)))
            torque[0, self.states.index("delayed_torque")] = 1.0
        return self.A - into @ torque, into.copy(), -torque, np.zeros((1, 1))


STABLE_RADIUS = 1.0 - 1e-9


class Pieces:
    """The probed controller of an operating point, put together with any plant: for maps and searches."""

    def __init__(self, point: OperatingPoint) -> None:
        self.note = note_on_linearity(point.tuning)
        self.point = point
        self.period_s, self.theta_ms = point.period_s, point.theta_ms
        self.compute_delay = point.timing.compute_delay_samples != 0
        self.observer, self.law = np.zeros((OBSERVED, OBSERVER_COLUMNS)), np.zeros(LAW_COLUMNS)
        gains = prepare(point.tuning, self.period_s, (point.stiffness, point.stiffness))
        probe_controller(gains, self.theta_ms, self.compute_delay, self.observer, self.law)

    def system(self, plant: LinearPlant, inputs: int = INPUTS) -> System:
        """Return A, B, C, D with `plant` and the first `inputs` inputs (assembly.NO_INPUTS, BREAKS or INPUTS)."""
        whole, fraction = delay_in_samples(plant.torque_delay_s, self.period_s)
        columns = plant_over_period(plant, self.theta_ms, self.period_s, fraction)
        result: System = assembled(
            columns, _MEASURED, self.observer, self.law, _ESTIMATES, whole, fraction > 0.0, self.compute_delay, inputs
        )
        return result

    def model(self, plant: LinearPlant) -> LoopModel:
        """Return the LoopModel with `plant`."""
        A, B, C, D = self.system(plant)
        model = self.point.tuning.model
        for row, inertia in ((LINK_DISTURBANCE, model.link_inertia), (MOTOR_DISTURBANCE, model.motor_inertia)):
            C[row] *= inertia
            D[row] *= inertia
        ahead = self.compute_delay and self.point.tuning.observer.predict
        return LoopModel(A, B, C, D, self._states(plant), self.period_s, self.compute_delay, self.note, ahead)

    def _states(self, plant: LinearPlant) -> tuple[str, ...]:
        kept = kept_entries(self.observer, OUTPUTS_OF_PLANT)
        whole, fraction = delay_in_samples(plant.torque_delay_s, self.period_s)
        return (
            *PLANT_NAMES[: states_of_plant(plant)],
            *(name for name, keep in zip(POSITION_NAMES, kept, strict=True) if keep),
            *(f"torque_{late + 1}_late" for late in range(whole + (fraction > 0.0))),
            *(("delayed_torque",) if self.compute_delay else ()),
        )


def loop_model(point: OperatingPoint) -> LoopModel:
    """Return the LoopModel of `point`. Raises ValueError if the controller has no linear loop."""
    return Pieces(point).model(point.plant)


def states_of_plant(plant: LinearPlant) -> int:
    """Return how many states the plant has: the motor's torque is one only where it lags."""
    return PLANT_STATES if plant.torque_lag_s > 0.0 else PLANT_STATES - 1


def delay_in_samples(delay_s: float, period_s: float) -> tuple[int, float]:
    """Return a delay as whole samples and a rest in [0, 1)."""
    samples = delay_s / period_s
    whole = math.floor(samples + WHOLE_SAMPLE)
    return whole, max(0.0, samples - whole) if samples - whole > WHOLE_SAMPLE else 0.0


def plant_over_period(plant: LinearPlant, theta_ms: float, period_s: float, fraction: float) -> Numbers:
    """Return the plant (nx, nx + 4) over a period in which the torque changes after `fraction` of it (assembly)."""
    row = np.array(plant.numbers())
    states = states_of_plant(plant)
    second = _step(row, plant, theta_ms, (1.0 - fraction) * period_s)
    if fraction == 0.0:
        single: Numbers = single_step_plant(second, states)
        return single
    joined: Numbers = joined_plant(_step(row, plant, theta_ms, fraction * period_s), second, states)
    return joined


def _step(row: Numbers, plant: LinearPlant, theta_ms: float, step_s: float) -> Numbers:
    columns = np.zeros((PLANT_STATES, PLANT_COLUMNS))
    probe_plant(row, plant.lag(step_s), theta_ms, step_s, columns)
    return columns


__all__ = [
    "BREAKS", "INPUTS", "LoopModel", "Pieces", "System", "delay_in_samples", "loop_model", "plant_over_period",
    "states_of_plant", "STABLE_RADIUS",
]  # fmt: skip
