"""What batches know of time, as one thing that tests replace."""

import asyncio
import time
from collections.abc import Callable, Coroutine
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any


def utc_now() -> datetime:
    """Return the time of day."""
    return datetime.now(UTC)


def text_of(moment: datetime) -> str:
    """Return a time of day as the API writes it."""
    return moment.isoformat(timespec="milliseconds").replace("+00:00", "Z")


@dataclass(frozen=True)
class Times:
    """A clock that only goes on [s], the time of day, and waiting [s]."""

    clock: Callable[[], float] = time.monotonic
    now: Callable[[], datetime] = utc_now
    sleep: Callable[[float], Coroutine[Any, Any, object]] = asyncio.sleep

    def text(self) -> str:
        """Return the time of day as the API writes it."""
        return text_of(self.now())
