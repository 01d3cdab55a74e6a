"""Workers as the web process sees them: awaited, time-limited, replaced when they die."""

import asyncio
import logging
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any, Protocol

from backend.compute.exchange import Exchange, Hearer
from backend.processes import CONTEXT, started

logger = logging.getLogger(__name__)
START_LIMIT_S = 300.0  # a slow machine compiles for long at its first start
ENTRY = "backend.compute.worker:run_worker"


class JobRefusedError(ValueError):
    """The job says that its input makes no sense; the text is a sentence for the user."""


class JobFailedError(RuntimeError):
    """The worker died, ran out of time, or failed in a way that is not the user's doing."""


class WorkerLostError(JobFailedError):
    """The worker died; the next job starts another one."""


class JobCancelledError(RuntimeError):
    """The job was ended because it was no longer wanted."""


class Jobs(Protocol):
    """Whoever answers jobs, as a worker does."""

    async def run(self, job: str, *arguments: Any, time_limit_s: float = 60.0) -> Any:
        """Return what the job returns. Raises JobRefusedError, JobFailedError."""


class Worker:
    """One worker process with a queue of its own; `first_job` is compiled at its start, "" needs no compiler."""

    def __init__(
        self, name: str, first_job: str, niceness: int = 10, entry: str = ENTRY, jobs: str = "backend.compute.jobs"
    ) -> None:
        self._name, self._first_job, self._niceness, self._entry = name, first_job, niceness, entry
        self._jobs = jobs
        self._turn = asyncio.Lock()
        self._process: BaseProcess | None = None
        self._pipe: Connection
        self._thread: ThreadPoolExecutor  # of its own: a job that runs for hours keeps nobody else waiting for one
        self._exchange: Exchange | None = None

    async def start(self) -> None:
        """Start the process and wait until its kernels are compiled."""
        async with self._turn:
            await self._ready()

    async def run(
        self,
        job: str,
        *arguments: Any,
        time_limit_s: float = 60.0,
        on_progress: Hearer | None = None,
        end_limit_s: float = 0.0,
    ) -> Any:
        """Return what `job` returns; `on_progress` hears a share from 0 to 1 and words.

        Raises JobRefusedError, JobFailedError or, after `end_job`, JobCancelledError. An overdue job ends with its process, and
        so does a cancelled one, unless it is long and ends at its next progress, within `end_limit_s`.
        """
        async with self._turn:
            exchange = self._exchange = Exchange((job, arguments), on_progress)
            try:
                await self._ready()
                return await self._answer(exchange, job, time_limit_s, end_limit_s)
            finally:
                self._exchange = None

    def end_job(self) -> None:
        """Ask the long job that runs to end at its next progress; the process stays."""
        if self._exchange is not None:
            self._exchange.end()

    async def stop(self) -> None:
        """End the process."""
        await self._end()

    @property
    def process_id(self) -> int | None:
        """Number of the process, None if it does not run."""
        return self._process.pid if self._process is not None else None

    async def _ready(self) -> None:
        # An idle worker says nothing: a readable pipe has lost its other end.
        if self._process is not None and self._process.is_alive() and not self._pipe.poll():
            return
        await self._end()
        self._pipe, theirs = CONTEXT.Pipe()
        self._thread = ThreadPoolExecutor(1, self._name)
        self._process = await asyncio.to_thread(
            started, self._name, self._entry, theirs, self._niceness, self._first_job, self._jobs
        )
        theirs.close()
        await self._answer(Exchange(), "start", START_LIMIT_S)

    async def _answer(self, exchange: Exchange, job: str, time_limit_s: float, end_limit_s: float = 0.0) -> Any:
        answer = asyncio.get_running_loop().run_in_executor(self._thread, exchange, self._pipe)
        try:
            async with asyncio.timeout(time_limit_s):
                kind, content = await asyncio.shield(answer)
        except TimeoutError as late:
            await self._end()
            raise JobFailedError(
                f"this took longer than {time_limit_s:g} s and was given up; shorten the scenario"
            ) from late
        except asyncio.CancelledError:
            await asyncio.shield(self._given_up(exchange, answer, end_limit_s))
            raise
        if kind == "lost":
            await self._end()
            raise WorkerLostError(f"the {self._name} process ended unexpectedly; try again") from content
        if kind == "refused":
            raise JobRefusedError(content)
        if kind == "cancelled":
            raise JobCancelledError(f"{job} was cancelled")
        if kind == "failed":
            logger.error("job %s failed:\n%s", job, content)
            raise JobFailedError("an internal error; the server's log has the details")
        return content

    async def _given_up(self, exchange: Exchange, answer: asyncio.Future[Any], end_limit_s: float) -> None:
        if end_limit_s:
            exchange.end()
            await asyncio.wait({answer}, timeout=end_limit_s)
        if not answer.done() or answer.result()[0] == "lost":
            await self._end()

    async def _end(self) -> None:
        process, self._process = self._process, None
        if process is None:
            return
        process.terminate()
        await asyncio.to_thread(process.join, 2.0)
        if process.exitcode is None:
            process.kill()
        self._pipe.close()
        self._thread.shutdown(wait=False)


class Pool:
    """A worker for each kind of work, so that none waits for another.

    Designs that live changes wait for; the analysis that follows each change; simulations; long tasks; recordings that
    somebody looks at; recordings that are summarised, exported and imported; a look at a rig. The last three need no
    compiler, and start when they are needed.
    """

    def __init__(self) -> None:
        self.design = Worker("vssea design", "plan_run", niceness=0)
        self.analysis = Worker("vssea analysis", "margins_of", niceness=8)
        self.simulation = Worker("vssea simulation", "simulate_scenario", niceness=10)
        self.tasks = Worker("vssea tasks", "analysis_task", niceness=15)
        self.recordings = Worker("vssea recordings", "", niceness=12, jobs="backend.recordings.jobs")
        self.archive = Worker("vssea archive", "", niceness=13, jobs="backend.recordings.jobs")
        self.rig_check = Worker("vssea rig check", "", niceness=5, jobs="backend.compute.rig_jobs")
        self._further: list[Callable[[], list[int]]] = []

    @property
    def _workers(self) -> tuple[Worker, ...]:
        return self.design, self.analysis, self.simulation, self.tasks, self.recordings, self.archive, self.rig_check

    def process_ids(self) -> list[int]:
        """Return the numbers of the processes that run, those of others with the same rights included."""
        own = [worker.process_id for worker in self._workers if worker.process_id is not None]
        return own + [number for others in self._further for number in others()]

    def also(self, process_ids: Callable[[], list[int]]) -> None:
        """Count the processes of others among the workers: what keeps workers off a core then keeps them off, too."""
        self._further.append(process_ids)

    async def stop(self) -> None:
        """End all of them."""
        await asyncio.gather(*(worker.stop() for worker in self._workers))
