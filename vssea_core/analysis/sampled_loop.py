"""The sampled closed loop, linearised: how the state of one tick follows from that of the tick before.

The matrix is taken from the compiled closed loop itself, by central differences about equilibrium, so what is analysed is
what runs: any controller, observer, delay, lag and stiffness. Encoders are ideal, limits off and dry friction absent.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vssea_core.actuator.drive import Drives
from vssea_core.actuator.dynamics import Plant
from vssea_core.actuator.parameters import Timing
from vssea_core.actuator.sensors import Encoders
from vssea_core.actuator.spring import stiffness_motor_position
from vssea_core.channels import CHANNELS
from vssea_core.control.prepared import prepare
from vssea_core.control.tuning import ControllerModel, SlidingMode, Tuning
from vssea_core.signals.documents import StepReference
from vssea_core.signals.references import reference_row
from vssea_core.signals.stiffness import SLEW_SIZE, SLEWED_SIZE, Slew
from vssea_core.simulation.kernel import run
from vssea_core.simulation.state import APPLIED, MEMORY, PENDING, SLEWED, STATE_SIZE, rig_numbers

Numbers = NDArray[np.float64]

UNLIMITED = Drives(1e12, 1e12, 1e12, 0.0, 1e12, 1e12, 1e12, 0.0, 1e36)
STEP_OF_CHANNEL = (1e-5, 1e-3, 1e-1, 1e1, 1e3, 1e-5)
STABLE_RADIUS = 1.0 - 1e-9


@dataclass(frozen=True)
class Stability:
    """The largest closed-loop multiplier a sample and its frequency [rad/s]."""

    radius: float
    frequency: float

    @property
    def stable(self) -> bool:
        """Whether every disturbance of the loop dies out."""
        return self.radius < STABLE_RADIUS


def model_plant(model: ControllerModel) -> Plant:
    """Return the plant that the controller believes in."""
    return Plant(
        1.0 / model.link_inertia,
        model.link_damping,
        1.0 / model.motor_inertia,
        model.motor_damping,
        0.0,
        1.0,
        model.spring_constant,
        1.0 / model.stiffness_inertia,
        model.stiffness_damping,
        0.0,
        math.inf,
        0.0,
        1.0,
    )


def closed_loop_matrix(
    tuning: Tuning, timing: Timing, torque_lag_s: float, stiffness: float, plant: Plant | None = None
) -> Numbers:
    """Return the matrix (n, n) of the sampled loop at `stiffness` [N m/rad]; `plant` is the tuning's own model if None.

    Sliding mode is linear inside its boundary layer only; with sgn there is no such matrix, and ValueError is raised.
    """
    controller = tuning.controller
    if isinstance(controller, SlidingMode) and controller.switch in ("sgn", "super_twisting"):
        raise ValueError(
            f"sliding mode with {controller.switch} has no linearisation; choose a boundary layer to analyse it"
        )
    plant = plant or model_plant(tuning.model)
    theta_ms = stiffness_motor_position(stiffness, tuning.model.spring_constant)
    rig = rig_numbers(plant, UNLIMITED, Encoders(0.0, 0.0, 0.0), torque_lag_s, timing)
    prepared = prepare(tuning, timing.sample_time_s, (stiffness, stiffness))
    still = reference_row(StepReference(origin=0.0, target=0.0))
    slew = np.zeros(SLEW_SIZE)
    slew[:] = Slew(0.0, theta_ms, theta_ms, 0.0, 1.0, 0.0, 1.0, 1.0, 1e12, 1.0, 1.0, tuning.model.spring_constant)
    rows, loads = np.empty((1, len(CHANNELS))), np.empty((0, 16))

    def after_one_sample(state: Numbers) -> Numbers:
        following = state.copy()
        run(rig, prepared, prepared, still, slew, loads, loads, loads, True, 0.0, following, 0, 1, rows)
        return following

    rest = np.zeros(STATE_SIZE)
    rest[4] = theta_ms
    rest[SLEWED : SLEWED + SLEWED_SIZE] = theta_ms, theta_ms, 0.0, 0.0
    rest = after_one_sample(rest)
    sizes = _differences(theta_ms, bool(timing.compute_delay_samples))
    entries = np.array(list(sizes))
    matrix = np.empty((len(entries), len(entries)))
    for column, (entry, size) in enumerate(sizes.items()):
        ahead, behind = rest.copy(), rest.copy()
        ahead[entry] += size
        behind[entry] -= size
        matrix[:, column] = (after_one_sample(ahead)[entries] - after_one_sample(behind)[entries]) / (2.0 * size)
    return matrix


def _differences(theta_ms: float, delayed: bool) -> dict[int, float]:
    """Return the entries of the state that carry the loop, and the difference taken in each.

    Plant, torques under way, observers and the remembered spring; differences small against the spring's curvature and
    large against rounding.
    """
    plant = (1e-5, 1e-3, 1e-5, 1e-3, 1e-4, 1e-2, 1e-2)
    controller = (*STEP_OF_CHANNEL * 3, 1e-5 / theta_ms**3, 1e-5 / theta_ms**4)
    sizes = dict(enumerate(plant))
    sizes |= {APPLIED: 1e-2, APPLIED + 1: 1e-2}
    if delayed:
        sizes |= {PENDING: 1e-2, PENDING + 1: 1e-2}
    return sizes | {MEMORY + place: size for place, size in enumerate(controller)}


def stability(
    tuning: Tuning, timing: Timing, torque_lag_s: float, stiffness: float, plant: Plant | None = None
) -> Stability:
    """Return the Stability of the sampled loop at `stiffness` [N m/rad] (see closed_loop_matrix)."""
    matrix = closed_loop_matrix(tuning, timing, torque_lag_s, stiffness, plant)
    if not np.isfinite(matrix).all():
        return Stability(math.inf, 0.0)
    poles = np.linalg.eigvals(matrix)
    largest = poles[np.argmax(np.abs(poles))]
    return Stability(float(abs(largest)), float(abs(np.angle(largest)) / timing.sample_time_s))
