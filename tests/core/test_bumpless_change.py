"""A change of the observer's bandwidth while the loop runs moves no torque in the tick in which it happens."""

import numpy as np
import pytest

from tests.core.experiment import Experiment
from vssea_core.control.tuning import Observer, PositionObserver, SlidingMode, StateFeedback, Tuning, VelocityObserver
from vssea_core.scenario import Scenario
from vssea_core.scenarios import NOMINAL, REALISTIC

CHANGES: dict[str, tuple[Scenario, Observer, Observer]] = {
    "velocity, exact": (NOMINAL, VelocityObserver(bandwidth=100.0), VelocityObserver(bandwidth=250.0)),
    "velocity, first-order hold": (
        NOMINAL,
        VelocityObserver(bandwidth=100.0, discretisation="first_order_hold"),
        VelocityObserver(bandwidth=250.0, discretisation="first_order_hold"),
    ),
    "from the one discretisation to the other": (
        NOMINAL,
        VelocityObserver(),
        VelocityObserver(discretisation="first_order_hold"),
    ),
    "position, ideal encoders": (NOMINAL, PositionObserver(bandwidth=60.0), PositionObserver(bandwidth=150.0)),
    "position, realistic": (REALISTIC, PositionObserver(bandwidth=60.0), PositionObserver(bandwidth=150.0)),
}
INSTANTS = (3001, 3300, 4400)


def with_observer(scenario: Scenario, observer: Observer) -> Scenario:
    return scenario.model_copy(update={"tuning": scenario.tuning.model_copy(update={"observer": observer})})


@pytest.mark.parametrize(("scenario", "before", "after"), CHANGES.values(), ids=CHANGES)
def test_a_change_of_bandwidth_leaves_the_torque_of_its_tick_alone(
    scenario: Scenario, before: Observer, after: Observer
) -> None:
    experiment = Experiment(with_observer(scenario, before))
    changed = experiment.scenario.tuning.model_copy(update={"observer": after})
    differ = []
    for instant in INSTANTS:
        experiment.advance(instant - experiment.sample)
        kept, moved = experiment.fork(), experiment.fork()
        without, with_change = kept.advance(200), moved.advance(200, changed)
        for channel in ("motor_torque_demand", "stiffness_motor_torque", "link_disturbance_estimate"):
            assert abs(without[channel][0] - with_change[channel][0]) < 1e-9, channel
        differ.append(np.abs(without["motor_torque_demand"] - with_change["motor_torque_demand"]).max())
    assert max(differ) > 1e-3, "the new bandwidth has to act later on"


def test_a_change_of_the_stiffness_loops_observer_leaves_the_torque_of_its_tick_alone() -> None:
    experiment = Experiment(REALISTIC)
    loop = REALISTIC.tuning.stiffness_loop.model_copy(update={"observer_bandwidth": 400.0})
    changed = REALISTIC.tuning.model_copy(update={"stiffness_loop": loop})
    experiment.advance(3050)
    kept, moved = experiment.fork(), experiment.fork()
    without, with_change = kept.advance(100), moved.advance(100, changed)
    torque = "stiffness_motor_torque"
    assert abs(without[torque][0] - with_change[torque][0]) < 1e-9
    assert np.abs(without[torque] - with_change[torque]).max() > 1e-9


def test_a_change_of_gains_acts_in_its_own_tick() -> None:
    experiment = Experiment(NOMINAL)
    experiment.advance(3050)
    kept, moved = experiment.fork(), experiment.fork()
    slower = NOMINAL.tuning.model_copy(update={"controller": StateFeedback(natural_frequency=15.0)})
    demands = [kept.advance(1)["motor_torque_demand"][0], moved.advance(1, slower)["motor_torque_demand"][0]]
    assert abs(demands[0] - demands[1]) > 1e-2


def test_a_switch_to_the_sliding_law_and_back_keeps_the_estimates() -> None:
    experiment = Experiment(NOMINAL)
    sliding = NOMINAL.tuning.model_copy(update={"controller": SlidingMode()})
    experiment.advance(4500)
    slid = experiment.advance(500, sliding)
    back = experiment.advance(500, NOMINAL.tuning)
    for run in (slid, back):
        gap = run["link_disturbance"] - run["link_disturbance_estimate"]
        assert np.abs(gap).max() < 0.05
        assert np.abs(run["error"]).max() < 1e-3


def test_pieces_of_a_run_equal_the_whole_run_to_the_bit() -> None:
    whole, pieces = Experiment(REALISTIC), Experiment(REALISTIC)
    rows = whole.advance(3500).rows
    parts = [pieces.advance(count).rows for count in (1, 1, 498, 2500, 500)]
    assert np.array_equal(np.vstack(parts), rows)


def test_the_same_tuning_again_changes_nothing() -> None:
    experiment = Experiment(NOMINAL)
    experiment.advance(3100)
    kept, again = experiment.fork(), experiment.fork()
    assert np.array_equal(kept.advance(50).rows, again.advance(50, Tuning(**dict(NOMINAL.tuning))).rows)
