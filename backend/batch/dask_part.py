"""What a worker of a Dask cluster does with a part. The web process never imports this module."""

import gc
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from distributed import get_worker

from backend.batch.engine import PartFiles, PartTask
from backend.batch.part_files import part_files
from vssea_core.batch.document import Batch
from vssea_core.batch.part import run_part
from vssea_core.batch.plan import BatchPlan

_OWN = threading.local()
_AT_WORK = threading.Lock()
_under_way: set[int] = set()


def compute(part: PartTask) -> PartFiles | None:
    """Return a part's files, None as soon as the scheduler wants it no longer. Raises PartRefused for another version."""
    worker = get_worker()
    part.check_version(f"the worker {worker.address}", "install the same")
    plan = _plan_of(part.document)
    key = worker.get_current_task()

    def goes_on(done: int) -> bool:
        task = worker.state.tasks.get(key)
        return task is not None and task.state == "executing"

    with _no_collections():
        computed = run_part(plan, part.first, part.count, goes_on)
    return None if computed is None else part_files(computed)


def _plan_of(document: str) -> BatchPlan:
    """Return the plan of a document, made once for each batch and thread: threads must not share what it keeps."""
    if getattr(_OWN, "document", None) != document:
        _OWN.document, _OWN.plan = document, BatchPlan(Batch.model_validate_json(document))
    plan: BatchPlan = _OWN.plan
    return plan


@contextmanager
def _no_collections() -> Iterator[None]:
    """Keep collections of garbage off while any thread computes: over thousands of scenarios they take a third of the time."""
    own = threading.get_ident()
    with _AT_WORK:
        _under_way.add(own)
        gc.disable()
    try:
        yield
    finally:
        with _AT_WORK:
            _under_way.discard(own)
            if not _under_way:
                gc.enable()
