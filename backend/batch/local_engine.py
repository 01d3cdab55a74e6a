"""Parts of batches computed by processes of this machine, which give way to everything else."""

import asyncio

from backend.batch.engine import PartFailed, PartFiles, PartRefused, PartTask, WorkerLost
from backend.compute.pool import JobCancelledError, JobFailedError, JobRefusedError, Worker, WorkerLostError

JOBS = "backend.batch.part_jobs"
NICENESS = 15
IDLE_S = 60.0
"""Processes without a part for so long are ended; the next part starts them anew."""
END_LIMIT_S = 0.15
"""A worker that has not ended its part by then is ended itself."""
WARM_LIMIT_S = 600.0
PART_LIMIT_S = 3600.0


class LocalEngine:
    """Computes parts in `workers` processes, each started when it is first needed."""

    def __init__(self, workers: int, idle_s: float = IDLE_S, end_limit_s: float = END_LIMIT_S) -> None:
        self.threads = self.at_a_time = workers
        self.name = f"this machine, {workers} worker{'' if workers == 1 else 's'}"
        self._all = [Worker(f"vssea batch {number}", "", NICENESS, jobs=JOBS) for number in range(1, workers + 1)]
        self._turns = asyncio.LifoQueue[Worker]()  # the one that is warm goes first
        for worker in reversed(self._all):
            self._turns.put_nowait(worker)
        self._warm: dict[Worker, int | None] = {}
        self._idle_s, self._end_limit_s = idle_s, end_limit_s
        self._idle: asyncio.Task[None] | None = None

    @property
    def waiting_for(self) -> str:
        """What has to be there first: a worker with its machine code, which the first one of a version compiles."""
        is_warm = any(self._warm.get(worker) == worker.process_id is not None for worker in self._all)
        return "" if is_warm else "the workers to start and have their machine code"

    async def connect(self) -> None:
        """Do nothing: processes start with the first part."""

    async def run(self, part: PartTask) -> PartFiles:
        """Return a computed part. Raises PartFailed, WorkerLost; cancelled, the part ends within 0.2 s."""
        if self._idle is not None:
            self._idle.cancel()
        worker = await self._turns.get()
        try:
            return await self._computed(worker, part)
        finally:
            self._turns.put_nowait(worker)
            if self._turns.qsize() == len(self._all):
                self._idle = asyncio.create_task(self._end_idle())

    def process_ids(self) -> list[int]:
        """Return the numbers of the processes that run."""
        return [worker.process_id for worker in self._all if worker.process_id is not None]

    async def end(self) -> None:
        """End the processes."""
        if self._idle is not None:
            self._idle.cancel()
        await asyncio.gather(*(worker.stop() for worker in self._all))

    async def _computed(self, worker: Worker, part: PartTask) -> PartFiles:
        try:
            if worker.process_id is None or self._warm.get(worker) != worker.process_id:
                await worker.run("warm_up", time_limit_s=WARM_LIMIT_S)
                self._warm[worker] = worker.process_id
            files: PartFiles = await worker.run(
                "compute_part", part, time_limit_s=PART_LIMIT_S, end_limit_s=self._end_limit_s
            )
        except WorkerLostError as lost:
            raise WorkerLost(str(lost)) from lost
        except JobRefusedError as refusal:
            raise PartRefused(str(refusal)) from refusal
        except (JobFailedError, JobCancelledError) as failure:
            raise PartFailed(str(failure)) from failure
        return files

    async def _end_idle(self) -> None:
        await asyncio.sleep(self._idle_s)
        await asyncio.gather(*(worker.stop() for worker in self._all))
