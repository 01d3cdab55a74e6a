"""Compiling, or loading from the cache, what the workers call."""

from filelock import FileLock

from backend.compute import jobs
from vssea_core.compiled import cache_folder
from vssea_core.scenarios import NOMINAL


def warm_up() -> None:
    """Run each job once on a short scenario; who comes second finds the machine code ready."""
    folder = cache_folder()
    folder.mkdir(parents=True, exist_ok=True)
    with FileLock(folder / "compiling.lock"):
        jobs.simulate_scenario(NOMINAL.model_copy(update={"duration_s": 0.01}), "none", 1, False)
