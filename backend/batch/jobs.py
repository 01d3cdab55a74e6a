"""What a batch's planning worker can do: a document in, plain answers out. The web process never imports this module."""

from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from backend.batch.sizes import bytes_of, held_of, part_size, seconds_of
from vssea_core.batch.document import Batch
from vssea_core.batch.numbers import NumbersOf
from vssea_core.batch.part import columns_of
from vssea_core.batch.plan import BatchPlan
from vssea_core.scenario import Scenario

LONG: frozenset[str] = frozenset()
PROBED = 64
FIRST = 3
KEPT_PLANS = 1


def plan_batch(document: str, workers: int) -> dict[str, Any]:
    """Return what a batch will take, from runs spread over all of it. Raises ValueError if it makes no sense."""
    plan = BatchPlan(Batch.model_validate_json(document))
    keep, columns, numbers_of = plan.batch.keep, columns_of(plan), NumbersOf()
    samples, in_lanes, refused = [], [], []
    for number in np.unique(np.linspace(0, plan.count - 1, PROBED).round().astype(int)).tolist():
        try:
            numbers = numbers_of(plan.scenario(number))
        except ValueError as refusal:
            refused.append(f"Run {number}: {refusal}")
            continue
        samples.append(numbers.count)
        in_lanes.append(numbers.variant is not None)
    seconds = _mean([seconds_of(each, lanes, keep) for each, lanes in zip(samples, in_lanes, strict=True)])
    size = _mean([bytes_of(len(columns), each, keep) for each in samples])
    held = max((held_of(each, keep) for each in samples), default=0.0)
    return {
        "runs": plan.count,
        "samples": round(plan.count * _mean(samples)),
        "in_lanes": _mean(in_lanes),
        "seconds": plan.count * seconds / workers,
        "bytes": round(plan.count * size),
        "paths": plan.paths,
        "columns": columns,
        "first": [plan.values(number) for number in range(min(FIRST, plan.count))],
        "refused": refused,
        "all_refused": not samples,
        "part_size": part_size(plan.count, seconds, size, workers, held) if samples else 0,
    }


def values_of(path: str, run: int) -> dict[str, Any]:
    """Return the values by path of a run of the batch whose document is in a file."""
    return _plan_in(path).values(run)


def scenario_of(path: str, run: int) -> Scenario:
    """Return the whole scenario of a run of the batch whose document is in a file. Raises ValueError if it is refused."""
    return _plan_in(path).scenario(run)


@lru_cache(KEPT_PLANS)
def _plan_in(path: str) -> BatchPlan:
    return BatchPlan(Batch.model_validate_json(Path(path).read_text("utf-8")))


def _mean(values: list[Any]) -> float:
    return float(np.mean(values)) if values else 0.0
