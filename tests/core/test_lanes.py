"""Runs side by side equal the same runs alone, to the bit, whatever they are and in whatever order."""

import itertools
import re
from typing import Any

import numba
import numpy as np
import pytest

from vssea_core.batch.engine import Outcome, run_alone, run_scenarios
from vssea_core.batch.lane_access import LANES
from vssea_core.batch.lanes import lanes_kernel
from vssea_core.batch.numbers import NumbersOf
from vssea_core.batch.runs import Runs
from vssea_core.scenario import Scenario
from vssea_core.scenarios import NOMINAL, PAPER_FIG2, REALISTIC

SHORT = {"duration_s": 1.5}
LOADED_EARLY = {
    "disturbances.link": [{"kind": "constant", "torque": 3.0}, {"kind": "sine", "amplitude": 2.0, "frequency_hz": 1.3}]
}
IN_LANES: dict[str, tuple[Scenario, dict[str, Any]]] = {
    "pole placement": (NOMINAL, {}),
    "lqr": (NOMINAL, {"tuning.controller.design": "lqr_plant"}),
    "no observer": (NOMINAL, {"tuning.observer.kind": "off"}),
    "sliding mode": (NOMINAL, {"tuning.controller.kind": "sliding_mode"}),
    "sgn": (NOMINAL, {"tuning.controller.kind": "sliding_mode", "tuning.controller.switch": "sgn"}),
    "super-twisting": (NOMINAL, {"tuning.controller.kind": "sliding_mode", "tuning.controller.switch": "super_twisting"}),
    "gains that follow k, which moves": (
        REALISTIC,
        {"tuning.schedule.bandwidth_exponent": 0.5, "stiffness_reference.kind": "move", "stiffness_reference.stiffness": 100.0,
         "stiffness_reference.target": 500.0, "stiffness_reference.start_s": 0.3},
    ),
    "baseline": (NOMINAL, {"tuning.controller.kind": "baseline"}),
    "realistic": (REALISTIC, {}),
    "realistic, not predicting": (REALISTIC, {"tuning.observer.predict": False}),
    "realistic, velocities from differences": (
        REALISTIC, {"tuning.observer.kind": "velocity", "tuning.observer.velocity_source": "difference"},
    ),
    "much friction": (REALISTIC, {"actuator.motor.coulomb_friction": 20.0, "actuator.motor.friction_velocity": 0.002}),
    "friction without delay": (NOMINAL, {"actuator.motor.coulomb_friction": 4.0}),
    "moving stiffness": (
        NOMINAL,
        {"stiffness_reference.kind": "move", "stiffness_reference.stiffness": 200.0, "stiffness_reference.target": 600.0,
         "stiffness_reference.start_s": 0.2},
    ),
    "paper": (PAPER_FIG2, {"actuator.stiffness.back_torque": "paper"}),
    "step": (NOMINAL, {"reference.kind": "step"}),
    "chirp": (NOMINAL, {"reference.kind": "chirp"}),
    "another sample time": (NOMINAL, {"timing.sample_time_s": 0.002}),
}  # fmt: skip
ALONE: dict[str, tuple[Scenario, dict[str, Any]]] = {
    "tanh": (NOMINAL, {"tuning.controller.kind": "sliding_mode", "tuning.controller.switch": "tanh"}),
    "noise": (NOMINAL, {"sensors.link_noise": 1e-5}),
    "transport delay": (REALISTIC, {"actuator.motor.torque_delay_s": 0.5e-3}),
    "a wall": (NOMINAL, {"disturbances.link": [{"kind": "contact"}]}),
    "a sequence": (NOMINAL, {"sequence": [{"at_s": 0.5, "changes": {"tuning.observer.bandwidth": 60.0}}]}),
}  # fmt: skip
FACTORS = np.geomspace(0.4, 2.5, 21)


def spread(base: Scenario, values: dict[str, Any]) -> list[Scenario]:
    """21 runs: more than fill one set of lanes, each with another link."""
    runs = Runs(base)
    inertia = base.actuator.link.inertia
    return [
        runs.scenario(SHORT | LOADED_EARLY | values | {"actuator.link.inertia": float(inertia * each)})
        for each in FACTORS
    ]


def outcomes(scenarios: list[Scenario | ValueError]) -> list[Outcome]:
    found = run_scenarios(scenarios)
    assert found is not None
    return found


def assert_equal(a: Outcome, b: Outcome) -> None:
    assert (a.state, a.time_s, a.reason) == (b.state, b.time_s, b.reason)
    assert a.figures.tobytes() == b.figures.tobytes()


@pytest.mark.parametrize("name", IN_LANES)
def test_a_run_in_a_lane_equals_the_run_alone_to_the_bit(name: str) -> None:
    scenarios = spread(*IN_LANES[name])
    assert NumbersOf()(scenarios[0]).variant is not None
    for scenario, found in zip(scenarios, outcomes([*scenarios]), strict=True):
        assert_equal(found, run_alone(scenario))


@pytest.mark.parametrize("name", ALONE)
def test_what_lanes_leave_out_is_run_alone(name: str) -> None:
    scenarios = spread(*ALONE[name])[:4]
    assert NumbersOf()(scenarios[0]).variant is None
    for scenario, found in zip(scenarios, outcomes([*scenarios]), strict=True):
        assert_equal(found, run_alone(scenario))


def test_runs_that_diverge_end_when_they_would_alone_and_spoil_none_beside_them() -> None:
    runs = Runs(PAPER_FIG2)
    strong = {"actuator.motor.peak_torque": 5000.0, "actuator.motor.continuous_torque": 5000.0}
    scenarios = [
        runs.scenario({"duration_s": 2.0, "actuator.link.inertia": inertia, **strong})
        for inertia in np.geomspace(0.1, 4.0, 16).tolist()
    ]
    found = outcomes([*scenarios])
    assert {each.state for each in found} == {"done", "ended"}
    for scenario, each in zip(scenarios, found, strict=True):
        assert_equal(each, run_alone(scenario))


def test_order_and_company_change_nothing() -> None:
    mixed = [
        scenario for name in ("pole placement", "realistic", "step", "sgn") for scenario in spread(*IN_LANES[name])[::4]
    ]
    shuffled = np.random.default_rng(1).permutation(len(mixed))
    found, again = outcomes([*mixed]), outcomes([mixed[place] for place in shuffled])
    for place, each in zip(shuffled, again, strict=True):
        assert_equal(each, found[place])


@pytest.mark.parametrize("base", [NOMINAL, REALISTIC], ids=["nominal", "realistic"])
def test_runs_share_what_comes_from_outside_only_where_it_is_the_same(base: Scenario) -> None:
    runs = Runs(base)
    mixed = [
        runs.scenario(SHORT | LOADED_EARLY | {path: value})
        for number in range(7)
        for path, value in (
            ("reference.amplitude", 0.1 + 0.05 * number),
            ("stiffness_reference.stiffness", 150.0 + 40.0 * number),
            ("disturbances.link.0.torque", 1.0 + 0.5 * number),
        )
    ]
    for scenario, found in zip(mixed, outcomes([*mixed]), strict=True):
        assert_equal(found, run_alone(scenario))


def test_a_refused_run_is_an_outcome_with_its_reason() -> None:
    scenarios = [NOMINAL.model_copy(update={"duration_s": 0.5})] * 3
    too_heavy = Runs(NOMINAL).scenario(
        {"disturbances.link": [{"kind": "constant", "torque": 150.0}], "stiffness_reference.stiffness": 30.0}
    )
    found = outcomes([scenarios[0], too_heavy, ValueError("a value out of range"), scenarios[1]])
    assert [each.state for each in found] == ["done", "refused", "refused", "done"]
    assert "the spring cannot carry" in found[1].reason
    assert found[2].reason == "a value out of range"
    assert np.isnan(found[1].figures).all()


def test_it_ends_as_soon_as_it_is_asked_to() -> None:
    told = itertools.count()
    assert run_scenarios([NOMINAL.model_copy(update={"duration_s": 0.1})] * 100, lambda done: next(told) < 2) is None
    assert next(told) == 3


def test_the_loop_over_lanes_is_made_of_vectors() -> None:
    """A branch into a library anywhere in the tick would leave it right, and several times slower."""
    kernel = lanes_kernel(NumbersOf()(NOMINAL).variant)  # type: ignore[arg-type]
    outcomes([NOMINAL.model_copy(update={"duration_s": 0.01})] * LANES)
    anew = numba.njit(error_model="numpy")(kernel.py_func)  # what comes from the cache can no longer be read
    anew.compile(kernel.signatures[0])
    code = anew.inspect_llvm(anew.signatures[0])
    kinds = r"<\d+ x double>", "double"
    in_lanes, alone = (len(re.findall(rf"fmul {kind}|call {kind} @llvm.fma", code)) for kind in kinds)
    assert in_lanes > 400
    assert alone < 0.2 * in_lanes
