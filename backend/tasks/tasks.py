"""The long tasks of this server: queued, run one at a time in a worker of their own, watched and cancelled by number."""

import asyncio
from collections import OrderedDict
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any, Literal

from backend.compute.exchange import Hearer
from backend.compute.pool import JobCancelledError, JobFailedError, JobRefusedError, Worker
from backend.problem import Problem

State = Literal["queued", "running", "done", "refused", "failed", "cancelled"]
KEPT = 40
WAITING = 16
TIME_LIMIT_S = 3600.0


@dataclass
class Task:
    """One piece of long work: what was asked, how far it is, and its result once it is done."""

    number: int
    kind: str
    title: str
    work: Callable[[Hearer], Awaitable[Any]]
    end: Callable[[], None]
    state: State = "queued"
    progress: float = 0.0
    words: str = ""
    reason: str | None = None
    result: Any = None
    asked_at: str = field(default_factory=lambda: datetime.now(UTC).isoformat(timespec="seconds"))
    seconds: float | None = None

    def document(self) -> dict[str, Any]:
        """Return it without its result."""
        return {
            "id": self.number, "kind": self.kind, "title": self.title, "state": self.state, "progress": self.progress,
            "words": self.words, "reason": self.reason, "asked_at": self.asked_at, "seconds": self.seconds,
        }  # fmt: skip


class Tasks:
    """Runs tasks in the order in which they were asked; keeps the newest results."""

    def __init__(self, worker: Worker) -> None:
        self._worker = worker
        self._tasks: OrderedDict[int, Task] = OrderedDict()
        self._last = 0
        self._runner: asyncio.Task[None] | None = None

    def ask(self, kind: str, title: str, job: str, *arguments: Any) -> Task:
        """Queue a task that is one job of the tasks' worker. Raises Problem if too many wait."""

        def work(hear: Hearer) -> Awaitable[Any]:
            return self._worker.run(job, *arguments, time_limit_s=TIME_LIMIT_S, on_progress=hear)

        return self.ask_work(kind, title, work, self._worker.end_job)

    def ask_work(
        self, kind: str, title: str, work: Callable[[Hearer], Awaitable[Any]], end: Callable[[], None]
    ) -> Task:
        """Queue a task that is more than one job: `work` tells how far it is; `end` asks it to end. Raises Problem."""
        if sum(task.state == "queued" for task in self._tasks.values()) >= WAITING:
            raise Problem(429, "Too many tasks", f"{WAITING} tasks are waiting; expected fewer, so cancel some first.")
        self._last += 1
        task = Task(self._last, kind, title, work, end)
        self._tasks[task.number] = task
        over = [n for n, kept in self._tasks.items() if kept.state not in ("queued", "running")][
            : max(0, len(self._tasks) - KEPT)
        ]
        for number in over:
            del self._tasks[number]
        if self._runner is None or self._runner.done():
            self._runner = asyncio.create_task(self._run_queued())
        return task

    def find(self, number: int) -> Task:
        """Return a task. Raises Problem."""
        task = self._tasks.get(number)
        if task is None:
            raise Problem(404, "No such task", f"There is no task {number}; GET /api/tasks lists those that are kept.")
        return task

    def list(self) -> list[Task]:
        """Return the tasks that are kept, newest first."""
        return list(reversed(self._tasks.values()))

    def result(self, number: int) -> Any:
        """Return what a task made. Raises Problem if it is not done."""
        task = self.find(number)
        if task.state != "done":
            raise Problem(409, "Not done", f"Task {number} is {task.state}{f': {task.reason}' if task.reason else ''}.")
        return task.result

    def cancel(self, number: int) -> Task:
        """Cancel a task that waits or runs; one that has ended is left as it is."""
        task = self.find(number)
        if task.state == "queued":
            task.state = "cancelled"
        elif task.state == "running":
            task.words = "ending"
            task.end()
        return task

    async def stop(self) -> None:
        """End what runs."""
        if self._runner is not None:
            self._runner.cancel()
            await asyncio.gather(self._runner, return_exceptions=True)

    async def _run_queued(self) -> None:
        while waiting := [task for task in self._tasks.values() if task.state == "queued"]:
            await self._run(waiting[0])

    async def _run(self, task: Task) -> None:
        task.state, task.words = "running", "starting (the first of its kind compiles its kernels)"
        begun = asyncio.get_running_loop().time()

        def hear(share: float, words: str) -> None:
            task.progress, task.words = share, words

        try:
            task.result = await task.work(hear)
            task.state, task.progress = "done", 1.0
        except JobCancelledError:
            task.state = "cancelled"
        except JobRefusedError as refusal:
            task.state, task.reason = "refused", str(refusal)
        except JobFailedError as failure:
            task.state, task.reason = "failed", str(failure)
        task.words = ""
        task.seconds = round(asyncio.get_running_loop().time() - begun, 3)
