"""Batches one after the other: given out, tried again, cancelled, refused, told of."""

import asyncio
from pathlib import Path

import pytest

from backend.batch.engine import OutOfReach, PartFailed, PartRefused, WorkerLost
from backend.batch.limits import Limits
from backend.batch.part_run import pause_s
from backend.batch.progress import RunCounts
from backend.problem import Problem
from tests.backend.batch_bench import RUNS, Bench, FakeEngine, document, until, with_bench


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


def test_a_lost_worker_costs_a_part_and_not_the_batch_and_is_logged(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    engine = FakeEngine()
    engine.goes_wrong = {2: [WorkerLost("killed")] * 5}

    async def work(bench: Bench) -> None:
        assert (await bench.ended(await bench.create()))["state"] == "done"

    with_bench(tmp_path, work, engine)
    assert engine.asked == [0, 1, *[2] * 6, *range(3, 10), -1]
    assert caplog.text.count("part 2 is given out again: killed") == 5


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


def test_the_same_key_is_the_same_batch_and_another_document_is_refused(tmp_path: Path) -> None:
    async def work(bench: Bench) -> None:
        first, second = await asyncio.gather(bench.create("a key"), bench.create("a key"))
        assert first == second
        await bench.ended(first)
        assert await bench.create("a key") == first
        with pytest.raises(Problem, match="expected a new key"):
            await bench.create("a key", seed=1)
        assert [each.name for each in (bench.folder / "batches").glob("20*")] == [first]

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


def test_when_nothing_comes_for_longer_than_all_was_to_take_the_time_left_is_not_known() -> None:
    time_s = 0.0
    progress = RunCounts(RUNS, 10, {}, 0, lambda: time_s)
    for now in (10.0, 11.0):
        time_s = now
        progress.add({"done": 10})
    time_s = 18.9
    assert progress.document()["seconds_left"] == pytest.approx(0.1)
    time_s = 19.0
    assert (progress.document()["seconds_left"], progress.rate) == (None, 10.0)
    for _ in range(8):
        progress.add({"done": 10})
    assert progress.document()["seconds_left"] == 0.0


def test_a_batch_that_runs_says_what_its_engine_waits_for(tmp_path: Path) -> None:
    engine = FakeEngine()
    engine.held = {0}

    async def work(bench: Bench) -> None:
        batch = await bench.create()
        await until(lambda: engine.asked == [0])
        engine.waiting_for = "a worker"
        assert (await bench.batches.document(batch))["waiting_for"] == "a worker"
        engine.held.clear()
        assert (await bench.ended(batch))["waiting_for"] == ""

    with_bench(tmp_path, work, engine)


def test_the_estimate_tells_what_a_start_would_be_refused_with(tmp_path: Path) -> None:
    async def work(bench: Bench) -> None:
        (sentence,) = (await bench.batches.estimate(document()))["limits"]
        with pytest.raises(Problem) as problem:
            await bench.create()
        assert problem.value.detail == sentence
        assert "VSSEA_BATCH_MOST_GB" in sentence

    with_bench(tmp_path, work, limits=Limits(RUNS, 399.0, 2))

    async def within(bench: Bench) -> None:
        assert (await bench.batches.estimate(document()))["limits"] == []

    with_bench(tmp_path, within, limits=Limits(RUNS, 400.0, 2))
