"""A batch document says which runs there are: crossed, zipped, drawn, by path; and refuses what makes no sense in a sentence."""

import itertools
import tracemalloc
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from vssea_core.batch.document import Batch
from vssea_core.batch.part import Part, run_part
from vssea_core.batch.plan import BatchPlan
from vssea_core.batch.refusals import VaryError
from vssea_core.channels import CHANNELS
from vssea_core.scenarios import NOMINAL

INERTIA, BANDWIDTH = "actuator.link.inertia", "tuning.observer.bandwidth"


def plan(*vary: dict[str, Any], **fields: Any) -> BatchPlan:
    return BatchPlan(Batch.model_validate({"vary": list(vary), **fields}))


def grid(path: str, low: float, high: float, count: int, **fields: Any) -> dict[str, Any]:
    return {"kind": "grid", "path": path, "low": low, "high": high, "count": count, **fields}


def listed(path: str, *values: Any, **fields: Any) -> dict[str, Any]:
    return {"kind": "list", "path": path, "values": list(values), **fields}


def sample(count: int, method: str = "random", **draws: dict[str, Any]) -> dict[str, Any]:
    paths = {"inertia": INERTIA, "bandwidth": BANDWIDTH, "amplitude": "reference.amplitude"}
    drawn = [{"path": paths[name], "distribution": distribution} for name, distribution in draws.items()]
    return {"kind": "sample", "count": count, "method": method, "draws": drawn}


def test_variations_are_crossed_and_the_last_one_changes_fastest() -> None:
    runs = plan(listed(INERTIA, 0.1, 0.2), grid(BANDWIDTH, 60.0, 100.0, 3))
    assert [runs.values(i) for i in range(runs.count)] == [
        {INERTIA: inertia, BANDWIDTH: bandwidth} for inertia in (0.1, 0.2) for bandwidth in (60.0, 80.0, 100.0)
    ]


def test_what_is_zipped_is_varied_together() -> None:
    runs = plan({"kind": "zip", "members": [listed(INERTIA, 0.1, 0.2), grid(BANDWIDTH, 60.0, 100.0, 2)]})
    assert [runs.values(i) for i in range(2)] == [{INERTIA: 0.1, BANDWIDTH: 60.0}, {INERTIA: 0.2, BANDWIDTH: 100.0}]


def test_a_batch_without_variation_is_one_run_of_its_scenario() -> None:
    runs = plan(scenario={"duration_s": 2.0})
    assert (runs.count, runs.scenario(0)) == (1, runs.batch.scenario)


def test_a_log_grid_has_equal_ratios_and_both_ends() -> None:
    values = [plan(grid(BANDWIDTH, 10.0, 1000.0, 5, spacing="log")).values(i)[BANDWIDTH] for i in range(5)]
    assert values[0] == 10.0
    assert values[-1] == 1000.0
    assert np.allclose(np.diff(np.log(values)), np.log(10.0) / 2.0)


def test_a_factor_multiplies_what_the_base_has() -> None:
    runs = plan(listed(INERTIA, 0.5, 2.0, factor=True), scenario=NOMINAL.model_dump())
    assert [runs.values(i)[INERTIA] / NOMINAL.actuator.link.inertia for i in range(2)] == [0.5, 2.0]


def test_plant_and_model_are_varied_apart() -> None:
    run = plan(listed(INERTIA, 0.3)).scenario(0)
    assert (run.actuator.link.inertia, run.tuning) == (0.3, NOMINAL.tuning)


def test_an_item_of_a_list_is_named_by_its_number_and_a_kind_brings_its_fields() -> None:
    base = {"disturbances": {"link": [{"kind": "constant", "torque": 1.0}]}}
    runs = plan(
        listed("disturbances.link.0.torque", 2.0), listed("tuning.controller.kind", "state_feedback", "sliding_mode"),
        listed("tuning.controller.switching_gain", 40.0), scenario=base,
    )  # fmt: skip
    assert runs.scenario(1).disturbances.link[0].torque == 2.0  # type: ignore[union-attr]
    assert runs.scenario(1).tuning.controller.switching_gain == 40.0  # type: ignore[union-attr]
    with pytest.raises(ValueError, match="switching_gain is not a field"):
        runs.scenario(0)


def test_whole_numbers_stay_whole() -> None:
    assert [plan(grid("seed", 0.0, 10.0, 3)).values(i) for i in range(3)] == [{"seed": 0}, {"seed": 5}, {"seed": 10}]


def test_each_run_may_have_noise_of_its_own() -> None:
    assert [plan(listed(INERTIA, 0.1, 0.2), noise="own").scenario(i).seed for i in range(2)] == [0, 1]
    assert [plan(listed(INERTIA, 0.1, 0.2)).scenario(i).seed for i in range(2)] == [0, 0]


@pytest.mark.parametrize(
    ("vary", "words"),
    [
        ([listed("actuator.link.inertai", 1.0)], "link.inertai is no field of the scenario; nearest: actuator.link.inertia"),
        ([listed("observer.bandwidth", 1.0)], "nearest: .*tuning.observer.bandwidth"),
        ([listed(INERTIA, 0.1), grid(INERTIA, 0.1, 0.2, 2)], "actuator.link.inertia is varied twice"),
        ([grid(BANDWIDTH, -1.0, 10.0, 3, spacing="log")], "from -1 to 10; a log grid needs positive ends"),
        ([listed("name", "a", factor=True)], 'name is "untitled"; a factor needs a number there'),
    ],
)  # fmt: skip
def test_what_makes_no_sense_is_refused_in_a_sentence(vary: list[dict[str, Any]], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        plan(*vary)


UNIFORM = {"kind": "uniform", "low": 50.0, "high": 150.0}
ODD = listed("actuator.lnk", 1.0)


@pytest.mark.parametrize(
    ("vary", "field"),
    [
        ([listed("seed", 1), ODD], "vary.1.path"),
        ([{"kind": "zip", "members": [listed("seed", 1), ODD]}], "vary.0.members.1.path"),
        ([{"kind": "sample", "draws": [{"path": "actuator.lnk", "distribution": UNIFORM}]}], "vary.0.draws.0.path"),
        ([listed(INERTIA, 0.1), listed("seed", 1), grid(INERTIA, 0.1, 0.2, 2)], "vary.2.path"),
    ],
)  # fmt: skip
def test_a_refusal_names_the_field_of_the_document_and_begins_with_the_varied_one(
    vary: list[dict[str, Any]], field: str
) -> None:
    with pytest.raises(VaryError, match=r"^actuator\.l") as refused:
        plan(*vary)
    assert refused.value.field == field


def test_a_factor_of_a_whole_part_is_told_in_short() -> None:
    with pytest.raises(VaryError, match=r'^tuning is {".+\.\.\.; a factor needs a number there') as refused:
        plan(listed("tuning", 2.0, factor=True))
    assert len(str(refused.value)) < 130


@pytest.mark.parametrize(
    ("values", "kept"),
    [((True, False), [True, False]), ((1, 2), [1, 2]), ((1, 2.5), [1.0, 2.5]), ((True, 1), ["true", "1"])],
)
def test_a_column_of_results_is_what_all_its_values_are(values: tuple[Any, ...], kept: list[Any]) -> None:
    part = run_part(plan(listed("tuning.observer.predict", *values), scenario={"duration_s": 0.02}), 0, 2)
    found = [*table_of(part)["tuning.observer.predict"]]
    assert [getattr(value, "item", lambda value=value: value)() for value in found] == kept
    assert len({type(value) for value in found}) == 1


def test_zipped_fields_need_equally_many_values() -> None:
    with pytest.raises(ValueError, match=r"there are actuator.link.inertia 2, tuning.observer.bandwidth 3"):
        plan({"kind": "zip", "members": [listed(INERTIA, 0.1, 0.2), grid(BANDWIDTH, 60.0, 100.0, 3)]})


@pytest.mark.parametrize("method", ["random", "sobol", "latin_hypercube"])
def test_random_values_follow_their_distributions_and_their_seed(method: str) -> None:
    distributions = {
        "bandwidth": UNIFORM,
        "inertia": {"kind": "log_uniform", "low": 0.01, "high": 1.0},
        "amplitude": {"kind": "normal", "mean": 1.0, "std": 0.1, "within": 3.0},
    }
    runs = plan(sample(2000, method, **distributions), seed=3)
    table = np.array([list(runs.values(i).values()) for i in range(2000)])
    expected = (stats.uniform(50.0, 100.0), stats.loguniform(0.01, 1.0), stats.truncnorm(-3.0, 3.0, 1.0, 0.1))
    for column, distribution in zip(table.T, expected, strict=True):
        assert stats.kstest(column, distribution.cdf).pvalue > 1e-3
    again = plan(sample(2000, method, **distributions), seed=3)
    assert [again.values(i) for i in range(2000)] == [runs.values(i) for i in range(2000)]
    assert plan(sample(2000, method, **distributions), seed=4).values(0) != runs.values(0)


@pytest.mark.parametrize("method", ["sobol", "latin_hypercube"])
def test_spread_samples_fill_every_slice_of_a_field(method: str) -> None:
    runs = plan(sample(64, method, bandwidth=UNIFORM, inertia={"kind": "uniform", "low": 0.1, "high": 0.2}))
    values = np.array([runs.values(i)[BANDWIDTH] for i in range(64)])
    assert sorted(((values - 50.0) / 100.0 * 64).astype(int)) == list(range(64))


def test_two_samples_of_a_batch_are_independent() -> None:
    runs = plan(sample(50, bandwidth=UNIFORM), sample(50, amplitude={"kind": "uniform", "low": 0.0, "high": 1.0}))
    first = np.array([runs.values(i * 50)[BANDWIDTH] for i in range(50)])
    second = np.array([runs.values(i)["reference.amplitude"] for i in range(50)])
    assert not np.allclose((first - 50.0) / 100.0, second)


def table_of(part: Part | None) -> dict[str, list[Any]]:
    assert part is not None
    return {name: list(column) for name, column in part.rows.items()}


@given(cuts=st.lists(st.integers(1, 22), max_size=4))
@settings(deadline=None, max_examples=10)
def test_however_a_batch_is_cut_into_parts_its_rows_are_the_same(cuts: list[int]) -> None:
    runs = plan(
        listed("tuning.controller.kind", "state_feedback", "sliding_mode"), grid(INERTIA, 0.05, 60.0, 12),
        scenario={"duration_s": 0.05},
    )  # fmt: skip
    whole = table_of(run_part(runs, 0, runs.count))
    ends = [0, *sorted(set(cuts)), runs.count]
    parts = [table_of(run_part(runs, a, b - a)) for a, b in itertools.pairwise(ends)]
    joined = {name: [value for part in parts for value in part[name]] for name in whole}
    assert str(joined) == str(whole)  # nan equals itself in words
    assert "refused" in whole["state"]


def test_samples_are_kept_of_the_runs_and_channels_that_were_asked_for() -> None:
    keep = {"trajectories": "all", "channels": ["link_position", "time"], "every": 5, "precision": "float64"}
    runs = plan(listed(INERTIA, 0.1, 0.2), keep=keep, scenario={"duration_s": 0.1})
    part = run_part(runs, 0, 2)
    assert part is not None
    assert list(part.trajectories) == ["run", "time", "link_position"]
    assert np.bincount(part.trajectories["run"]).tolist() == [20, 20]  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="nearest: link_position"):
        plan(keep={"channels": ["link_pos"]})


def test_a_part_holds_of_its_samples_what_is_kept_and_no_more() -> None:
    keep = {"trajectories": "all", "every": 50}
    runs = plan(grid(INERTIA, 0.1, 0.2, 32), keep=keep, scenario={"duration_s": 2.0})
    tracemalloc.start()
    try:
        part = run_part(runs, 0, 16)  # what is kept from part to part is there after this one
        before = tracemalloc.get_traced_memory()[0]
        tracemalloc.reset_peak()
        part = run_part(runs, 16, 16)
        held = tracemalloc.get_traced_memory()[1] - before
    finally:
        tracemalloc.stop()
    assert part is not None
    whole_run = 2000 * len(CHANNELS) * 8
    assert whole_run < held < 5 * whole_run  # one trajectory at a time, not 16
