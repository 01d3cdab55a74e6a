"""The linearised sampled loop: the reference's matrix, the growth of simulations, and a refusal whose remedy works."""

import re

import numpy as np
import pytest

from tests.core.as_reference import reference_controller, reference_model
from tests.core.experiment import Experiment
from tests.reference.linear import closed_loop_matrix as reference_matrix
from vssea_core.actuator.parameters import Actuator, Link, Timing
from vssea_core.analysis.operating_point import LinearPlant
from vssea_core.analysis.refusal import unstable_because
from vssea_core.analysis.sampled_loop import closed_loop_matrix, stability, stiffness_axis_matrix
from vssea_core.control.tuning import (
    ControllerModel,
    Observer,
    PositionObserver,
    SlidingMode,
    StateFeedback,
    StiffnessLoop,
    Tuning,
    VelocityObserver,
)
from vssea_core.scenario import Scenario
from vssea_core.scenarios import NOMINAL, REALISTIC
from vssea_core.signals.documents import ConstantStiffness, StepReference
from vssea_core.simulation.metrics import metrics

OBSERVERS: dict[str, Observer] = {
    "exact": VelocityObserver(bandwidth=80.0),
    "first_order_hold": VelocityObserver(bandwidth=80.0, discretisation="first_order_hold"),
    "position": PositionObserver(bandwidth=80.0),
}
observers = pytest.mark.parametrize("observer", OBSERVERS.values(), ids=OBSERVERS)
HEAVY = Actuator(link=Link(inertia=0.3))
HEAVY_PLANT = LinearPlant.of_actuator(HEAVY)


def scaled_difference(found: np.ndarray, expected: np.ndarray, plant_states: int) -> float:
    """Largest difference of two loop matrices in like units: angles [rad], with 1 ms and 100 rad/s as units of time."""
    units = [1.0, 1e2, 1.0, 1e2, *[1e2] * (plant_states - 4)]
    channel = [1e2, 1e4, 1e6] if len(found) < 14 else [1.0, 1e2, 1e2, 1e4, 1e6]
    units += [*channel, *channel]
    units += [1e2] * (len(found) - len(units))
    scale = np.array(units)
    difference = (found - expected) / scale[:, None] * scale[None, :]
    size = np.abs(expected / scale[:, None] * scale[None, :]).max()
    return float(np.abs(difference).max() / size)


@observers
@pytest.mark.parametrize("delay", [0, 1])
@pytest.mark.parametrize(("lag", "tolerance"), [(0.0, 1e-9), (1.6e-4, 1e-6)], ids=["no lag", "lag"])
@pytest.mark.parametrize("inertia", [0.1, 0.14])
def test_the_matrix_is_that_of_the_reference(
    observer: Observer, delay: int, lag: float, tolerance: float, inertia: float
) -> None:
    """The lag's tolerance is the kernel's integrator of order 5, which meets an exponential of 0.16 ms in a step of 1 ms."""
    tuning = Tuning(observer=observer)
    plant = LinearPlant.of_model(tuning, lag).scaled(link_inertia=inertia / 0.1, motor_damping=1.5)
    matrix = closed_loop_matrix(tuning, Timing(compute_delay_samples=delay), lag, 200.0, plant)
    model = reference_model(tuning)
    true = type(model)(link_inertia=inertia, motor_damping=6.0, torque_lag_s=lag)
    expected = reference_matrix(reference_controller(tuning), true, model, 200.0, 200.0, 1e-3, delay)
    assert matrix.shape == expected.shape
    assert scaled_difference(matrix, expected, 5 if lag else 4) < tolerance


def test_inside_the_layer_the_matrix_is_that_of_the_references_sliding_law() -> None:
    tuning = Tuning(controller=SlidingMode(switching_gain=2e4))
    matrix = closed_loop_matrix(tuning, Timing(), 0.0, 200.0)
    model = reference_model(tuning)
    expected = reference_matrix(reference_controller(tuning), model, model, 200.0, 200.0, 1e-3, 0)
    assert scaled_difference(matrix, expected, 4) < 1e-9


@observers
def test_an_unstable_simulation_grows_by_the_radius(observer: Observer) -> None:
    """Link three times as heavy as believed, one sample of delay: small signals grow as the matrix says."""
    timing = Timing(compute_delay_samples=1)
    tuning = Tuning(observer=observer)
    found = stability(tuning, timing, 0.0, 200.0, HEAVY_PLANT)
    assert not found.stable
    assert found.radius > 1.003
    scenario = Scenario(actuator=HEAVY, timing=timing, tuning=tuning, reference=StepReference(origin=0.0, target=0.0))
    experiment = Experiment(scenario)
    experiment.state[0] = experiment.state[2] = 1e-9
    y = experiment.advance(1600)["link_position"][800:]
    stride = 20  # the dominant pair alone is left: y[k+2s] = a y[k+s] - radius^2s y[k]
    columns = np.column_stack([y[stride:-stride], y[: -2 * stride]])
    scale = found.radius ** -np.arange(len(columns), dtype=float)[:, None]
    product = -np.linalg.lstsq(columns * scale, y[2 * stride :] * scale[:, 0], rcond=None)[0][1]
    assert product ** (0.5 / stride) == pytest.approx(found.radius, abs=1e-4)


@pytest.mark.parametrize("stiffness", [20.0, 50.0, 200.0, 500.0, 1000.0])
@pytest.mark.parametrize("scenario", [NOMINAL, REALISTIC], ids=lambda scenario: scenario.name)
def test_the_ready_tunings_are_stable_over_the_whole_stiffness_range(scenario: Scenario, stiffness: float) -> None:
    lag = scenario.actuator.motor.torque_lag_s
    assert unstable_because(scenario.tuning, scenario.timing, lag, stiffness) is None


REFUSED = {
    "too fast poles": Tuning(controller=StateFeedback(natural_frequency=400.0), observer=PositionObserver()),
    "too fast an observer": Tuning(observer=VelocityObserver(bandwidth=1500.0, discretisation="first_order_hold")),
    "too thin a layer": Tuning(controller=SlidingMode(switching_gain=2e6), observer=PositionObserver()),
}
REMEDY = re.compile(r"(surface poles|poles|a switching gain|an observer bandwidth) up to about ([0-9.e+]+)")


def remedied(tuning: Tuning, what: str, value: float) -> Tuning:
    part, field = {
        "poles": ("controller", "natural_frequency"),
        "surface poles": ("controller", "surface_pole"),
        "a switching gain": ("controller", "switching_gain"),
        "an observer bandwidth": ("observer", "bandwidth"),
    }[what]
    changed = getattr(tuning, part).model_copy(update={field: value})
    return tuning.model_copy(update={part: changed})


@pytest.mark.parametrize("tuning", REFUSED.values(), ids=REFUSED)
def test_a_refusal_names_remedies_and_each_of_them_is_stable(tuning: Tuning) -> None:
    timing = Timing(compute_delay_samples=1)
    reason = unstable_because(tuning, timing, 1.6e-4, 200.0)
    assert reason is not None
    assert reason.count(". ") == 0, "one sentence"
    assert "unstable even with its own model at 200 N·m/rad" in reason
    remedies = REMEDY.findall(reason)
    assert remedies, reason
    for what, value in remedies:
        better = remedied(tuning, what, float(value))
        assert stability(better, timing, 1.6e-4, 200.0).stable, (what, value)


def test_a_refused_tuning_indeed_runs_away() -> None:
    scenario = REALISTIC.model_copy(
        update={"tuning": REFUSED["too fast poles"], "stiffness_reference": ConstantStiffness(), "duration_s": 2.0}
    )
    run = Experiment(scenario).advance(2000)
    assert metrics(run.rows)["saturated"] > 80.0
    assert np.abs(run["error"]).max() > 0.1


def test_a_model_far_from_the_plant_is_judged_with_that_plant() -> None:
    believed = Tuning(model=ControllerModel(link_inertia=0.3))
    timing = Timing(compute_delay_samples=1)
    assert stability(believed, timing, 0.0, 200.0).stable
    assert not stability(Tuning(), timing, 0.0, 200.0, HEAVY_PLANT).stable


def test_sgn_has_no_linear_loop_to_judge() -> None:
    sgn = Tuning(controller=SlidingMode(switch="sgn"))
    assert unstable_because(sgn, Timing(), 0.0, 200.0) is None
    with pytest.raises(ValueError, match="choose a boundary layer"):
        closed_loop_matrix(sgn, Timing(), 0.0, 200.0)


def test_a_stiffness_loop_that_is_unstable_by_itself_is_refused_with_a_remedy_of_its_own() -> None:
    slow = Timing(sample_time_s=5e-3, compute_delay_samples=1)
    tuning = Tuning(
        controller=SlidingMode(switch="sgn"), stiffness_loop=StiffnessLoop(bandwidth=400.0, observer_bandwidth=1000.0)
    )
    reason = unstable_because(tuning, slow, 0.0, 200.0)
    assert reason is not None
    assert reason.startswith("the stiffness loop of 400 rad/s")
    gentle = tuning.model_copy(update={"stiffness_loop": StiffnessLoop(bandwidth=20.0, observer_bandwidth=20.0)})
    assert unstable_because(gentle, slow, 0.0, 200.0) is None


@pytest.mark.parametrize("delay", [0, 1])
def test_the_stiffness_axis_decays_as_its_matrix_says(delay: int) -> None:
    timing = Timing(compute_delay_samples=1 if delay else 0)
    tuning = Tuning(stiffness_loop=StiffnessLoop(bandwidth=60.0))
    scenario = Scenario(timing=timing, tuning=tuning, reference=StepReference(origin=0.0, target=0.0))
    experiment = Experiment(scenario)
    rest = experiment.state[4]
    experiment.advance(1)
    experiment.state[4] += 1e-3
    away = experiment.advance(400)["stiffness_motor_position"] - rest
    rate = np.polyfit(np.arange(150), np.log(np.abs(away[100:250])), 1)[0]
    poles = np.abs(np.linalg.eigvals(stiffness_axis_matrix(tuning, timing, 200.0)))
    assert rate == pytest.approx(np.log(poles.max()), rel=0.05)
