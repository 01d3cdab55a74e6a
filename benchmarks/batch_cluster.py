"""The same batch on this machine's engine and on a local Dask cluster: time, bits, and what a killed worker changes."""

import asyncio
import hashlib
import os
import signal
import statistics
import time
from typing import Any

from backend.batch.dask_engine import DaskEngine
from backend.batch.engine import Engine, PartFiles, PartTask
from backend.batch.local_engine import LocalEngine
from backend.batch.part_run import parts_of, run_parts
from benchmarks.batch import PART, plants
from vssea_core.scenarios import NOMINAL, REALISTIC

RUNS, WARM_UP = 40_000, 2_048
WORKERS = 2
TURNS = 3


async def computed(engine: Engine, document: str, runs: int = RUNS, killed: Any = None) -> tuple[str, float]:
    """Return a digest over all parts in order, and the seconds it took; `killed` is called once a third is done."""
    digests: dict[int, bytes] = {}
    parts = parts_of(document, runs, PART)

    async def keep(part: PartTask, files: PartFiles) -> None:
        digests[part.number] = hashlib.sha256(files.rows + files.trajectories).digest()
        if killed is not None and len(digests) == len(parts) // 3:
            killed()

    begun = time.perf_counter()
    await run_parts(engine, parts, keep)
    passed = time.perf_counter() - begun
    return hashlib.sha256(b"".join(digests[number] for number in sorted(digests))).hexdigest()[:12], passed


async def compare() -> None:
    """Print the table."""
    from distributed import LocalCluster

    for scenario in (NOMINAL, REALISTIC):
        document = plants(scenario, RUNS).model_dump_json()
        local = LocalEngine(WORKERS)
        async with LocalCluster(
            n_workers=WORKERS, threads_per_worker=1, processes=True, host="127.0.0.1", dashboard_address="127.0.0.1:0",
            asynchronous=True, silence_logs=50,
        ) as cluster:  # fmt: skip
            dask = DaskEngine(cluster.scheduler_address)

            def kill(workers: Any = cluster.workers) -> None:
                os.kill(next(iter(workers.values())).pid, signal.SIGKILL)

            try:
                for engine in (local, dask):
                    await computed(engine, document, WARM_UP)  # kernels are compiled, or loaded
                turns = [(await computed(local, document), await computed(dask, document)) for _ in range(TURNS)]
                here, there = turns[0][0][0], turns[0][1][0]
                here_s, there_s = (statistics.median(turn[engine][1] for turn in turns) for engine in (0, 1))
                print(f"{scenario.name}, {RUNS} runs: here {here_s:.2f} s ({here}), Dask {there_s:.2f} s ({there}), "
                      f"ratio {there_s / here_s:.3f}, bits {'equal' if here == there else 'DIFFER'}", flush=True)  # fmt: skip
                broken, broken_s = await computed(dask, document, killed=kill)
                print(f"  one of {WORKERS} workers killed after a third: {broken_s:.2f} s ({broken}), "
                      f"bits {'equal' if broken == here else 'DIFFER'}", flush=True)  # fmt: skip
            finally:
                await dask.end()
                await local.end()


def main() -> None:
    """Print the table."""
    asyncio.run(compare())
