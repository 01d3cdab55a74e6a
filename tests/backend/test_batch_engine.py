"""Parts computed by this machine's workers, and what a session knows of these."""

import asyncio
import io
import sys
from collections.abc import Callable, Coroutine
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import pyarrow.parquet as pq
import pytest
from pydantic import ValidationError
from typer.testing import CliRunner

from backend.batch.engine import PartFailed, PartFiles, PartRefused, PartTask
from backend.batch.local_engine import END_LIMIT_S, LocalEngine
from backend.batch.part_files import part_files
from backend.batch.sizes import MOST_RUNS, PART_BYTES, part_size
from backend.batch.start import engine_for
from backend.cli import app
from backend.compute.pool import Pool, Worker
from backend.settings import Settings
from vssea_core.batch.document import Batch, Grid
from vssea_core.batch.part import run_part
from vssea_core.batch.plan import BatchPlan
from vssea_core.scenarios import NOMINAL

RUNS = 4000
GRID = Grid(kind="grid", path="reference.amplitude", low=0.1, high=0.5, count=RUNS)
BATCH = Batch(scenario=NOMINAL.model_copy(update={"duration_s": 1.0}), vary=(GRID,))
DOCUMENT = BATCH.model_dump_json()
FEW = PartTask(DOCUMENT, 0, 40, 20)
MINUTES = BATCH.model_copy(update={"scenario": NOMINAL.model_copy(update={"duration_s": 60.0})})
LONG = PartTask(MINUTES.model_dump_json(), 0, 0, 1000)
PATIENCE_S = 240.0


def with_engine(
    work: Callable[[LocalEngine], Coroutine[Any, Any, Any]],
    workers: int = 1,
    idle_s: float = 60.0,
    end_limit_s: float = END_LIMIT_S,
) -> Any:
    async def run() -> Any:
        engine = LocalEngine(workers, idle_s, end_limit_s)
        try:
            return await asyncio.wait_for(work(engine), PATIENCE_S)
        finally:
            await engine.end()

    return asyncio.run(run())


def same(files: PartFiles) -> bool:
    part = run_part(BatchPlan(BATCH), FEW.first, FEW.count)
    assert part is not None
    return files == part_files(part)


def test_a_part_is_the_same_bits_in_a_worker_as_here() -> None:
    files = with_engine(lambda engine: engine.run(FEW))
    assert same(files)
    assert files.counts == {"done": 20}
    assert pq.read_table(io.BytesIO(files.rows))["run"].to_pylist() == list(range(40, 60))


@pytest.fixture
def shares(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """How far the parts that are computed say they are."""
    heard: list[float] = []
    run = Worker.run

    async def listening(worker: Worker, *job: Any, **more: Any) -> Any:
        return await run(worker, *job, **more, on_progress=lambda share, words: heard.append(share))

    monkeypatch.setattr(Worker, "run", listening)
    return heard


async def cancelled(part: asyncio.Task[PartFiles]) -> None:
    part.cancel()
    with pytest.raises(asyncio.CancelledError):
        await part


def test_a_part_that_is_cancelled_while_it_runs_ends_and_its_worker_serves_the_next_one(shares: list[float]) -> None:
    async def work(engine: LocalEngine) -> PartFiles:
        await engine.run(FEW)
        shares.clear()
        processes = engine.process_ids()
        long = asyncio.create_task(engine.run(LONG))
        while not shares:  # noqa: ASYNC110 - other tests look into the list as well
            await asyncio.sleep(1e-3)
        await cancelled(long)
        assert max(shares) < 1.0
        files = await engine.run(FEW)
        assert engine.process_ids() == processes
        return files

    assert same(with_engine(work, end_limit_s=PATIENCE_S))


@pytest.mark.parametrize("steps", range(6))
def test_a_part_that_is_cancelled_on_its_way_to_a_worker_is_not_computed_and_costs_no_worker(
    shares: list[float], steps: int
) -> None:
    async def work(engine: LocalEngine) -> PartFiles:
        await engine.run(FEW)
        shares.clear()
        processes = engine.process_ids()
        long = asyncio.create_task(engine.run(LONG))
        for _ in range(steps):
            await asyncio.sleep(0)
        await cancelled(long)
        assert max(shares, default=0.0) < 1.0
        files = await engine.run(FEW)
        assert engine.process_ids() == processes
        return files

    assert same(with_engine(work, end_limit_s=PATIENCE_S))


def test_a_part_that_makes_no_sense_fails_with_its_reason() -> None:
    wrong = Batch(vary=(Grid(kind="grid", path="no.field", low=0.0, high=1.0, count=3),)).model_dump_json()
    with pytest.raises(PartFailed, match="no field of the scenario"):
        with_engine(lambda engine: engine.run(PartTask(wrong, 0, 0, 3)))


def test_a_worker_that_was_started_from_other_sources_refuses_its_part() -> None:
    with pytest.raises(PartRefused, match="whoever asks runs another; start the program anew"):
        with_engine(lambda engine: engine.run(replace(FEW, version="another")))


def test_workers_start_when_they_are_needed_and_end_when_they_are_idle() -> None:
    async def work(engine: LocalEngine) -> list[int]:
        pool = Pool()
        pool.also(engine.process_ids)
        assert engine.process_ids() == []
        await engine.run(FEW)
        assert pool.process_ids() == engine.process_ids()  # those that a session keeps off the rig's core
        found = pool.process_ids()
        while True:
            if not engine.process_ids():
                return found
            await asyncio.sleep(0.01)

    assert len(with_engine(work, workers=2, idle_s=0.05)) == 1


@pytest.mark.parametrize(
    ("runs", "seconds", "size", "workers", "expected"),
    [
        (1_000_000, 10_000 / 3e7, 200.0, 2, 4512),  # as long as a part may take
        (1_000_000, 1e-6, 100.0, 2, MOST_RUNS),
        (1_000_000, 1e-6, 1e6, 2, 16),  # large samples
        (1_000_000, 100.0, 200.0, 2, 16),
        (4_000, 1e-4, 200.0, 2, 256),  # few runs are shared by all workers
        (1, 1e-4, 200.0, 2, 16),
    ],
)
def test_a_part_is_as_large_as_its_time_its_bytes_and_its_workers_allow(
    runs: int, seconds: float, size: float, workers: int, expected: int
) -> None:
    assert part_size(runs, seconds, size, workers) == expected
    assert expected == 16 or expected * size <= PART_BYTES


class NoCluster:
    def __init__(self, address: str) -> None:
        raise ValueError("a Dask cluster needs the package distributed")


def test_a_server_without_the_engine_that_its_settings_name_says_so_and_does_not_start(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    module = ModuleType("backend.batch.dask_engine")
    module.DaskEngine = NoCluster  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "backend.batch.dask_engine", module)
    variables = {"VSSEA_DATA_DIR": str(tmp_path), "VSSEA_BATCH_ENGINE": "tcp://127.0.0.1:8786"}
    refused = CliRunner().invoke(app, ["serve"], env=variables)
    assert refused.exit_code != 0
    assert "batches cannot be computed at tcp://127.0.0.1:8786: a Dask cluster needs" in refused.output


def test_the_address_of_a_cluster_is_checked_and_this_machine_is_the_default() -> None:
    with pytest.raises(ValidationError, match="is no address of a Dask scheduler; expected such as tcp://"):
        Settings(batch_engine="localhost")
    engine = engine_for(Settings(batch_workers=3))
    assert (engine.name, engine.threads, engine.at_a_time) == ("this machine, 3 workers", 3, 3)
