"""A batch that a stop, a cancel or a failure has left: what is there stays, what is missing is computed."""

import asyncio
import json
from pathlib import Path
from typing import Any

import pytest

from backend.batch.limits import Limits
from backend.batch.running import NOTED_EVERY_S
from backend.batch.version import model_version
from backend.problem import Problem
from tests.backend.batch_bench import PART_SIZE, RUNS, Bench, FakeEngine, until, with_bench


def stopped_before(tmp_path: Path, part: int) -> str:
    """The name of a batch whose server was stopped when all parts before `part` were kept."""
    engine, begun = FakeEngine(), list[str]()
    engine.held = {part}

    async def until_stopped(bench: Bench) -> None:
        begun.append(await bench.create())
        await until(lambda: engine.asked[-1:] == [part])

    with_bench(tmp_path, until_stopped, engine)
    return begun[0]


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
    begun = [stopped_before(tmp_path, 3)]
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
    begun = [stopped_before(tmp_path, 3)]
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
    begun = [stopped_before(tmp_path, 9)]
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


def test_seconds_of_a_batch_outlast_a_kill_but_for_the_last_few(tmp_path: Path) -> None:
    engine = FakeEngine()
    engine.held = {0, 1, 2}

    async def work(bench: Bench) -> None:
        batch = await bench.create()
        for part in range(2):
            await until(lambda part=part: engine.asked[-1:] == [part])
            bench.time_s += NOTED_EVERY_S - 1.0
            engine.held.remove(part)
        await until(lambda: engine.asked[-1:] == [2])
        kept = await bench.batches.row(batch)  # what a kill leaves
        assert (kept.state, kept.seconds, kept.summary["parts_done"]) == ("running", 2 * (NOTED_EVERY_S - 1.0), 2)

    with_bench(tmp_path, work, engine)
