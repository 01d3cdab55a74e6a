"""A timed sequence: what was done by hand at an instant can be written down, and runs again to the bit."""

import json
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from vssea_core.channels import CHANNELS
from vssea_core.control.tuning import SlidingMode
from vssea_core.scenario import Scenario, after_changes
from vssea_core.scenarios import NOMINAL
from vssea_core.signals.documents import MoveReference
from vssea_core.simulation.closed_loop import ClosedLoop
from vssea_core.simulation.plan import PreparedRun
from vssea_core.simulation.run import prepare_scenario, simulate


def with_sequence(*changes: tuple[float, dict[str, Any]], **parts: Any) -> Scenario:
    document = NOMINAL.model_dump(mode="json") | parts
    document["sequence"] = [{"at_s": at_s, "changes": changed} for at_s, changed in changes]
    return Scenario.model_validate_json(json.dumps(document))


STEP_BY_STEP = with_sequence(
    (1.0, {"stiffness_reference.stiffness": 400.0}),
    (1.5, {"disturbances.motor": [{"kind": "constant", "torque": 2.0}]}),
    (2.0, {"tuning.controller.kind": "sliding_mode", "tuning.observer.bandwidth": 150.0}),
    (2.5, {"reference": {"kind": "move", "target": 0.3}}),
    duration_s=3.5,
)


def test_a_sequence_is_the_same_as_the_same_changes_made_by_hand() -> None:
    written = simulate(STEP_BY_STEP)
    plain = STEP_BY_STEP.model_copy(update={"sequence": ()})
    after = [scenario for _, scenario in after_changes(STEP_BY_STEP)]
    loop = ClosedLoop(plain, PreparedRun(prepare_scenario(plain).prepared))
    rows = np.empty((3500, len(CHANNELS)))
    loop.advance(rows[:1000])
    loop.set_stiffness(after[0].stiffness_reference)
    loop.advance(rows[1000:1500])
    loop.set_disturbances(after[1].disturbances)
    loop.advance(rows[1500:2000])
    loop.install(after[2].tuning, prepare_scenario(after[2]).prepared, 2)
    loop.advance(rows[2000:2500])
    loop.set_reference(after[3].reference)
    loop.advance(rows[2500:])
    assert np.array_equal(rows, written.rows)


def test_each_change_acts_from_its_instant_on_and_not_before() -> None:
    run, plain = simulate(STEP_BY_STEP), simulate(STEP_BY_STEP.model_copy(update={"sequence": ()}))
    assert np.array_equal(run.rows[:1000], plain.rows[:1000])
    assert run["stiffness_reference"][1000] == plain["stiffness_reference"][1000]  # the filter starts from where it is
    assert run["stiffness_reference"][1010] > plain["stiffness_reference"][1010]
    assert run["motor_disturbance"][1499] == 0.0
    assert run["motor_disturbance"][1500] == 2.0
    assert list(run["tuning_id"][[1999, 2000]]) == [1.0, 2.0]


def test_a_swap_of_the_tuning_in_mid_motion_leaves_no_kick() -> None:
    run = simulate(with_sequence((2.0, {"tuning.observer.bandwidth": 250.0}), duration_s=2.1))
    jumps = np.abs(np.diff(run["motor_torque"][1900:2100]))
    assert jumps[99] < 1.5 * np.median(jumps[:99])


def test_what_comes_later_builds_on_what_came_before() -> None:
    scenario = with_sequence(
        (1.0, {"tuning.controller.kind": "sliding_mode"}), (2.0, {"tuning.controller.surface_pole": 30.0})
    )
    first, second = (after.tuning.controller for _, after in after_changes(scenario))
    assert first == SlidingMode()
    assert second == SlidingMode(surface_pole=30.0)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ([(1.0, {"actuator.link.inertia": 1.0})], "expected a path that starts with tuning"),
        ([(1.0, {"tuning.observer.band": 1.0})], "known here: kind, bandwidth"),
        ([(1.0, {"tuning.observer.bandwidth": -1.0})], "expected a number from 1 to 2000"),
        ([(1.0, {"stiffness_reference.stiffness": 5000.0})], "the end stops"),
        ([(2.0, {"reference.kind": "move"}), (1.0, {"reference.kind": "sine"})], "before the change ahead of it"),
    ],
)
def test_a_change_that_cannot_be_made_is_refused_with_its_place(
    changes: list[tuple[float, dict[str, Any]]], words: str
) -> None:
    with pytest.raises(ValidationError, match="sequence") as refused:
        with_sequence(*changes)
    assert words in str(refused.value)


def test_a_restart_begins_the_sequence_again() -> None:
    loop = ClosedLoop(STEP_BY_STEP, prepare_scenario(STEP_BY_STEP))
    rows = np.empty((1200, len(CHANNELS)))
    loop.advance(rows)
    assert [follower.index for follower in loop.passed] == [0]
    assert loop.scenario.reference == STEP_BY_STEP.reference != MoveReference()
