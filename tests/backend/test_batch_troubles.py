"""What a full disk, a database that fails and a kill leave: nothing half, and a queue that goes on."""

import asyncio
import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
import sqlalchemy as sa

from backend.batch.catalogue import BatchCatalogue, Row
from backend.batch.engine import PartFiles
from backend.batch.folder import BatchFolder, Division
from backend.batch.queue import CANCEL_LIMIT_S, RETRY_S
from backend.problem import Problem
from backend.store.tables import BATCHES
from backend.store.troubles import LOCKED
from tests.backend.batch_bench import PART_SIZE, Bench, FakeEngine, until, with_bench


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


def test_a_batch_that_cannot_be_kept_leaves_no_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fsync = os.fsync

    def until_full(descriptor: int) -> None:
        if [*(tmp_path / "batches").glob("*/parts.json")]:
            raise OSError(28, "No space left on device")
        fsync(descriptor)

    monkeypatch.setattr(os, "fsync", until_full)

    async def work(bench: Bench) -> None:
        with pytest.raises(Problem, match="cannot be written: No space left on device") as problem:
            await bench.create()
        assert problem.value.status == 507
        assert [*(bench.folder / "batches").glob("20*")] == []

    with_bench(tmp_path, work)


def test_a_batch_that_the_database_cannot_forget_keeps_its_results(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(_: BatchCatalogue, batch: str) -> None:
        raise replace(LOCKED)

    monkeypatch.setattr(BatchCatalogue, "forget", fail)

    async def work(bench: Bench) -> None:
        batch = await bench.create()
        await bench.ended(batch)
        with pytest.raises(Problem, match="locked"):
            await bench.batches.delete(batch)
        assert bench.parts(batch) == list(range(10))
        assert await bench.state(batch) == "done"

    with_bench(tmp_path, work)


@pytest.mark.parametrize("fails", ["renamed", "delete"])
def test_a_batch_whose_files_cannot_be_removed_is_not_said_to_be_deleted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fails: str
) -> None:
    def fail(*_: object) -> None:
        raise OSError(30, "Read-only file system")

    async def work(bench: Bench) -> None:
        batch = await bench.create()
        await bench.ended(batch)
        with monkeypatch.context() as read_only:
            read_only.setattr(BatchFolder, fails, fail)
            with pytest.raises(Problem, match="cannot be removed: Read-only file system") as problem:
                await bench.batches.delete(batch)
        assert problem.value.status == 507
        assert (await bench.state(batch), bench.parts(batch)) == ("done", list(range(10)))
        assert bench.news[-1]["state"] == "done"
        await bench.batches.delete(batch)
        assert not (bench.folder / "batches" / batch).exists()

    with_bench(tmp_path, work)


def test_a_start_finishes_what_a_kill_has_left_half_made_or_half_deleted(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    kept: list[str] = []

    async def work(bench: Bench) -> None:
        kept.extend([await bench.create(), await bench.create()])
        await bench.ended(kept[1])

    with_bench(tmp_path, work)
    folder = tmp_path / "batches"
    division = Division(PART_SIZE, "a version")
    names = [f"20260101-000000-00{number}-abcdef" for number in range(4)]
    for name in (names[0], f"{names[1]}.deleted", names[2], f"{names[3]}.deleted", "mine"):
        BatchFolder(folder / name).create("{}", division)
    for name in (f"{names[1]}.deleted", names[2]):
        BatchFolder(folder / name).keep(0, PartFiles(b"rows", b"", {}))
    (folder / f"{names[3]}.deleted" / "notes.txt").write_text("of somebody")
    (folder / kept[0]).rename(folder / f"{kept[0]}.deleted")

    async def after(bench: Bench) -> None:
        await until(lambda: not (folder / f"{names[1]}.deleted").exists() and (folder / kept[0]).exists())
        assert bench.parts(kept[0]) == list(range(10))

    with_bench(tmp_path, after)
    left = sorted(path.name for path in folder.iterdir() if path.is_dir())
    assert left == sorted([*kept, names[2], f"{names[3]}.deleted", "mine"])
    assert f"{names[2]} holds results that no batch of the database names" in caplog.text


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
