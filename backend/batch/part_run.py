"""The parts of one batch given out to an engine, each until it is computed and kept."""

import asyncio
from collections import deque
from collections.abc import Callable, Coroutine, Iterable
from typing import Any

from backend.batch.engine import Engine, PartFailed, PartFiles, PartTask, WorkerLost

TRIES = 3
"""A part that fails so often fails the batch."""
MOST_LOST = 10
"""A part that has cost so many workers fails the batch, too."""
Keep = Callable[[PartTask, PartFiles], Coroutine[Any, Any, None]]


async def run_parts(engine: Engine, parts: Iterable[PartTask], keep: Keep) -> None:
    """Give out parts in their order, as many at a time as the engine has workers; `keep` is awaited with each, to its end.

    Raises PartFailed, and what `keep` raises; then, and when it is cancelled, it ends the parts under way first.
    """
    waiting, under_way = deque(parts), dict[asyncio.Task[None], PartTask]()
    failed, lost = dict[int, int](), dict[int, int]()

    async def compute(part: PartTask) -> None:
        files = await engine.run(part)
        keeping = asyncio.create_task(keep(part, files))
        try:
            await asyncio.shield(keeping)
        except asyncio.CancelledError:  # what is computed is not thrown away
            await keeping
            raise

    try:
        while waiting or under_way:
            while waiting and len(under_way) < max(1, engine.workers):
                part = waiting.popleft()
                under_way[asyncio.create_task(compute(part))] = part
            ended, _ = await asyncio.wait(under_way, return_when=asyncio.FIRST_COMPLETED)
            for task in ended:
                part = under_way.pop(task)
                try:
                    task.result()
                except WorkerLost as loss:
                    lost[part.number] = lost.get(part.number, 0) + 1
                    if lost[part.number] >= MOST_LOST:
                        raise PartFailed(
                            f"part {part.number} has cost {MOST_LOST} workers; the last one: {loss}"
                        ) from loss
                    waiting.appendleft(part)
                except PartFailed as failure:
                    failed[part.number] = failed.get(part.number, 0) + 1
                    if failed[part.number] >= TRIES:
                        raise PartFailed(f"part {part.number} failed {TRIES} times: {failure}") from failure
                    waiting.appendleft(part)
    finally:
        for task in under_way:
            task.cancel()
        await asyncio.gather(*under_way, return_exceptions=True)


def parts_of(document: str, runs: int, part_size: int) -> list[PartTask]:
    """Return all parts of a batch, in order."""
    starts = range(0, runs, part_size)
    return [PartTask(document, number, first, min(part_size, runs - first)) for number, first in enumerate(starts)]
