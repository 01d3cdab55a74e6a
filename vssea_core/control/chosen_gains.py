"""Which gains a controller's document asks for, at one stiffness."""

import numpy as np
from numpy.typing import NDArray

from vssea_core.control import design, lqr
from vssea_core.control.law import GAINS
from vssea_core.control.linear_model import LinearModel
from vssea_core.control.tuning import Baseline, NoObserver, PlantWeights, SlidingMode, StateFeedback, Tuning

Numbers = NDArray[np.float64]


def follows_stiffness(tuning: Tuning) -> bool:
    """Return whether any gain depends on the stiffness: by the schedule, or because the design knows the plant."""
    controller, schedule = tuning.controller, tuning.schedule
    scheduled_poles = schedule.poles_exponent != 0.0
    scheduled_bandwidth = schedule.bandwidth_exponent != 0.0 and not isinstance(tuning.observer, NoObserver)
    if isinstance(controller, StateFeedback):
        knows_plant = controller.sampled or controller.design == "lqr_plant"
        return scheduled_bandwidth or knows_plant or (scheduled_poles and controller.design == "poles")
    return scheduled_bandwidth or scheduled_poles or isinstance(controller, Baseline)


def chosen_gains(tuning: Tuning, stiffness: float, sample_time_s: float) -> Numbers:
    """Return k1..k4, s1..s3, x1..x4 and N_r (GAINS) of the controller at `stiffness` [N m/rad].

    Raises ValueError if a design has no solution.
    """
    controller, model = tuning.controller, tuning.model
    plant = LinearModel(model.link_inertia, model.link_damping, model.motor_inertia, model.motor_damping, stiffness)
    share = (stiffness / tuning.schedule.reference_stiffness) ** tuning.schedule.poles_exponent
    gains = np.zeros(GAINS)
    if isinstance(controller, SlidingMode):
        gains[4:7] = design.surface_gains(controller.surface_pole * share)
    elif isinstance(controller, Baseline):
        chain = _baseline(controller, plant, share)
        gains[7:11] = design.plant_gains(plant, chain)
        gains[11] = plant.torque_per_snap * chain[0]  # N_r = -1/(C (A - B K)^-1 B)
    else:
        gains[:4] = _chain(controller, plant, share, sample_time_s)
        gains[4:7] = design.surface_gains(controller.natural_frequency * share)  # sigma is shown in either law
    return gains


def _chain(controller: StateFeedback, plant: LinearModel, share: float, sample_time_s: float) -> Numbers:
    if controller.design == "poles":
        gains = design.state_feedback_gains(controller.natural_frequency * share, controller.damping)
    elif controller.design == "lqr_chain":
        weights = (
            controller.error_weight,
            controller.error_velocity_weight,
            controller.error_acceleration_weight,
            controller.error_jerk_weight,
        )
        gains = lqr.lqr_chain_gains(weights, controller.snap_weight)
    else:
        gains = _lqr_on_plant(controller, plant)
    if not controller.sampled:
        return gains
    poles: NDArray[np.complex128] = np.roots([1.0, *gains[::-1]]).astype(complex)
    return design.exact_sampled_gains(plant, poles, sample_time_s)


def _baseline(controller: Baseline, plant: LinearModel, share: float) -> Numbers:
    if controller.design == "lqr_plant":
        return _lqr_on_plant(controller, plant)
    return design.state_feedback_gains(controller.natural_frequency * share, controller.damping)


def _lqr_on_plant(controller: PlantWeights, plant: LinearModel) -> Numbers:
    """Return the chain's K (4) with the closed-loop poles of the LQR on (A, B)."""
    weights = (
        controller.link_position_weight,
        controller.link_velocity_weight,
        controller.motor_position_weight,
        controller.motor_velocity_weight,
    )
    return design.chain_gains_of_poles(lqr.lqr_plant_poles(plant, weights, controller.torque_weight))
