"""One job's way to a worker and back; a thread waits for the answer."""

import asyncio
import threading
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection
from typing import Any

Hearer = Callable[[float, str], None]


class Exchange:
    """A job, None to wait for the worker's start; `on_progress` hears a share from 0 to 1 and words, in the loop."""

    def __init__(self, job: tuple[str, tuple[Any, ...]] | None = None, on_progress: Hearer | None = None) -> None:
        self._job, self._on_progress, self._loop = job, on_progress, asyncio.get_running_loop()
        self._lock = threading.Lock()
        self._pipe: Connection | None = None
        self._is_unwanted = False

    def __call__(self, pipe: Connection) -> tuple[str, Any]:
        """Return the worker's answer and its kind: "lost" if the worker is gone, "cancelled" if it was ended before."""
        try:
            with self._lock:
                if self._is_unwanted:
                    return "cancelled", None
                if self._job is not None:
                    pipe.send(self._job)
                self._pipe = pipe
            while True:
                kind, content = pipe.recv()
                if kind != "progress":
                    return kind, content
                if self._on_progress is not None:
                    self._loop.call_soon_threadsafe(self._on_progress, *content)
        except (EOFError, OSError) as broken:
            return "lost", broken

    def end(self) -> None:
        """Ask the job to end at its next progress; one that has not been sent never will be."""
        with self._lock:
            self._is_unwanted = True
            if self._pipe is not None:
                with suppress(OSError):
                    self._pipe.send(None)
