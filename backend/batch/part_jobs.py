"""What a batch's workers can do: a part in, its files out. The web process never imports this module."""

import gc
from functools import lru_cache

from filelock import FileLock

from backend.batch.engine import PartFiles, PartRefused, PartTask
from backend.batch.part_files import part_files
from backend.compute.worker import Progress
from vssea_core.batch.document import Batch, Listed
from vssea_core.batch.part import run_part
from vssea_core.batch.plan import BatchPlan
from vssea_core.compiled import cache_folder
from vssea_core.scenarios import NOMINAL

LONG = frozenset({"compute_part"})
PLANS = 2
"""A sample's plan takes longer than a part; it is kept from part to part."""
SHORT = NOMINAL.model_copy(update={"duration_s": 0.02})


@lru_cache(PLANS)
def plan_of(document: str) -> BatchPlan:
    """Return the plan of a batch's document. Raises ValueError."""
    return BatchPlan(Batch.model_validate_json(document))


def warm_up() -> None:
    """Compile what parts need, or load it from the cache; what was made by then is left alone by collections of garbage."""
    amplitudes = Listed(kind="list", path="reference.amplitude", values=(0.1, 0.2, 0.3, 0.4))
    few = BatchPlan(Batch(scenario=SHORT, vary=(amplitudes,)))
    folder = cache_folder()
    folder.mkdir(parents=True, exist_ok=True)
    with FileLock(folder / "batch.lock"):  # who comes second finds the machine code ready
        run_part(few, 0, few.count)
    gc.collect()
    gc.freeze()


def compute_part(task: PartTask, progress: Progress) -> PartFiles | None:
    """Return the files of a part; the job ends early when its end is asked for. Raises ValueError."""
    try:
        task.check_version("a worker that was started later", "start the program anew")
    except PartRefused as refusal:
        raise ValueError(str(refusal)) from refusal
    gc.disable()  # collections over the scenarios of thousands of runs would take a third of the time
    try:
        part = run_part(plan_of(task.document), task.first, task.count, lambda done: progress(done / task.count))
        return None if part is None else part_files(part)
    finally:
        gc.enable()
        gc.collect(
            1
        )  # what this part has left; a look at all that is kept for the next ones would take longer each time
