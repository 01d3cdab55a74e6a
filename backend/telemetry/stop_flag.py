"""STOP as one number in shared memory: read by the loop first in every tick, past every queue, lease and await."""

from multiprocessing.shared_memory import SharedMemory

import numpy as np


class StopFlag:
    """Counts the STOPs asked for; the loop obeys whenever the count has moved."""

    def __init__(self, name: str | None = None) -> None:
        self._owner = name is None
        self._memory = SharedMemory(name, create=self._owner, size=8)
        self.name = self._memory.name
        self._count = np.ndarray((1,), np.int64, self._memory.buf)

    @property
    def count(self) -> int:
        """STOPs asked for since the start."""
        return int(self._count[0])

    def raise_(self) -> None:
        """Ask for a STOP."""
        self._count[0] += 1

    def close(self) -> None:
        """Let go; the owner also removes the segment."""
        del self._count
        self._memory.close()
        if self._owner:
            self._memory.unlink()
