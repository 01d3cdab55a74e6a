"""With perfect estimates the error obeys e' = (Gamma - b K^T) e; the sampled loop tends to it as the sample time shrinks."""

import numpy as np
import pytest
from scipy.linalg import expm

from vssea_core.actuator.parameters import Timing
from vssea_core.control.design import state_feedback_gains, surface_gains
from vssea_core.control.tuning import Controller, SlidingMode, StateFeedback, Tuning
from vssea_core.scenario import Initial, Scenario
from vssea_core.signals.documents import ConstantStiffness, StepReference
from vssea_core.simulation.run import simulate

OFFSET = 0.2  # rad
SAMPLE_TIMES = (1e-3, 5e-4, 2.5e-4, 1.25e-4)
SURFACE, LAYER, SLOPE = 5.0, 1000.0, 9.0


def companion(gains: np.ndarray) -> np.ndarray:
    """Gamma - b K^T: a chain of four integrators, closed by `gains` (4,)."""
    closed = np.diag(np.ones(3), 1)
    closed[3] -= gains
    return closed


def layered_gains() -> np.ndarray:
    """The law inside the layer: nu = s1 e2 + s2 e3 + s3 e4 + l sigma with l = rho/phi."""
    s1, s2, s3 = surface_gains(SURFACE)
    return np.array([SLOPE * s1, s1 + SLOPE * s2, s2 + SLOPE * s3, s3 + SLOPE])


LAWS = {
    "quadruple pole": (StateFeedback(natural_frequency=8.0), state_feedback_gains(8.0, 1.0)),
    "oscillating pairs": (StateFeedback(natural_frequency=8.0, damping=0.5), state_feedback_gains(8.0, 0.5)),
    "inside the sliding layer": (
        SlidingMode(surface_pole=SURFACE, layer_width=LAYER, switching_gain=SLOPE * LAYER),
        layered_gains(),
    ),
}


def gap_from_ideal(law: Controller, gains: np.ndarray, sample_time: float, stiffness: float) -> float:
    """Largest |error - ideal error| [rad] over 1.5 s from an offset at rest."""
    scenario = Scenario(
        timing=Timing(sample_time_s=sample_time),
        tuning=Tuning(controller=law),
        reference=StepReference(origin=0.0, target=0.0),
        stiffness_reference=ConstantStiffness(stiffness=stiffness),
        initial=Initial(link_position=OFFSET),
        duration_s=1.5,
    )
    run = simulate(scenario)
    assert not run["limits"].any(), "the law is linear only without limits"
    if isinstance(law, SlidingMode):
        assert np.abs(run["sliding_variable"]).max() < LAYER
    step = expm(companion(gains) * sample_time)
    ideal, error = np.empty(len(run)), np.array([-OFFSET, 0.0, 0.0, 0.0])
    for k in range(len(run)):
        ideal[k] = error[0]
        error = step @ error
    return float(np.abs(run["error"] - ideal).max())


@pytest.mark.parametrize(("law", "gains"), LAWS.values(), ids=LAWS)
def test_the_error_tends_to_the_ideal_dynamics_with_the_first_order_of_the_sample_time(
    law: Controller, gains: np.ndarray
) -> None:
    gaps = np.array([gap_from_ideal(law, gains, sample_time, 200.0) for sample_time in SAMPLE_TIMES])
    ratios = gaps[:-1] / gaps[1:]
    assert gaps[-1] < 0.005 * OFFSET
    assert np.all(ratios > 1.95)
    assert np.all(ratios < 2.05)


@pytest.mark.parametrize(("stiffness", "pole"), [(25.0, 5.0), (950.0, 8.0)])
def test_the_ideal_dynamics_hold_near_either_end_of_the_stiffness_range(stiffness: float, pole: float) -> None:
    law, gains = StateFeedback(natural_frequency=pole), state_feedback_gains(pole, 1.0)
    coarse, fine = (gap_from_ideal(law, gains, sample_time, stiffness) for sample_time in (1e-3, 1.25e-4))
    assert coarse < 0.02 * OFFSET
    assert coarse / fine == pytest.approx(8.0, rel=0.05)
