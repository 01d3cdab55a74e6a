"""A worker as the web process sees it: ended, overdue, lost, and on a thread of its own."""

import asyncio
import os
import signal
import threading
from collections.abc import Callable, Coroutine
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest

from backend.compute.pool import JobCancelledError, JobFailedError, Worker, WorkerLostError

JOBS = "tests.backend.waiting_jobs"
PATIENCE_S = 60.0


def with_worker(work: Callable[[Worker], Coroutine[Any, Any, None]]) -> None:
    async def run() -> None:
        worker = Worker("waiting", "", jobs=JOBS)
        try:
            async with asyncio.timeout(PATIENCE_S):
                await worker.start()
                await work(worker)
        finally:
            await worker.stop()

    asyncio.run(run())


async def begun(worker: Worker, job: str, **more: Any) -> asyncio.Task[Any]:
    """Return a job that its worker has told of."""
    heard = asyncio.Event()
    task = asyncio.create_task(worker.run(job, **more, on_progress=lambda *_: heard.set()))
    await heard.wait()
    return task


def test_a_job_needs_no_thread_of_those_that_others_wait_for() -> None:
    async def work(worker: Worker) -> None:
        asyncio.get_running_loop().set_default_executor(ThreadPoolExecutor(1))
        held = threading.Event()
        busy = asyncio.create_task(asyncio.to_thread(held.wait, PATIENCE_S))  # all threads that there are
        try:
            assert await worker.run("answer", 7) == 7
        finally:
            held.set()
        assert await busy

    with_worker(work)


def test_a_long_job_is_ended_whenever_that_is_asked_and_the_process_stays() -> None:
    async def work(worker: Worker) -> None:
        process = worker.process_id
        for steps in range(6):
            job = asyncio.create_task(worker.run("until_ended"))
            await asyncio.sleep(0)
            for _ in range(steps):
                await asyncio.sleep(0)
            worker.end_job()
            with pytest.raises(JobCancelledError):
                await job
        assert await worker.run("answer", 7) == 7
        assert worker.process_id == process

    with_worker(work)


def test_a_cancelled_job_that_ends_in_time_leaves_its_process_and_another_one_ends_with_it() -> None:
    async def work(worker: Worker) -> None:
        process = worker.process_id
        job = await begun(worker, "until_ended", end_limit_s=PATIENCE_S)
        job.cancel()
        await asyncio.gather(job, return_exceptions=True)
        assert worker.process_id == process
        job = asyncio.create_task(worker.run("for_ever", end_limit_s=0.01))
        await asyncio.sleep(0)
        job.cancel()
        await asyncio.gather(job, return_exceptions=True)
        assert await worker.run("answer", 7) == 7

    with_worker(work)


def test_an_overdue_job_says_so_and_a_lost_worker_too() -> None:
    async def work(worker: Worker) -> None:
        with pytest.raises(JobFailedError, match=r"took longer than 0\.01 s") as overdue:
            await worker.run("for_ever", time_limit_s=0.01)
        assert not isinstance(overdue.value, WorkerLostError)
        job = await begun(worker, "until_ended")
        os.kill(worker.process_id or 0, signal.SIGKILL)
        with pytest.raises(WorkerLostError, match="ended unexpectedly"):
            await job
        assert await worker.run("answer", 7) == 7

    with_worker(work)
