"""What the planning worker says of a batch before any run is computed."""

from backend.batch.estimate import estimate_of, why_refused
from backend.batch.jobs import PROBED, plan_batch
from vssea_core.batch.document import Batch, Listed

PATH = "actuator.link.inertia"


def planned(*values: float) -> dict[str, object]:
    return plan_batch(Batch(vary=(Listed(path=PATH, values=values),)).model_dump_json(), 2)


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
