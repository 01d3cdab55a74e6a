"""Work that is carried out to its end, even if the page that asked for it has gone meanwhile."""

import asyncio
from collections.abc import Coroutine
from typing import Any, TypeVar

Result = TypeVar("Result")
_RUNNING: "set[asyncio.Task[Any]]" = set()


async def to_the_end(work: Coroutine[Any, Any, Result]) -> Result:
    """Return what the work does; a caller that is cancelled leaves it running."""
    task = asyncio.ensure_future(work)
    _RUNNING.add(task)
    task.add_done_callback(_ended)
    return await asyncio.shield(task)


def _ended(task: "asyncio.Task[Any]") -> None:
    _RUNNING.discard(task)
    if not task.cancelled():
        task.exception()  # has been told to who asked, if they are still there
