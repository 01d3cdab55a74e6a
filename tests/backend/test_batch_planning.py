"""What the planning worker says of a batch before any run is computed."""

import json
import pickle

import pytest

from backend.batch.asked import Asked
from backend.batch.estimate import estimate_of, why_refused
from backend.batch.jobs import PROBED, TOLD_ERRORS, plan_batch, read_batch
from backend.problem import Problem
from vssea_core.batch.document import Batch, Listed

PATH = "actuator.link.inertia"


def planned(*values: float) -> dict[str, object]:
    return plan_batch(Batch(vary=(Listed(path=PATH, values=values),)).model_dump_json(), 2)


def test_what_is_left_out_or_ordered_otherwise_makes_no_other_batch() -> None:
    first, second = read_batch(b'{"seed": 0, "name": "batch"}'), read_batch(b"{}")
    assert first == second
    assert isinstance(first, Asked)
    assert Batch.model_validate_json(first.document) == Batch()
    assert first != read_batch(b'{"seed": 1}')


@pytest.mark.parametrize(
    ("body", "status", "words"),
    [
        (b"", 400, "The body is empty; expected the document of a batch"),
        (b" \n", 400, "The body is empty; expected the document of a batch"),
        (b"{not json", 400, "The body is not JSON: "),
        (b"\xff\xfe", 400, "The body is not JSON: "),
        (b"[" * 100_000, 400, "The body is not JSON: "),
        (b'{"very": 1}', 422, "unknown name; known here: name"),
        (b"[1]", 422, "expected"),
    ],
)
def test_what_is_wrong_with_a_body_comes_back_as_a_problem_as_from_any_other_route(
    body: bytes, status: int, words: str
) -> None:
    problem = pickle.loads(pickle.dumps(read_batch(body)))  # as between processes
    assert isinstance(problem, Problem)
    assert (problem.status, words in problem.detail) == (status, True)
    assert all(each.keys() == {"field", "value", "message"} for each in problem.document()["errors"])


def test_of_very_many_wrong_values_some_are_told_and_all_are_counted() -> None:
    document = {
        "keep": {"channels": []},
        "vary": [{"kind": "list", "path": "seed", "values": [1], "no": 1}] * 16,
        **{f"x{n}": "y" * 1000 for n in range(1000)},
    }
    problem = read_batch(json.dumps(document).encode())
    assert isinstance(problem, Problem)
    assert len(problem.errors) == TOLD_ERRORS
    assert f"{1017 - 1} more" in problem.detail


def test_a_batch_whose_every_run_was_looked_at_and_refused_cannot_be_started() -> None:
    plan = planned(*[-1.0] * PROBED)
    assert str(why_refused(plan)).startswith("no run of this batch can start; Run 0: ")


def test_runs_that_were_not_looked_at_may_start_so_the_batch_may_too_and_the_estimate_warns() -> None:
    values = [-1.0] * 1000
    values[1] = values[2] = 0.5  # between those that are looked at
    plan = planned(*values)
    assert why_refused(plan) is None
    assert estimate_of(plan)["warning"] == f"none of the {PROBED} runs looked at can start"
    assert int(str(plan["part_size"])) > 0


def test_a_batch_with_a_run_that_can_start_warns_of_nothing() -> None:
    plan = planned(-1.0, 0.5)
    assert (why_refused(plan), plan["warning"]) == (None, "")
