"""Batches at their edges: huge numbers, ends, whole numbers, fields named twice. Nothing is lost to one bad value."""

import itertools
import json
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import TypeAdapter, ValidationError
from scipy import stats

from vssea_core.batch import engine
from vssea_core.batch.document import Batch, Distribution, Listed
from vssea_core.batch.draws import drawn
from vssea_core.batch.part import Part, run_part
from vssea_core.batch.plan import BatchPlan
from vssea_core.scenario import Scenario
from vssea_core.simulation.trajectory import Trajectory

INERTIA, DELAY = "actuator.link.inertia", "timing.compute_delay_samples"
SHORT = {"duration_s": 0.02}


def plan(*vary: dict[str, Any], **fields: Any) -> BatchPlan:
    return BatchPlan(Batch.model_validate({"vary": list(vary), "scenario": SHORT, **fields}))


def listed(path: str, *values: Any, **fields: Any) -> dict[str, Any]:
    return {"kind": "list", "path": path, "values": list(values), **fields}


def grid(path: str, low: float, high: float, count: int, **fields: Any) -> dict[str, Any]:
    return {"kind": "grid", "path": path, "low": low, "high": high, "count": count, **fields}


def draw(path: str, kind: str = "uniform", factor: bool = False, **fields: float) -> dict[str, Any]:
    return {"path": path, "factor": factor, "distribution": {"kind": kind, **fields}}


def sample(*draws: dict[str, Any], count: int = 20_000) -> dict[str, Any]:
    return {"kind": "sample", "count": count, "draws": list(draws)}


def column(runs: BatchPlan, path: str) -> list[Any]:
    return [runs.values(i)[path] for i in range(runs.count)]


def distribution(**fields: Any) -> Any:
    return TypeAdapter[Any](Distribution).validate_python(fields)


def whole(part: Part | None) -> Part:
    assert part is not None
    return part


@pytest.mark.parametrize(
    ("path", "values", "kind"),
    [
        ("seed", [1, 2**63], np.float64),
        ("seed", [1, -(2**63) - 1], np.float64),
        ("seed", [1, 10**400], str),
        (INERTIA, [0.1, 10**30], np.float64),
        (INERTIA, [1, 10**400], str),
    ],
)
def test_a_value_beyond_what_a_column_holds_is_a_refused_row(path: str, values: list[Any], kind: type) -> None:
    part = whole(run_part(plan(listed(path, *values)), 0, 2))
    assert part.rows["state"] == ["done", "refused"]
    assert path in part.rows["reason"][1]
    assert {type(value) for value in part.rows[path]} == {kind}


def test_whole_numbers_that_64_bits_hold_stay_whole() -> None:
    part = whole(run_part(plan(listed("seed", 1, 2**63 - 1)), 0, 2))
    assert np.array_equal(part.rows["seed"], np.array([1, 2**63 - 1]))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "failure", [OverflowError("too large"), ZeroDivisionError("by zero"), ValueError("no solution")]
)
def test_a_run_that_cannot_be_computed_is_refused_and_costs_no_other(
    monkeypatch: pytest.MonkeyPatch, failure: Exception
) -> None:
    alone = engine.simulate

    def simulate(scenario: Scenario) -> Trajectory:
        if scenario.seed == 1:
            raise failure
        return alone(scenario)

    monkeypatch.setattr(engine, "simulate", simulate)
    part = whole(run_part(plan(listed("seed", 0, 1)), 0, 2))
    assert part.rows["state"] == ["done", "refused"]
    assert str(failure) in part.rows["reason"][1]


HUGE = "gets values beyond the largest number"


@pytest.mark.parametrize(
    ("vary", "words"),
    [
        (listed(INERTIA, 1.0, 10**400, factor=True), HUGE),
        (listed("stiffness_reference.stiffness", 1e308, factor=True), HUGE),
        (grid(INERTIA, -1.7e308, 1.7e308, 3), HUGE),
        (grid("seed", -1.7e308, 1.7e308, 3), HUGE),
        (sample(draw(INERTIA, low=-1.7e308, high=1.7e308), count=4), "drawn from -1.7e.308 to 1.7e.308; expected ends closer"),
        (sample(draw("stiffness_reference.stiffness", low=0.0, high=1.7e308, factor=True), count=4), HUGE),
        (sample(draw("seed", "normal", mean=1e308, std=1e308), count=4), HUGE),
        (sample(draw("seed", low=0.2, high=0.8), count=4), "no whole number lies between 0.2 and 0.8; widen"),
        (grid(DELAY, 0.0, 1.0, 11), "11 values from 0 to 1 repeat some of them; a count of 2 does not"),
    ],
)  # fmt: skip
def test_values_that_no_field_can_have_are_refused_in_a_sentence(vary: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        plan(vary)


def test_wide_draws_of_a_whole_number_are_refused_run_by_run() -> None:
    runs = plan(sample(draw("seed", low=0.0, high=1e300), count=4))
    assert [type(seed) for seed in column(runs, "seed")] == [int] * 4
    assert whole(run_part(runs, 0, 4)).rows["state"] == ["refused"] * 4


TORQUE = "disturbances.link.0.torque"


@pytest.mark.parametrize(
    ("vary", "words"),
    [
        ([{"kind": "zip", "members": [listed(INERTIA, 0.1, 0.2), listed(INERTIA, 0.3, 0.4)]}], "inertia is varied twice"),
        ([sample(draw(INERTIA, low=0.1, high=0.2), draw(INERTIA, low=0.3, high=0.4))], "inertia is varied twice"),
        ([listed(INERTIA, 0.1), sample(draw(INERTIA, low=0.1, high=0.2))], "inertia is varied twice"),
        ([listed(TORQUE, 1.0), listed("disturbances.link.00.torque", 2.0)], "torque is varied twice"),
        (
            [listed("tuning.controller.kind", "sliding_mode"), listed("tuning.controller", {"kind": "state_feedback"})],
            "tuning.controller.kind is varied, and so is all of tuning.controller; expected one of them",
        ),
        (
            [{"kind": "zip", "members": [listed("tuning", {}), listed("tuning.observer.bandwidth", 80.0)]}],
            "tuning.observer.bandwidth is varied, and so is all of tuning;",
        ),
    ],
)  # fmt: skip
def test_a_field_is_varied_once_wherever_it_is_named(vary: list[dict[str, Any]], words: str) -> None:
    base = {"disturbances": {"link": [{"kind": "constant", "torque": 1.0}]}}
    with pytest.raises(ValueError, match=words):
        plan(*vary, scenario=base)


def test_fields_side_by_side_in_a_part_are_varied_apart() -> None:
    runs = plan(listed("tuning.controller.kind", "sliding_mode"), listed("tuning.controller.switching_gain", 30.0))
    assert runs.count == 1


def test_a_varied_seed_and_noise_of_each_run_are_told_apart() -> None:
    with pytest.raises(ValueError, match="seed is varied, and noise own gives each run a seed too; expected one"):
        plan(listed("seed", 1, 2), noise="own")


def test_uniform_whole_numbers_are_each_as_likely_as_the_others() -> None:
    for low, high, factor, seed in ((0.0, 2.0, False, 0), (-0.5, 2.9, False, 0), (0.5, 2.0, True, 4)):
        varied = sample(draw("seed", low=low, high=high, factor=factor))
        values = column(plan(varied, scenario={"seed": seed}, seed=11), "seed")
        ends = (seed * low, seed * high) if factor else (low, high)
        expected = range(math.ceil(ends[0]), math.floor(ends[1]) + 1)
        counts = [values.count(value) for value in expected]
        assert sum(counts) == len(values)
        assert stats.chisquare(counts).pvalue > 1e-3
        assert {type(value) for value in values} == {int}


def test_whole_numbers_of_other_distributions_are_the_nearest_between_the_ends() -> None:
    normal = column(plan(sample(draw("seed", "normal", mean=3.0, std=1.0, within=1.6), count=2000)), "seed")
    assert set(normal) == {2, 3, 4}  # 1.4 to 4.6
    decades = column(plan(sample(draw("seed", "log_uniform", low=0.6, high=2.6), count=2000)), "seed")
    assert set(decades) == {1, 2}


@pytest.mark.parametrize(("low", "high"), [(1.0, 40.0), (1.0, 1000.0), (7.0, 7.0)])
@pytest.mark.parametrize("spacing", ["linear", "log"])
def test_the_count_that_is_offered_for_a_grid_of_whole_numbers_fits(low: float, high: float, spacing: str) -> None:
    with pytest.raises(ValueError, match="a count of") as refused:
        plan(grid("seed", low, high, 5000, spacing=spacing))
    offered = int(str(refused.value).split("a count of ")[1].split()[0])
    values = column(plan(grid("seed", low, high, offered, spacing=spacing)), "seed")
    assert len(set(values)) == offered
    assert (values[0], values[-1]) == (low, high)
    assert spacing == "log" or offered == high - low + 1


@pytest.mark.parametrize("kind", ["uniform", "log_uniform"])
def test_the_ends_of_a_distribution_are_in_order(kind: str) -> None:
    with pytest.raises(ValidationError, match=f"{INERTIA} is drawn from 2 to 1; expected the lower end first"):
        plan(sample(draw(INERTIA, kind, low=2.0, high=1.0)))
    assert set(column(plan(sample(draw(INERTIA, kind, low=0.3, high=0.3), count=9)), INERTIA)) == {0.3}


@given(
    kind=st.sampled_from(["uniform", "log_uniform", "normal"]), ends=st.tuples(*[st.floats(1e-300, 1e300)] * 2),
    unit=st.lists(st.floats(0.0, 1.0), max_size=5), within=st.floats(0.01, 8.0),
)  # fmt: skip
def test_no_value_lies_beyond_an_end(kind: str, ends: tuple[float, float], unit: list[float], within: float) -> None:
    low, high = sorted(ends)
    fields = {"mean": low, "std": high, "within": within} if kind == "normal" else {"low": low, "high": high}
    values = drawn(distribution(kind=kind, **fields), np.array([0.0, *unit, np.nextafter(1.0, 0.0), 1.0]))
    least, most = (low - within * high, low + within * high) if kind == "normal" else (low, high)
    assert np.all((values >= least) & (values <= most))
    assert math.isclose(values[-1], most, rel_tol=1e-2)


def test_a_grid_may_go_down() -> None:
    assert column(plan(grid("seed", 3.0, 0.0, 4)), "seed") == [3, 2, 1, 0]


@pytest.mark.parametrize("value", ["NaN", "Infinity", "1e999", '{"kind": "state_feedback", "gains": [1.0, -1e999]}'])
def test_a_list_holds_finite_numbers(value: str) -> None:
    with pytest.raises(ValidationError, match=rf"value 1 of {INERTIA} is .+; expected finite numbers"):
        Listed.model_validate_json(f'{{"path": "{INERTIA}", "values": [1.0, {value}]}}')


def test_a_document_comes_back_from_json_with_the_same_runs() -> None:
    batch = plan(listed(INERTIA, 1, 10**400), sample(draw("seed", low=0.0, high=9.0), count=3)).batch
    again = BatchPlan(Batch.model_validate(json.loads(batch.model_dump_json())))
    assert [again.values(i) for i in range(6)] == [BatchPlan(batch).values(i) for i in range(6)]


def test_a_samples_values_take_eight_bytes_each() -> None:
    runs = plan(sample(draw(INERTIA, low=0.1, high=0.2), draw("seed", low=0.0, high=9.0), count=1000))
    columns = itertools.chain.from_iterable(runs._columns)
    assert [column.nbytes for _, column in columns] == [8000, 8000]  # type: ignore[union-attr]
    assert [type(value) for value in runs.values(0).values()] == [float, int]
