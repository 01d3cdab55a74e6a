"""Preparing a scenario in the design worker before it may run: its gains, and whether its own loop is stable."""

from typing import Any

from backend.compute.pool import JobFailedError, JobRefusedError, Worker
from backend.problem import Problem, refused
from vssea_core.scenario import Scenario


async def planned(design: Worker, scenario: Scenario) -> Any:
    """Return the PreparedRun of a scenario. Raises Problem if it would be unstable or could not be computed."""
    try:
        return await design.run("plan_run", scenario)
    except JobRefusedError as refusal:
        sentence = str(refusal)
        raise refused(f"{sentence[:1].upper()}{sentence[1:]}. The old tuning keeps running.") from refusal
    except JobFailedError as failure:
        raise Problem(503, "Not computed", f"The tuning could not be computed: {failure}.") from failure
