"""Compiling, or loading from the cache, what the workers call."""

from filelock import FileLock

from backend.compute import jobs
from backend.compute.requests import AxisRequest, MapRequest
from vssea_core.compiled import cache_folder
from vssea_core.scenarios import NOMINAL

SMALL = MapRequest(
    kind="stability_map", x=AxisRequest(name="spring", count=2), y=AxisRequest(name="bandwidth", count=2)
)
SHORT = NOMINAL.model_copy(update={"duration_s": 0.01})


def warm_up(first_job: str) -> None:
    """Run `first_job` once, and a short simulation with it; who comes second finds the machine code ready."""
    folder = cache_folder()
    folder.mkdir(parents=True, exist_ok=True)
    with FileLock(folder / f"{first_job}.lock"):
        if first_job == "plan_run":
            jobs.plan_run(SHORT)
        elif first_job == "margins_of":
            jobs.margins_of(SHORT)
        elif first_job == "analysis_task":
            for kind in ("stability_map", "margin_map"):
                jobs.analysis_task(SMALL.model_copy(update={"kind": kind}), lambda share, words="": True)
        else:
            jobs.simulate_scenario(SHORT, "none", 1, False)
