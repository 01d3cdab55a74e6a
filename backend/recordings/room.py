"""Whether a disk has room to record on: some is kept free, and one that refused is left in peace for a while."""

import math
import shutil
from collections.abc import Callable
from pathlib import Path

RETRY_S = 10.0
LEAST = 20_000_000
"""A recording that a disk has stopped is begun again after so long at the earliest, and with so many bytes to begin in."""
Free = Callable[[Path], int]


def free_bytes(folder: Path) -> int:
    """Return the bytes that the disk of a folder has left."""
    return shutil.disk_usage(folder).free


class Room:
    """The disk of one folder; `keep_free` bytes of it are not for recordings."""

    def __init__(self, folder: Path, keep_free: int, free: Free = free_bytes) -> None:
        self._folder, self._keep_free, self._free = folder, keep_free, free
        self._refusal = ""
        self._retry_at = -math.inf

    def lacking(self, now_s: float, is_stopped: bool) -> str | None:
        """Return why nothing can be recorded now, None if it can; to begin again takes more room than to go on.

        Raises OSError if the disk cannot be asked.
        """
        if now_s < self._retry_at:
            return self._refusal
        free = self._free(self._folder)
        if free >= (max(1.1 * self._keep_free, LEAST) if is_stopped else self._keep_free):
            return None
        return (
            f"{self._folder} has {free / 1e9:.2f} GB left and {self._keep_free / 1e9:.2f} GB are kept free; "
            "delete recordings, or lower VSSEA_RECORDINGS_KEEP_FREE_GB"
        )

    def refused(self, error: OSError, now_s: float) -> str:
        """Return a refusal of the disk in words, and remember it."""
        self._refusal = f"{self._folder} cannot be written: {error.strerror or error}"
        self._retry_at = now_s + RETRY_S
        return self._refusal
