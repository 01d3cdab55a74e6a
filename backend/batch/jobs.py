"""What a batch's planning worker can do: a document in, plain answers out. The web process never imports this module."""

import hashlib
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from backend.batch.asked import Asked
from backend.batch.limits import runs_of
from backend.batch.sizes import COLUMN_BYTES, bytes_of, held_of, part_size, seconds_of
from backend.problem import Problem, from_validation, refused
from vssea_core.batch.document import Batch
from vssea_core.batch.numbers import NumbersOf
from vssea_core.batch.part import columns_of
from vssea_core.batch.plan import BatchPlan
from vssea_core.batch.refusals import VaryError
from vssea_core.field_errors import FieldError
from vssea_core.scenario import Scenario

LONG: frozenset[str] = frozenset()
PROBED = 64
FIRST = 3
KEPT_PLANS = 1
TOLD_ERRORS = 100


def read_batch(body: bytes) -> Asked | Problem:
    """Return the batch in the body of a request, or what is wrong with it."""
    if not body.strip():
        return Problem(400, "Not JSON", "The body is empty; expected the document of a batch as JSON.")
    try:
        batch = Batch.model_validate_json(body)
    except ValidationError as error:
        if (first := error.errors(include_url=False)[0])["type"] == "json_invalid":
            return Problem(400, "Not JSON", f"The body is not JSON: {first['ctx']['error']}.")
        problem = from_validation(error, Batch)
        errors = problem.document()["errors"][:TOLD_ERRORS]
        return refused(problem.detail, *(FieldError(**each) for each in errors))
    document = batch.model_dump_json()
    digest = hashlib.sha256(document.encode()).hexdigest()
    return Asked(document, digest, batch.name, batch.description, batch.keep.trajectories, runs_of(batch))


def plan_asked(document: str, workers: int) -> dict[str, Any] | Problem:
    """Return the plan of a batch, or the problem of the field that makes no sense."""
    try:
        return plan_batch(document, workers)
    except VaryError as refusal:
        return refused(f"{refusal}.", FieldError(refusal.field, None, str(refusal)))


def plan_batch(document: str, workers: int) -> dict[str, Any]:
    """Return what a batch will take, from runs spread over all of it. Raises ValueError if it makes no sense."""
    plan = BatchPlan(Batch.model_validate_json(document))
    keep, columns, numbers_of = plan.batch.keep, columns_of(plan), NumbersOf()
    samples, in_lanes, sentences = [], [], []
    for number in np.unique(np.linspace(0, plan.count - 1, PROBED).round().astype(int)).tolist():
        try:
            numbers = numbers_of(plan.scenario(number))
        except ValueError as refusal:
            sentences.append(f"Run {number}: {refusal}")
            continue
        samples.append(numbers.count)
        in_lanes.append(numbers.variant is not None)
    run_s = _mean([seconds_of(each, lanes, keep) for each, lanes in zip(samples, in_lanes, strict=True)])
    size = _mean([bytes_of(len(columns), each, keep) for each in samples])
    if not samples:  # a run that is refused takes time and a row, too
        run_s, size = seconds_of(0, True, keep), bytes_of(len(columns), 0, keep)
    held = max((held_of(each, keep) for each in samples), default=0.0)
    runs_a_part = part_size(plan.count, run_s, size, workers, held)
    parts = -(-plan.count // runs_a_part)
    return {
        "runs": plan.count,
        "samples": round(plan.count * _mean(samples)),
        "in_lanes": _mean(in_lanes),
        "seconds": plan.count * run_s / workers,
        "bytes": round(plan.count * size + parts * COLUMN_BYTES * len(columns)),
        "paths": plan.paths,
        "columns": columns,
        "first": [plan.values(number) for number in range(min(FIRST, plan.count))],
        "refused": sentences,
        "warning": "" if samples else f"none of the {len(sentences)} runs looked at can start",
        "all_refused": not samples and len(sentences) == plan.count,
        "part_size": runs_a_part,
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
