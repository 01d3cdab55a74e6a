"""Letting the disk have what was written, in a thread: a disk that takes a second for it delays no sample."""

import os
from concurrent.futures import Future, ThreadPoolExecutor

flush = getattr(os, "fdatasync", os.fsync)  # not every system has the first


class Syncing:
    """Flushes files against a power cut, one at a time; asked again meanwhile, it lets that pass unless it must be done."""

    def __init__(self) -> None:
        self._thread = ThreadPoolExecutor(1, "disk")
        self._last: Future[None] | None = None

    def __call__(self, descriptor: int, must: bool) -> None:
        """Flush the file of a descriptor, which may be closed afterwards."""
        if must or self._last is None or self._last.done():
            self._last = self._thread.submit(_flush, os.dup(descriptor))

    def finish(self) -> None:
        """Wait for what was asked."""
        self._thread.shutdown()


def _flush(descriptor: int) -> None:
    try:
        flush(descriptor)
    finally:
        os.close(descriptor)
