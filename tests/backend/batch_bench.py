"""The manager of batches with an engine and workers that do what a test says, and with a clock that it moves."""

import asyncio
from collections.abc import Callable, Coroutine
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

from backend.batch.batches import Batches
from backend.batch.catalogue import BatchCatalogue
from backend.batch.engine import PartFiles, PartTask
from backend.batch.folder import BatchFolder
from backend.batch.jobs import read_batch
from backend.batch.limits import Limits
from backend.batch.times import Times
from backend.store.database import Database
from vssea_core.batch.document import Batch, Grid

LIMIT_S = 10.0
RUNS, PART_SIZE = 100, 10


class FakeEngine:
    """Computes a part when the test says so, or at once; remembers which were asked for and which were ended."""

    name, waiting_for = "an engine", ""

    def __init__(self, workers: int = 1) -> None:
        self.threads, self.at_a_time = 1, workers
        self.away: list[Exception] = []
        self.asked: list[int] = []
        self.ended: list[int] = []
        self.held: set[int] = set()
        self.goes_wrong: dict[int, list[Exception]] = {}
        self.size = 4

    async def connect(self) -> None:
        if self.away:
            raise self.away[0]

    async def run(self, part: PartTask) -> PartFiles:
        self.asked.append(part.number)
        if self.goes_wrong.get(part.number):
            raise self.goes_wrong[part.number].pop(0)
        try:
            await until(lambda: part.number not in self.held)
        except asyncio.CancelledError:
            self.ended.append(part.number)
            raise
        return PartFiles(b"r" * self.size, b"", {"done": part.count})

    def process_ids(self) -> list[int]:
        return []

    async def end(self) -> None:
        self.asked.append(-1)


class FakeJobs:
    """The workers that plan and read."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.planned = self.threads = 0

    async def run(self, job: str, *arguments: Any, time_limit_s: float = 60.0) -> Any:
        if job == "read_batch":
            return read_batch(*arguments)
        if job == "counts_by_part":
            folder = BatchFolder(Path(arguments[0]))
            return {number: _counts(folder.rows_of(number).read_bytes()) for number in folder.parts()}
        self.planned += 1
        self.threads = arguments[1]
        return {
            "runs": RUNS, "part_size": PART_SIZE, "paths": ["seed"], "columns": ["run"], "bytes": 400, "seconds": 1.0,
            "refused": [], "all_refused": False, "warning": "", "samples": 0, "in_lanes": 1.0, "first": [],
        }  # fmt: skip


def _counts(rows: bytes) -> dict[str, int] | None:
    return {"done": PART_SIZE} if rows.startswith(b"r") else None


class Bench:
    """A manager over one folder and database, with times that go on only when they are moved."""

    def __init__(self, folder: Path, engine: FakeEngine, limits: Limits) -> None:
        self.folder, self.engine, self.time_s = folder, engine, 0.0
        self.slept, self.passing = list[float](), False
        self.database = Database(f"sqlite:///{folder / 'vssea.sqlite'}")
        self.jobs, self.news = FakeJobs(folder), list[dict[str, Any]]()
        self.batches = Batches(
            folder / "batches", limits, BatchCatalogue(self.database), engine, self.jobs, self.jobs,
            Times(lambda: self.time_s, lambda: datetime(2026, 1, 1, tzinfo=UTC) + timedelta(seconds=self.time_s), self.sleep),
        )  # fmt: skip

    async def sleep(self, seconds: float) -> None:
        self.slept.append(seconds)
        if self.passing:
            self.time_s += seconds
        end_s = self.time_s + (0.0 if self.passing else seconds)
        await until(lambda: self.time_s >= end_s)

    async def create(self, key: str | None = None, seed: int = 0) -> str:
        self.time_s += 1.0
        row, _ = await self.batches.create(document(seed), key)
        return row.id

    async def state(self, batch: str) -> str:
        return str((await self.batches.document(batch))["state"])

    async def ended(self, batch: str) -> dict[str, Any]:
        async with asyncio.timeout(LIMIT_S):
            while True:
                found = await self.batches.document(batch)
                if found["state"] not in ("queued", "running"):
                    return found

    def parts(self, batch: str) -> list[int]:
        return BatchFolder(self.folder / "batches" / batch).parts()


async def until(look: Callable[[], object]) -> None:
    async with asyncio.timeout(LIMIT_S):
        while True:
            if look():
                return
            await asyncio.sleep(0)


def document(seed: int = 0) -> bytes:
    batch = Batch(vary=(Grid(kind="grid", path="seed", low=0.0, high=99.0, count=RUNS),), seed=seed)
    return batch.model_dump_json().encode()


def with_bench(
    folder: Path,
    work: Callable[[Bench], Coroutine[Any, Any, None]],
    engine: FakeEngine | None = None,
    limits: Limits = Limits(1000, 1e9, 2),  # noqa: B008 - frozen
    passing: bool = False,
) -> Bench:
    """Run `work` with a manager that is started before and stopped afterwards; `passing` lets pauses pass at once."""

    async def run() -> Bench:
        bench = Bench(folder, engine or FakeEngine(), limits)
        bench.passing = passing
        bench.batches.start(bench.news.append)
        try:
            await work(bench)
        finally:
            await bench.batches.stop()
            bench.database.close()
        return bench

    return asyncio.run(run())
