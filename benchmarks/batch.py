"""Batches of 10 s runs by this machine's engine: runs a second, memory, growth; and rows against single runs, bit by bit."""

import asyncio
import os
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from backend.batch.engine import PartFiles, PartTask
from backend.batch.local_engine import LocalEngine
from backend.batch.part_run import parts_of, run_parts
from vssea_core.batch.document import Batch, Draw, Sample, Uniform
from vssea_core.batch.engine import run_alone
from vssea_core.batch.part import FIGURES, run_part
from vssea_core.batch.plan import BatchPlan
from vssea_core.scenario import Scenario
from vssea_core.scenarios import NOMINAL, REALISTIC

PART = 1024
SINGLE = 100
ROWS = 1000
CORES = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def plants(scenario: Scenario, count: int) -> Batch:
    """Return a batch of uncertain plants: link inertia, motor damping, spring."""
    draws = tuple(
        Draw(path=path, distribution=Uniform(low=low, high=high), factor=True)
        for path, low, high in (
            ("actuator.link.inertia", 0.7, 1.4),
            ("actuator.motor.damping", 0.5, 2.0),
            ("actuator.stiffness.spring_constant", 0.9, 1.1),
        )
    )
    return Batch(scenario=scenario, vary=(Sample(count=count, draws=draws),))


def tunings(scenario: Scenario, count: int) -> Batch:
    """Return a batch of tunings, each with gains and observer of its own."""
    draws = (
        Draw(path="tuning.controller.natural_frequency", distribution=Uniform(low=6.0, high=14.0)),
        Draw(path="tuning.observer.bandwidth", distribution=Uniform(low=40.0, high=120.0)),
    )
    return Batch(scenario=scenario, vary=(Sample(count=count, draws=draws),))


def references(scenario: Scenario, count: int) -> Batch:
    """Return a batch of references: no two runs share their course."""
    draws = (Draw(path="reference.amplitude", distribution=Uniform(low=0.1, high=0.5)),)
    return Batch(scenario=scenario, vary=(Sample(count=count, draws=draws),))


BATCHES: dict[str, Callable[[Scenario, int], Batch]] = {"plants": plants, "tunings": tunings, "references": references}


def memory_mb(process: int) -> float:
    """Return the most memory a process has held [MB]."""
    status = Path(f"/proc/{process}/status").read_text()
    return float(status.split("VmHWM:")[1].split()[0]) / 1024.0


async def measured(engine: LocalEngine, batch: Batch) -> tuple[float, float]:
    """Return runs a second of an engine that is warm, and the most memory of its processes together [MB]."""
    document, count = batch.model_dump_json(), BatchPlan(batch).count
    runs = 0

    async def keep(_: PartTask, files: PartFiles) -> None:
        nonlocal runs
        runs += sum(files.counts.values())

    await run_parts(engine, parts_of(document, min(count, 32 * CORES), 16), keep)  # kernels are compiled, or loaded
    runs = 0
    begun = time.perf_counter()
    await run_parts(engine, parts_of(document, count, PART), keep)
    passed = time.perf_counter() - begun
    if runs != count:
        raise RuntimeError(f"{runs} runs of {count}")
    return count / passed, sum(map(memory_mb, engine.process_ids()))


def single(scenario: Scenario) -> float:
    """Return runs a second of a plain loop over single runs, on one core."""
    run_alone(scenario)
    begun = time.perf_counter()
    for _ in range(SINGLE):
        run_alone(scenario)
    return SINGLE / (time.perf_counter() - begun)


def equal_rows(scenario: Scenario) -> int:
    """Return how many of ROWS rows of a batch equal the single run of their scenario to the bit."""
    plan = BatchPlan(plants(scenario, ROWS))
    part = run_part(plan, 0, ROWS)
    if part is None:
        return 0
    table = np.column_stack([np.asarray(part.rows[name]) for name in FIGURES])
    return sum(run_alone(plan.scenario(i)).figures.tobytes() == table[i].tobytes() for i in range(ROWS))


async def compare() -> None:
    """Print the table."""
    engine = LocalEngine(CORES)
    try:
        for scenario in (NOMINAL, REALISTIC):
            alone = single(scenario)
            print(f"{scenario.name}: plain loop over single runs {alone:.0f} runs/s on one core", flush=True)
            for name, make in BATCHES.items():
                rate, memory = await measured(engine, make(scenario, 10_000))
                figures = f"{rate:.0f} runs/s on {CORES} cores, {rate / alone:.1f} x the loop, {memory:.0f} MB"
                print(f"  10,000 {name}: {figures}", flush=True)
            print(f"  rows equal to their single runs to the bit: {equal_rows(scenario)} of {ROWS}", flush=True)
    finally:
        await engine.end()
    for count in (1_000, 10_000, 100_000):
        engine = LocalEngine(CORES)
        try:
            rate, memory = await measured(engine, plants(NOMINAL, count))
        finally:
            await engine.end()
        print(f"{count} nominal plants: {count / rate:.1f} s, {rate:.0f} runs/s, {memory:.0f} MB", flush=True)


def main() -> None:
    """Print the table."""
    asyncio.run(compare())
