"""The Dask engine on a real cluster of two worker processes: the bits of this process, whatever happens to a worker."""

import asyncio
import io
import os
import signal
from collections.abc import AsyncIterator
from dataclasses import replace
from typing import Any

import pyarrow.parquet as pq
import pytest
from distributed import LocalCluster

from backend.batch.dask_engine import DaskEngine
from backend.batch.engine import PartFailed, PartFiles, PartRefused, PartTask
from backend.batch.version import model_version
from tests.backend.server import free_port
from vssea_core.actuator.parameters import Sensors
from vssea_core.batch.document import Batch, Draw, Keep, Sample, Uniform
from vssea_core.batch.part import run_part
from vssea_core.batch.plan import BatchPlan
from vssea_core.scenarios import NOMINAL

LIMIT_S = 300.0  # the kernels may have to be compiled first
BATCH = Batch(
    scenario=NOMINAL.model_copy(update={"duration_s": 0.2, "sensors": Sensors(velocity_noise=0.1)}),
    vary=(
        Sample(
            count=96,
            draws=(Draw(path="actuator.link.inertia", distribution=Uniform(low=0.5, high=2.0), factor=True),),
        ),
    ),
    noise="own",
    keep=Keep(trajectories="all", every=50),
)
DOCUMENT = BATCH.model_dump_json()
PARTS = [PartTask(DOCUMENT, number, 8 * number, 8) for number in range(12)]


@pytest.fixture
async def cluster() -> AsyncIterator[LocalCluster]:
    async with LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, host="127.0.0.1", dashboard_address="127.0.0.1:0",
        asynchronous=True, silence_logs=50,
    ) as started:  # fmt: skip
        yield started


def tables(files: PartFiles) -> list[dict[str, list[Any]]]:
    return [pq.read_table(io.BytesIO(content)).to_pydict() for content in (files.rows, files.trajectories)]


def computed_here(part: PartTask) -> list[dict[str, list[Any]]]:
    computed = run_part(BatchPlan(BATCH), part.first, part.count)
    assert computed is not None
    return [{name: [*column] for name, column in table.items()} for table in (computed.rows, computed.trajectories)]


async def test_parts_have_the_same_bits_as_here(cluster: LocalCluster) -> None:
    engine = DaskEngine(cluster.scheduler_address)
    try:
        async with asyncio.timeout(LIMIT_S):
            parts = await asyncio.gather(*map(engine.run, PARTS))
        assert [tables(files) for files in parts] == [computed_here(part) for part in PARTS]
        assert [files.counts for files in parts] == [{"done": 8}] * 12
        assert (engine.threads, engine.at_a_time) == (2, 4)
        assert engine.name == f"Dask at {cluster.scheduler_address}, 2 threads"
    finally:
        await engine.end()


async def test_a_worker_of_another_version_refuses_its_part(cluster: LocalCluster) -> None:
    engine = DaskEngine(cluster.scheduler_address)
    words = rf"the worker tcp://\S+ runs version {model_version()} of the model, whoever asks runs another; install the same"
    try:
        async with asyncio.timeout(LIMIT_S):
            with pytest.raises(PartRefused, match=words):
                await engine.run(replace(PARTS[0], version="another"))
    finally:
        await engine.end()


async def test_a_worker_that_is_killed_midway_changes_no_bit(cluster: LocalCluster) -> None:
    engine = DaskEngine(cluster.scheduler_address)
    try:
        async with asyncio.timeout(LIMIT_S):
            under_way = [asyncio.create_task(engine.run(part)) for part in PARTS]
            await asyncio.wait(under_way, return_when=asyncio.FIRST_COMPLETED)
            busy = {state.name for state in cluster.scheduler.workers.values() if state.processing}
            os.kill(next(worker.pid for name, worker in cluster.workers.items() if name in busy), signal.SIGKILL)
            parts = await asyncio.gather(*under_way)
        assert [tables(files) for files in parts] == [computed_here(part) for part in PARTS]
    finally:
        await engine.end()


async def test_once_connected_it_knows_its_threads_before_the_first_part(cluster: LocalCluster) -> None:
    engine = DaskEngine(cluster.scheduler_address)
    try:
        assert (engine.threads, engine.at_a_time) == (1, 1)
        assert engine.waiting_for == f"an answer of the scheduler at {cluster.scheduler_address}"
        async with asyncio.timeout(LIMIT_S):
            await engine.connect()
        assert (engine.threads, engine.at_a_time, engine.waiting_for) == (2, 4, "")
    finally:
        await engine.end()


async def test_a_scheduler_out_of_reach_is_told() -> None:
    address = f"tcp://127.0.0.1:{free_port()}"
    engine = DaskEngine(address, connect_limit_s=0.2)
    with pytest.raises(PartFailed, match=f"^no Dask scheduler answers at {address}; start one with `dask scheduler`"):
        await engine.run(PARTS[0])
    await engine.end()


@pytest.mark.parametrize("address", ["127.0.0.1:8786", "http://127.0.0.1:8786", "tcp://127.0.0.1", ""])
async def test_what_is_no_address_of_a_scheduler_is_told(address: str) -> None:
    with pytest.raises(ValueError, match="is no address of a Dask scheduler; expected such as"):
        DaskEngine(address)


async def test_the_extra_that_is_missing_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(ValueError, match=r"install it with pip install 'vssea\[dask\]'$"):
        DaskEngine("tcp://127.0.0.1:8786")
