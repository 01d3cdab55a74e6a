"""Runs a second of batches of 10 s runs, side by side on all cores; beside a plain loop over the compiled single run."""

import gc
import os
import resource
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

from vssea_core.batch.document import Batch, Draw, Sample, Uniform
from vssea_core.batch.engine import run_alone
from vssea_core.batch.part import run_part
from vssea_core.batch.plan import BatchPlan
from vssea_core.scenario import Scenario
from vssea_core.scenarios import NOMINAL, REALISTIC

PART = 1024
SINGLE = 100
CORES = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def plants(scenario: Scenario, count: int) -> Batch:
    """Return a batch of uncertain plants: link inertia, motor damping and friction, spring."""
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


_plan: BatchPlan | None = None


def _begin(document: str) -> None:
    global _plan
    _plan = BatchPlan(Batch.model_validate_json(document))
    run_part(_plan, 0, 16)
    gc.collect()
    gc.freeze()
    gc.disable()


def _part(first: int) -> tuple[int, int]:
    assert _plan is not None  # noqa: S101
    done = run_part(_plan, first, PART)
    gc.collect()
    return len(done.rows["state"]) if done else 0, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def measured(batch: Batch) -> tuple[float, float]:
    """Return runs a second on all cores, and the peak memory [MB] of all its processes together."""
    document = batch.model_dump_json()
    count = BatchPlan(batch).count
    with ProcessPoolExecutor(CORES, get_context("spawn"), _begin, (document,)) as workers:
        list(workers.map(_part, [0] * 2 * CORES))  # every worker has begun
        begun = time.perf_counter()
        parts = list(workers.map(_part, range(0, count, PART)))
        passed = time.perf_counter() - begun
    assert sum(done for done, _ in parts) == count  # noqa: S101
    return count / passed, max(memory for _, memory in parts) * CORES / 1024


def single(scenario: Scenario) -> float:
    """Return runs a second of a plain loop over single runs, on one core."""
    run_alone(scenario)
    begun = time.perf_counter()
    for _ in range(SINGLE):
        run_alone(scenario)
    return SINGLE / (time.perf_counter() - begun)


def main() -> None:
    """Print the table."""
    for scenario in (NOMINAL, REALISTIC):
        alone = single(scenario)
        print(f"{scenario.name}: plain loop {alone:.0f} runs/s on one core", flush=True)
        for name, batch in (("plants", plants(scenario, 10_000)), ("tunings", tunings(scenario, 10_000))):
            rate, memory = measured(batch)
            print(
                f"  10,000 {name}: {rate:.0f} runs/s on {CORES} cores, {rate / alone:.1f} x the loop, {memory:.0f} MB",
                flush=True,
            )
    for count in (1_000, 10_000, 100_000):
        rate, memory = measured(plants(NOMINAL, count))
        print(
            f"{count} nominal plants: {count / rate:.1f} s, {1e3 * CORES / rate:.3f} ms a run and core, {memory:.0f} MB",
            flush=True,
        )
