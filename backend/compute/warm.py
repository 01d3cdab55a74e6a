"""Compiling, or loading from the cache, what the workers call."""

from filelock import FileLock

from backend.compute import jobs
from vssea_core.compiled import cache_folder
from vssea_core.scenarios import NOMINAL

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
        else:
            jobs.simulate_scenario(SHORT, "none", 1, False)
