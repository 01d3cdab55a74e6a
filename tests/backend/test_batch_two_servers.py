"""Two servers on one folder of batches: one runs them, the other one says so, reads, and takes over when it may."""

import asyncio
import os
from collections.abc import Callable, Coroutine
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from backend.batch.catalogue import BatchCatalogue
from backend.batch.limits import Limits
from backend.batch.queue import RETRY_S
from backend.problem import Problem
from tests.backend.batch_bench import Bench, FakeEngine, document, until

LIMITS = Limits(1000, 1e9, 2)
Work = Callable[[Bench, Bench], Coroutine[Any, Any, None]]


def with_two(folder: Path, work: Work) -> tuple[FakeEngine, FakeEngine]:
    """Run `work` with two managers on one folder, the first one started first; the work may stop it."""

    async def run() -> tuple[FakeEngine, FakeEngine]:
        first, second = Bench(folder, FakeEngine(), LIMITS), Bench(folder, FakeEngine(), LIMITS)
        first.engine.held = {2}
        first.batches.start(first.news.append)
        try:
            begun = await first.create()
            await until(lambda: first.engine.asked[-1:] == [2])
            second.batches.start(second.news.append)
            assert await second.state(begun) == "running"
            await work(first, second)
        finally:
            for bench in (second, first):
                await bench.batches.stop()
                bench.database.close()
        return first.engine, second.engine

    return asyncio.run(run())


async def batch_of(bench: Bench) -> str:
    return str((await bench.batches.list(None, 0, 10))["batches"][-1]["id"])


def test_the_second_server_computes_nothing_and_refuses_what_it_cannot_do(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    async def work(first: Bench, second: Bench) -> None:
        batch = await batch_of(second)
        await until(lambda: second.slept)  # it has tried, and waits
        for asked in (
            second.batches.create(document()),
            second.batches.cancel(batch),
            second.batches.resume(batch),
            second.batches.delete(batch),
        ):
            with pytest.raises(Problem, match=rf"run by another server \(process {os.getpid()}\); stop it") as problem:
                await asked
            assert (problem.value.status, "VSSEA_BATCHES_DIR" in problem.value.detail) == (409, True)
        assert (await second.batches.list(None, 0, 10))["total"] == 1
        assert await second.state(batch) == await first.state(batch) == "running"
        assert first.parts(batch) == [0, 1]

    first, second = with_two(tmp_path, work)
    assert (first.asked, second.asked) == ([0, 1, 2, -1], [-1])
    assert caplog.text.count("no batch is computed here") == 1


def test_a_key_that_is_known_is_answered_by_both(tmp_path: Path) -> None:
    async def work(first: Bench, second: Bench) -> None:
        batch = await first.create("a key")
        assert (await second.batches.create(document(), "a key"))[0].id == batch

    with_two(tmp_path, work)


def test_the_second_server_goes_on_soon_after_the_first_one_has_stopped(tmp_path: Path) -> None:
    async def work(first: Bench, second: Bench) -> None:
        batch = await batch_of(second)
        await until(lambda: second.slept)
        await first.batches.stop()
        second.time_s += RETRY_S
        found = await second.ended(batch)
        assert (found["state"], second.parts(batch)) == ("done", list(range(10)))

    assert with_two(tmp_path, work)[1].asked == [*range(2, 10), -1]


def test_what_is_asked_of_the_second_server_makes_it_go_on_at_once(tmp_path: Path) -> None:
    async def work(first: Bench, second: Bench) -> None:
        batch = await batch_of(second)
        second.engine.held = {2}
        await until(lambda: second.slept)
        await first.batches.stop()
        assert (await second.batches.cancel(batch))["state"] == "cancelled"
        second.engine.held.clear()
        assert (await second.ended(await second.create()))["state"] == "done"

    with_two(tmp_path, work)


def test_what_another_server_is_making_is_not_swept_away(tmp_path: Path) -> None:
    half_made = tmp_path / "batches" / "20260101-000000-000-abcdef"

    async def work(first: Bench, second: Bench) -> None:
        half_made.mkdir()
        await until(lambda: second.slept)
        assert half_made.exists()
        await first.batches.stop()
        second.time_s += RETRY_S
        await until(lambda: not half_made.exists())

    with_two(tmp_path, work)


def test_a_batch_that_no_queue_has_is_not_said_to_be_cancelled(tmp_path: Path) -> None:
    async def work(first: Bench, second: Bench) -> None:
        batch = await batch_of(first)
        first.engine.held.clear()
        found = await first.ended(batch)
        row = await first.batches.row(batch)
        BatchCatalogue(first.database).put(replace(row, state="queued"))
        assert found["state"] == "done"
        with pytest.raises(Problem, match="has not taken it up") as problem:
            await first.batches.cancel(batch)
        assert problem.value.status == 409

    with_two(tmp_path, work)
