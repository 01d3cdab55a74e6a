"""The parts of one batch given out to an engine, each until it is computed and kept."""

import asyncio
import logging
from collections import Counter, deque
from collections.abc import Callable, Coroutine, Iterable
from typing import Any

from backend.batch.engine import Engine, OutOfReach, PartFailed, PartFiles, PartRefused, PartTask, WorkerLost

logger = logging.getLogger(__name__)
TRIES: dict[type[Exception], int] = {WorkerLost: 10, PartRefused: 1, OutOfReach: 20, PartFailed: 3}
"""A part that fails so often in one of these ways fails the batch: a cluster may be away for ten minutes."""
PAUSED = PartFailed, OutOfReach
"""After these there is a pause; the part of a lost worker is tried at once by another one."""
FIRST_PAUSE_S, LONGEST_PAUSE_S = 0.25, 60.0
Keep = Callable[[PartTask, PartFiles], Coroutine[Any, Any, None]]
Sleep = Callable[[float], Coroutine[Any, Any, object]]


def pause_s(failures: int) -> float:
    """Return how long a part that has failed so often waits before it is tried again [s]."""
    return min(LONGEST_PAUSE_S, FIRST_PAUSE_S * 2.0 ** (failures - 1)) if failures else 0.0


async def run_parts(engine: Engine, parts: Iterable[PartTask], keep: Keep, sleep: Sleep = asyncio.sleep) -> None:
    """Give out parts in their order, as many at a time as the engine takes; `keep` is awaited with each, to its end.

    One that fails is tried again, after a pause that grows. Raises PartFailed, and what `keep` raises; then, and when it is
    cancelled, it ends the parts under way first.
    """
    waiting, under_way = deque(parts), dict[asyncio.Task[None], PartTask]()
    failures = Counter[tuple[int, type[Exception]]]()

    async def compute(part: PartTask, after_s: float) -> None:
        if after_s:
            await sleep(after_s)
        files = await engine.run(part)
        keeping = asyncio.create_task(keep(part, files))
        try:
            await asyncio.shield(keeping)
        except asyncio.CancelledError:  # what is computed is not thrown away
            await keeping
            raise

    try:
        while waiting or under_way:
            while waiting and len(under_way) < engine.at_a_time:
                part = waiting.popleft()
                failed = max(failures[part.number, kind] for kind in PAUSED)
                under_way[asyncio.create_task(compute(part, pause_s(failed)))] = part
            ended, _ = await asyncio.wait(under_way, return_when=asyncio.FIRST_COMPLETED)
            for task in ended:
                part = under_way.pop(task)
                try:
                    task.result()
                except (WorkerLost, PartFailed) as failure:
                    kind = next(kind for kind in TRIES if isinstance(failure, kind))
                    failures[part.number, kind] += 1
                    if failures[part.number, kind] >= TRIES[kind]:
                        raise PartFailed(_told(part, kind, failure)) from failure
                    if kind is WorkerLost:
                        logger.warning("part %d is given out again: %s", part.number, failure)
                    waiting.appendleft(part)
    finally:
        for task in under_way:
            task.cancel()
        await asyncio.gather(*under_way, return_exceptions=True)


def _told(part: PartTask, kind: type[Exception], failure: Exception) -> str:
    if kind is WorkerLost:
        return f"part {part.number} has cost {TRIES[kind]} workers; the last one: {failure}"
    return f"part {part.number} failed {TRIES[kind]} times: {failure}" if kind is PartFailed else str(failure)


def parts_of(document: str, runs: int, part_size: int) -> list[PartTask]:
    """Return all parts of a batch, in order."""
    starts = range(0, runs, part_size)
    return [PartTask(document, number, first, min(part_size, runs - first)) for number, first in enumerate(starts)]
