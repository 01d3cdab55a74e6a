"""The manager of batches with an engine and workers that do what a test says, and with a clock that it moves."""

import asyncio
import json
from collections.abc import Callable, Coroutine
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa

from backend.batch.batches import Batches
from backend.batch.catalogue import BatchCatalogue, Row
from backend.batch.engine import OutOfReach, PartFailed, PartFiles, PartRefused, PartTask, WorkerLost
from backend.batch.folder import BatchFolder
from backend.batch.limits import Limits
from backend.batch.part_run import pause_s
from backend.batch.progress import RunCounts
from backend.batch.queue import CANCEL_LIMIT_S, RETRY_S
from backend.batch.times import Times
from backend.batch.version import model_version
from backend.problem import Problem
from backend.store.database import Database
from backend.store.tables import BATCHES
from backend.store.troubles import LOCKED
from vssea_core.batch.document import Batch, Grid

LIMIT_S = 10.0
RUNS, PART_SIZE = 100, 10


class FakeEngine:
    """Computes a part when the test says so, or at once; remembers which were asked for and which were ended."""

    name = "an engine"

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
        if job == "counts_by_part":
            folder = BatchFolder(Path(arguments[0]))
            return {number: _counts(folder.rows_of(number).read_bytes()) for number in folder.parts()}
        self.planned += 1
        self.threads = arguments[1]
        return {
            "runs": RUNS, "part_size": PART_SIZE, "paths": ["seed"], "columns": ["run"], "bytes": 400, "seconds": 1.0,
            "refused": [], "all_refused": False,
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


def document(seed: int = 0) -> Batch:
    return Batch(vary=(Grid(kind="grid", path="seed", low=0.0, high=99.0, count=RUNS),), seed=seed)


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


def test_parts_are_given_out_in_order_and_one_batch_after_the_other(tmp_path: Path) -> None:
    async def work(bench: Bench) -> None:
        first, second = await bench.create(), await bench.create()
        found = await bench.ended(second)
        assert await bench.state(first) == "done"
        assert found["counts"] == {"done": RUNS, "ended": 0, "refused": 0}
        assert bench.parts(first) == bench.parts(second) == list(range(10))

    assert with_bench(tmp_path, work).engine.asked == [*range(10), *range(10), -1]


def test_as_many_parts_are_under_way_as_there_are_workers_and_they_may_end_in_any_order(tmp_path: Path) -> None:
    engine = FakeEngine(workers=3)
    engine.held = {0, 1, 2}

    async def work(bench: Bench) -> None:
        batch = await bench.create()
        await until(lambda: len(engine.asked) == 3)
        for _ in range(20):
            await asyncio.sleep(0)
        assert engine.asked == [0, 1, 2]
        engine.held.remove(1)
        await until(lambda: bench.parts(batch) == list(range(1, 10)) or 9 in engine.asked)
        assert 0 not in bench.parts(batch)
        engine.held.clear()
        assert (await bench.ended(batch))["state"] == "done"
        assert bench.parts(batch) == list(range(10))

    with_bench(tmp_path, work, engine)


class Cluster(FakeEngine):
    """An engine that knows its four threads once it is connected, and takes eight parts at a time."""

    async def connect(self) -> None:
        await super().connect()
        self.threads, self.at_a_time = 4, 8


def test_a_batch_is_planned_for_the_threads_of_a_cluster_not_for_what_is_given_out_ahead(tmp_path: Path) -> None:
    async def work(bench: Bench) -> None:
        await bench.batches.estimate(document())
        assert (bench.jobs.planned, bench.jobs.threads) == (1, 4)

    with_bench(tmp_path, work, Cluster())


def test_a_batch_for_a_cluster_that_is_away_is_refused_with_what_to_do_and_starts_nothing(tmp_path: Path) -> None:
    engine = Cluster()
    engine.away = [OutOfReach("no Dask scheduler answers at tcp://127.0.0.1:1; start one")]

    async def work(bench: Bench) -> None:
        with pytest.raises(Problem, match=r"no Dask scheduler answers .*; start one") as problem:
            await bench.create()
        assert problem.value.status == 503
        assert (await bench.batches.list(None, 0, 10))["total"] == 0

    with_bench(tmp_path, work, engine)


def test_a_lost_worker_costs_a_part_and_not_the_batch(tmp_path: Path) -> None:
    engine = FakeEngine()
    engine.goes_wrong = {2: [WorkerLost("killed")] * 5}

    async def work(bench: Bench) -> None:
        assert (await bench.ended(await bench.create()))["state"] == "done"

    with_bench(tmp_path, work, engine)
    assert engine.asked == [0, 1, *[2] * 6, *range(3, 10), -1]


def test_a_cluster_that_is_away_for_minutes_is_waited_for_with_pauses_that_grow(tmp_path: Path) -> None:
    engine = FakeEngine()
    engine.goes_wrong = {2: [OutOfReach("nobody answers")] * 15}

    async def work(bench: Bench) -> None:
        assert (await bench.ended(await bench.create()))["state"] == "done"

    slept = with_bench(tmp_path, work, engine, passing=True).slept
    assert slept == [pause_s(failures) for failures in range(1, 16)]
    assert slept == sorted(slept)
    assert sum(slept) > 300.0


@pytest.mark.parametrize(
    ("wrong", "tries", "words"),
    [
        (PartFailed("no memory"), 3, "part 2 failed 3 times: no memory"),
        (PartRefused("another version"), 1, "another version"),
        (OutOfReach("nobody answers"), 20, "nobody answers"),
        (WorkerLost("killed"), 10, "has cost 10 workers"),
    ],
)
def test_a_part_that_fails_again_and_again_fails_the_batch_and_keeps_the_others(
    tmp_path: Path, wrong: Exception, tries: int, words: str
) -> None:
    engine = FakeEngine()
    engine.goes_wrong = {2: [wrong] * tries}

    async def work(bench: Bench) -> None:
        failed, following = await bench.create(), await bench.create()
        found = await bench.ended(failed)
        assert found["state"] == "failed"
        assert words in found["reason"]
        assert bench.parts(failed) == [0, 1]
        assert (await bench.ended(following))["state"] == "done"

    asked = with_bench(tmp_path, work, engine, passing=True).engine.asked
    assert asked.count(2) == tries + 1  # once in the following batch


def test_cancelling_ends_what_is_under_way_and_keeps_what_is_done(tmp_path: Path) -> None:
    engine = FakeEngine(workers=2)
    engine.held = {4, 5}

    async def work(bench: Bench) -> None:
        batch, waiting = await bench.create(), await bench.create()
        await until(lambda: {4, 5} <= set(engine.asked) and bench.parts(batch) == [0, 1, 2, 3])
        cancelled = await bench.batches.cancel(batch)
        assert sorted(engine.ended) == [4, 5]
        assert (cancelled["state"], cancelled["progress"]["done"]) == ("cancelled", 40)
        assert bench.parts(batch) == [0, 1, 2, 3]
        engine.held.clear()
        assert (await bench.ended(waiting))["state"] == "done"
        await bench.batches.delete(batch)
        assert not (bench.folder / "batches" / batch).exists()
        with pytest.raises(Problem, match="There is no batch"):
            await bench.batches.row(batch)

    with_bench(tmp_path, work, engine)


def test_a_cancelled_batch_goes_on_with_the_parts_that_are_missing(tmp_path: Path) -> None:
    engine = FakeEngine()
    engine.held = {4}

    async def work(bench: Bench) -> None:
        batch = await bench.create("a key")
        await until(lambda: engine.asked[-1:] == [4])
        with pytest.raises(Problem, match="is running; there is nothing to resume") as problem:
            await bench.batches.resume(batch)
        assert problem.value.status == 409
        await bench.batches.cancel(batch)
        engine.held.clear()
        resumed = await bench.batches.resume(batch)
        assert (resumed["id"], resumed["state"], resumed["progress"]["done"]) == (batch, "queued", 40)
        assert (bench.news[-1]["state"], bench.news[-1]["share"]) == ("queued", 0.4)
        found = await bench.ended(batch)
        assert (found["state"], found["counts"]["done"]) == ("done", RUNS)
        assert await bench.create("a key") == batch

    assert with_bench(tmp_path, work, engine).engine.asked == [*range(5), *range(4, 10), -1]


def test_a_batch_that_became_too_large_goes_on_when_more_is_allowed(tmp_path: Path) -> None:
    engine = FakeEngine()
    engine.size = 100
    begun: list[str] = []

    async def until_too_large(bench: Bench) -> None:
        begun.append(await bench.create())
        assert (await bench.ended(begun[0]))["state"] == "failed"

    with_bench(tmp_path, until_too_large, engine, Limits(RUNS, 450.0, 2))
    kept = len([*(tmp_path / "batches" / begun[0]).glob("*.parquet")])

    async def go_on(bench: Bench) -> None:
        await bench.batches.resume(begun[0])
        found = await bench.ended(begun[0])
        assert (found["state"], found["reason"], found["counts"]["done"]) == ("done", "", RUNS)

    assert with_bench(tmp_path, go_on).engine.asked == [*range(kept, 10), -1]


def test_a_batch_is_resumed_once_however_many_ask_at_the_same_time(tmp_path: Path) -> None:
    engine = FakeEngine()
    engine.held = {4}

    async def work(bench: Bench) -> None:
        batch = await bench.create()
        await until(lambda: engine.asked[-1:] == [4])
        await bench.batches.cancel(batch)
        answers = await asyncio.gather(*(bench.batches.resume(batch) for _ in range(3)), return_exceptions=True)
        assert [isinstance(answer, Problem) for answer in answers] == [False, True, True]
        engine.held.clear()
        assert (await bench.ended(batch))["state"] == "done"

    assert with_bench(tmp_path, work, engine).engine.asked == [*range(5), *range(4, 10), -1]


def test_a_batch_that_waits_is_cancelled_without_a_part(tmp_path: Path) -> None:
    engine = FakeEngine()
    engine.held = {0}

    async def work(bench: Bench) -> None:
        running, waiting = await bench.create(), await bench.create()
        await until(lambda: engine.asked == [0])
        assert (await bench.batches.cancel(waiting))["state"] == "cancelled"
        engine.held.clear()
        assert (await bench.ended(running))["state"] == "done"
        assert bench.parts(waiting) == []

    with_bench(tmp_path, work, engine)


def test_a_stopped_server_goes_on_with_the_parts_that_are_missing(tmp_path: Path) -> None:
    engine = FakeEngine()
    engine.held = {3}
    begun: list[str] = []

    async def until_stopped(bench: Bench) -> None:
        begun.extend([await bench.create(), await bench.create()])
        await until(lambda: engine.asked[-1:] == [3])

    with_bench(tmp_path, until_stopped, engine)
    assert engine.ended == [3]
    (tmp_path / "batches" / begun[0] / "part-00001.parquet").unlink()
    (tmp_path / "batches" / begun[0] / "part-00004.parquet.new").write_bytes(b"half a p")

    async def go_on(bench: Bench) -> None:
        for batch in begun:
            found = await bench.ended(batch)
            assert (found["state"], found["counts"]["done"]) == ("done", RUNS)

    again = with_bench(tmp_path, go_on)
    assert again.engine.asked == [1, *range(3, 10), *range(10), -1]


@pytest.mark.parametrize("division", [None, {"part_size": PART_SIZE, "version": "another"}, {"part_size": 20}])
def test_parts_of_another_version_or_division_are_computed_anew_from_the_first_on(
    tmp_path: Path, division: dict[str, Any] | None
) -> None:
    engine = FakeEngine()
    engine.held = {3}
    begun: list[str] = []

    async def until_stopped(bench: Bench) -> None:
        begun.append(await bench.create())
        await until(lambda: engine.asked[-1:] == [3])

    with_bench(tmp_path, until_stopped, engine)
    told = tmp_path / "batches" / begun[0] / "parts.json"
    told.unlink() if division is None else told.write_text(json.dumps(json.loads(told.read_text()) | division))

    async def go_on(bench: Bench) -> None:
        found = await bench.ended(begun[0])
        assert (found["state"], found["counts"]["done"]) == ("done", RUNS)
        assert found["reason"].startswith("computed from its start")

    assert with_bench(tmp_path, go_on).engine.asked == [*range(10), -1]
    assert json.loads(told.read_text()) == {"part_size": PART_SIZE, "version": model_version()}


def test_a_damaged_part_is_computed_again_and_a_stray_file_is_left_alone(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    engine = FakeEngine()
    engine.held = {3}
    begun: list[str] = []

    async def until_stopped(bench: Bench) -> None:
        begun.append(await bench.create())
        await until(lambda: engine.asked[-1:] == [3])

    with_bench(tmp_path, until_stopped, engine)
    folder = tmp_path / "batches" / begun[0]
    (folder / "part-00001.parquet").write_bytes(b"")
    for stray in ("part-x.parquet", "part-7.parquet", "part-00002 (copy).parquet"):
        (folder / stray).write_bytes(b"rows")

    async def go_on(bench: Bench) -> None:
        found = await bench.ended(begun[0])
        assert (found["state"], found["counts"]["done"]) == ("done", RUNS)

    assert with_bench(tmp_path, go_on).engine.asked == [1, *range(3, 10), -1]
    assert (folder / "part-00001.parquet.damaged").read_bytes() == b""
    assert (folder / "part-x.parquet").exists()
    assert "part 1 cannot be read and is computed again" in caplog.text


def test_results_that_are_whole_stay_whatever_version_has_computed_them(tmp_path: Path) -> None:
    engine = FakeEngine()
    engine.held = {9}
    begun: list[str] = []

    async def until_stopped(bench: Bench) -> None:
        begun.append(await bench.create())
        await until(lambda: engine.asked[-1:] == [9])

    with_bench(tmp_path, until_stopped, engine)
    folder = tmp_path / "batches" / begun[0]
    (folder / "part-00009.parquet").write_bytes(b"rows")
    (folder / "parts.json").write_text(json.dumps({"part_size": PART_SIZE, "version": "another"}))

    async def go_on(bench: Bench) -> None:
        found = await bench.ended(begun[0])
        assert (found["state"], found["reason"]) == ("done", "")

    assert with_bench(tmp_path, go_on).engine.asked == [-1]


def test_without_its_document_a_batch_fails_with_a_reason(tmp_path: Path) -> None:
    engine = FakeEngine()
    engine.held = {0}
    begun: list[str] = []

    async def until_stopped(bench: Bench) -> None:
        begun.append(await bench.create())
        await until(lambda: engine.asked == [0])

    with_bench(tmp_path, until_stopped, engine)
    (tmp_path / "batches" / begun[0] / "batch.json").unlink()

    async def go_on(bench: Bench) -> None:
        found = await bench.ended(begun[0])
        assert (found["state"], "cannot be read" in found["reason"]) == ("failed", True)

    with_bench(tmp_path, go_on)


def test_the_same_key_is_the_same_batch_and_another_document_is_refused(tmp_path: Path) -> None:
    async def work(bench: Bench) -> None:
        first, second = await asyncio.gather(bench.create("a key"), bench.create("a key"))
        assert first == second
        await bench.ended(first)
        assert await bench.create("a key") == first
        with pytest.raises(Problem, match="expected a new key"):
            await bench.create("a key", seed=1)
        assert [each.name for each in (bench.folder / "batches").iterdir()] == [first]

    with_bench(tmp_path, work)


def test_more_than_may_wait_or_may_be_kept_is_refused(tmp_path: Path) -> None:
    engine = FakeEngine()
    engine.held = {0}

    async def work(bench: Bench) -> None:
        await bench.create()
        await until(lambda: engine.asked == [0])
        await bench.create()
        await bench.create()
        with pytest.raises(Problem, match="VSSEA_BATCH_WAITING") as problem:
            await bench.create()
        assert problem.value.status == 429

    with_bench(tmp_path, work, engine)

    async def too_many_runs(bench: Bench) -> None:
        with pytest.raises(Problem, match="VSSEA_BATCH_MOST_RUNS"):
            await bench.create()
        assert bench.jobs.planned == 0

    with_bench(tmp_path, too_many_runs, limits=Limits(RUNS - 1, 1e9, 2))


def test_results_that_grow_beyond_what_they_may_take_fail_the_batch(tmp_path: Path) -> None:
    engine = FakeEngine()
    engine.size = 100

    async def work(bench: Bench) -> None:
        found = await bench.ended(await bench.create())
        assert (found["state"], "VSSEA_BATCH_MOST_GB" in found["reason"]) == ("failed", True)

    with_bench(tmp_path, work, engine, Limits(RUNS, 450.0, 2))


def test_a_full_disk_fails_the_batch_with_the_reason_and_keeps_what_is_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept = BatchFolder.keep

    def until_full(folder: BatchFolder, number: int, files: PartFiles) -> int:
        if number == 3:
            raise OSError(28, "No space left on device")
        return kept(folder, number, files)

    monkeypatch.setattr(BatchFolder, "keep", until_full)

    async def work(bench: Bench) -> None:
        batch = await bench.create()
        found = await bench.ended(batch)
        assert (found["state"], found["progress"]["done"]) == ("failed", 30)
        assert "cannot be read or written: No space left on device" in found["reason"]
        assert bench.parts(batch) == [0, 1, 2]

    with_bench(tmp_path, work)


def puts(monkeypatch: pytest.MonkeyPatch, refuse: Callable[[Row], Exception | None]) -> None:
    """Let the database raise what `refuse` returns for a batch's new state."""
    put = BatchCatalogue.put

    def or_refused(catalogue: BatchCatalogue, row: Row) -> None:
        if error := refuse(row):
            raise error
        put(catalogue, row)

    monkeypatch.setattr(BatchCatalogue, "put", or_refused)


@pytest.mark.parametrize("state", ["running", "done"])
def test_an_unexpected_error_of_the_database_fails_one_batch_and_the_next_one_is_computed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, state: str
) -> None:
    left = [RuntimeError("a statement that makes no sense")]
    puts(monkeypatch, lambda row: left.pop() if left and row.state == state else None)

    async def work(bench: Bench) -> None:
        first, second = await bench.create(), await bench.create()
        assert (await bench.ended(second))["state"] == "done"
        found = await bench.ended(first)
        assert (found["state"], "the server's log" in found["reason"]) == ("failed", True)

    with_bench(tmp_path, work)


def test_a_batch_whose_new_state_can_never_be_kept_does_not_hold_up_the_next_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first: list[str] = []
    puts(monkeypatch, lambda row: RuntimeError("never") if row.id in first else None)

    async def work(bench: Bench) -> None:
        bench.engine.held = {0}
        first.append(await bench.create())
        bench.engine.held.clear()
        assert (await bench.ended(await bench.create()))["state"] == "done"

    with_bench(tmp_path, work)


def test_a_damaged_record_is_one_failed_batch_and_the_others_go_on(tmp_path: Path) -> None:
    engine = FakeEngine()
    engine.held = {0}
    begun: list[str] = []

    async def until_stopped(bench: Bench) -> None:
        begun.extend([await bench.create(), await bench.create()])
        await until(lambda: engine.asked == [0])

    bench = with_bench(tmp_path, until_stopped, engine)
    with bench.database.begin() as connection:
        connection.execute(sa.update(BATCHES).where(BATCHES.c.id == begun[0]).values(summary='{"paths": ['))
    bench.database.close()

    async def go_on(bench: Bench) -> None:
        assert (await bench.ended(begun[1]))["state"] == "done"
        found = (await bench.batches.list(None, 0, 10))["batches"]
        assert {each["id"]: each["state"] for each in found} == {begun[0]: "failed", begun[1]: "done"}
        assert "is damaged; delete the batch" in found[1]["reason"]
        await bench.batches.delete(begun[0])
        assert [each["id"] for each in (await bench.batches.list(None, 0, 10))["batches"]] == [begun[1]]

    with_bench(tmp_path, go_on)


def test_left_batches_that_cannot_be_asked_for_are_logged_and_new_ones_are_computed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def fail(_: BatchCatalogue) -> None:
        raise RuntimeError("a statement that makes no sense")

    monkeypatch.setattr(BatchCatalogue, "active", fail)

    async def work(bench: Bench) -> None:
        assert (await bench.ended(await bench.create()))["state"] == "done"

    with_bench(tmp_path, work)
    assert "wait for the next start" in caplog.text


def test_cancelling_waits_for_the_database_no_longer_than_its_limit_and_is_kept_later(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    engine = FakeEngine()
    engine.held = {1}
    locked: list[Problem] = []
    puts(monkeypatch, lambda row: replace(locked[0]) if locked else None)

    async def work(bench: Bench) -> None:
        batch = await bench.create()
        await until(lambda: engine.asked[-1:] == [1])
        locked.append(LOCKED)
        cancelling = asyncio.create_task(bench.batches.cancel(batch))
        await until(lambda: engine.ended == [1])
        begun_s = bench.time_s
        bench.time_s = begun_s + CANCEL_LIMIT_S - 0.1
        for _ in range(100):
            await asyncio.sleep(0)
        assert not cancelling.done()
        bench.time_s = begun_s + CANCEL_LIMIT_S
        with pytest.raises(Problem, match="as soon as the database can be used") as problem:
            await cancelling
        assert problem.value.status == 503
        locked.clear()
        bench.time_s += RETRY_S
        assert (await bench.ended(batch))["state"] == "cancelled"

    with_bench(tmp_path, work, engine)


def test_pages_are_told_each_state_and_progress_twice_a_second_at_most(tmp_path: Path) -> None:
    engine = FakeEngine()
    engine.held = set(range(10))

    async def work(bench: Bench) -> None:
        await bench.create()
        for part, time_s in enumerate([0.1, 0.2, 0.6, 0.9, 1.0, 1.1, 1.2, 1.3, 1.4, 1.5]):
            await until(lambda part=part: engine.asked[-1:] == [part])
            bench.time_s = 1.0 + time_s
            engine.held.remove(part)
        await until(lambda: bench.news[-1]["state"] == "done")

    heard = with_bench(tmp_path, work, engine).news
    assert [(news["state"], news["share"]) for news in heard] == [
        ("queued", 0.0), ("running", 0.0), ("running", 0.3), ("running", 0.6), ("done", 1.0),
    ]  # fmt: skip


def test_the_rate_leaves_out_the_start_of_the_workers_and_tells_the_time_left() -> None:
    time_s = 0.0
    progress = RunCounts(RUNS, 10, {"done": 20}, 2, lambda: time_s, threads=2)
    assert (progress.rate, progress.document()["seconds_left"]) == (None, None)
    for now in (30.0, 31.0):
        time_s = now
        progress.add({"done": 9, "ended": 1})
    assert progress.rate == pytest.approx(20 / 31.0)
    for now in (32.0, 33.0):
        time_s = now
        progress.add({"done": 10})
    time_s = 34.0
    told = progress.document()
    assert (told["rate"], told["seconds_left"]) == (10.0, 3.0)
    assert told["counts"] == {"done": 58, "ended": 2, "refused": 0}
    assert told["progress"] == {"done": 60, "runs": 100, "parts_done": 6, "parts": 10, "share": 0.6}
