"""A part of a batch: some of its runs, as a table and, where asked, their samples. The same bits wherever it is computed."""

import json
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vssea_core.batch.document import Keep
from vssea_core.batch.engine import Outcome, run_scenarios
from vssea_core.batch.plan import BatchPlan
from vssea_core.batch.sums import LIMIT_NAMES, METRIC_NAMES
from vssea_core.channels import INDEX
from vssea_core.scenario import Scenario
from vssea_core.simulation.run import simulate

Column = NDArray[Any] | list[str]
SAMPLED: dict[str, tuple[str, ...]] = {"none": (), "ended": ("ended",), "all": ("done", "ended")}
"""Of which runs samples are kept."""
FIGURES = (*METRIC_NAMES, *(f"limit_share.{name}" for name in LIMIT_NAMES))


@dataclass(frozen=True)
class Part:
    """Columns of a row a run: its number, its values by path, state, reason, time simulated [s], metrics, limit shares.

    `trajectories` are the samples kept, with the run each belongs to: run, time and the channels asked for.
    """

    rows: dict[str, Column]
    trajectories: dict[str, Column] = field(default_factory=dict)


def run_part(
    plan: BatchPlan, first: int, count: int, goes_on: Callable[[int], bool] = lambda done: True
) -> Part | None:
    """Return runs `first` to `first + count` of a batch; None as soon as `goes_on`, told how many are done, returns False."""
    keep = plan.batch.keep
    numbers = range(first, min(first + count, plan.count))
    scenarios = list(plan.scenarios(first, count))
    outcomes = run_scenarios(scenarios, goes_on)
    if outcomes is None:
        return None
    rows = _rows(plan, numbers, outcomes)
    kept: list[tuple[int, dict[str, NDArray[Any]]]] = []
    for number, scenario, outcome in zip(numbers, scenarios, outcomes, strict=True):
        if isinstance(scenario, Scenario) and outcome.state in SAMPLED[keep.trajectories]:
            kept.append((number, _samples(keep, simulate(scenario).rows)))
            if not goes_on(len(outcomes)):
                return None
    return Part(rows, _joined(kept))


def columns_of(plan: BatchPlan) -> tuple[str, ...]:
    """Return the names of the columns of a batch's rows."""
    return ("run", *plan.paths, "state", "reason", "time_s", *FIGURES)


def _rows(plan: BatchPlan, numbers: range, outcomes: list[Outcome]) -> dict[str, Column]:
    values = [plan.values(number) for number in numbers]
    figures = np.array([outcome.figures for outcome in outcomes])
    return {
        "run": np.array(numbers, dtype=np.int64),
        **{path: _column([each[path] for each in values], plan.types[path]) for path in plan.paths},
        "state": [outcome.state for outcome in outcomes],
        "reason": [outcome.reason for outcome in outcomes],
        "time_s": np.array([outcome.time_s for outcome in outcomes]),
        **{name: figures[:, place] for place, name in enumerate(FIGURES)},
    }


def _column(values: list[Any], kind: type) -> Column:
    if kind is str:
        return [value if isinstance(value, str) else json.dumps(value) for value in values]
    return np.array(values, dtype=kind)


def _samples(keep: Keep, rows: NDArray[np.float64]) -> dict[str, NDArray[Any]]:
    """Return what is kept of a trajectory, as copies: a view would hold all of it for as long as the part is computed."""
    some = rows[:: keep.every]
    channels = {name: some[:, INDEX[name]].astype(keep.precision) for name in keep.channels if name != "time"}
    return {"time": some[:, INDEX["time"]].copy(), **channels}


def _joined(kept: list[tuple[int, dict[str, NDArray[Any]]]]) -> dict[str, Column]:
    if not kept:
        return {}
    numbers, lengths = [number for number, _ in kept], [len(samples["time"]) for _, samples in kept]
    return {
        "run": np.repeat(np.array(numbers, dtype=np.int64), lengths),
        **{name: np.concatenate([samples[name] for _, samples in kept]) for name in kept[0][1]},
    }
