"""The batches as the settings say: on this machine's cores, or on a cluster."""

import importlib
import os
from collections.abc import Callable

from backend.batch.batches import Batches
from backend.batch.catalogue import BatchCatalogue
from backend.batch.engine import Engine
from backend.batch.limits import Limits
from backend.batch.local_engine import LocalEngine
from backend.batch.version import model_version
from backend.compute.pool import Worker
from backend.settings import Settings
from backend.store.database import Database

PLANS_NICENESS, RESULTS_NICENESS = 10, 12


class ServedBatches(Batches):
    """Batches with the processes that plan them and read their results."""

    def __init__(self, settings: Settings, database: Database) -> None:
        model_version()  # of the sources that this server has started with
        self._planner = Worker("vssea batches", "", PLANS_NICENESS, jobs="backend.batch.jobs")
        self._reader = Worker("vssea results", "", RESULTS_NICENESS, jobs="backend.batch.result_jobs")
        catalogue, folder = BatchCatalogue(database), settings.batches_folder
        super().__init__(folder, Limits.of(settings), catalogue, engine_for(settings), self._planner, self._reader)

    def process_ids(self) -> list[int]:
        """Return the numbers of all its processes."""
        own = [worker.process_id for worker in (self._planner, self._reader)]
        return [number for number in own if number is not None] + self.engine.process_ids()

    async def stop(self) -> None:
        """End them too."""
        await super().stop()
        await self._planner.stop()
        await self._reader.stop()


class EngineRefused(RuntimeError):
    """The engine that the settings name cannot be had."""


def engine_for(settings: Settings) -> Engine:
    """Return the engine that the settings name. Raises EngineRefused."""
    if settings.batch_engine is None:
        return LocalEngine(settings.batch_workers or os.cpu_count() or 1)
    # Only a server with a cluster needs its library.
    made: Callable[[str], Engine] = importlib.import_module("backend.batch.dask_engine").DaskEngine
    try:
        return made(settings.batch_engine)
    except ValueError as refusal:
        raise EngineRefused(str(refusal)) from refusal
