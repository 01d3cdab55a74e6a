"""Signs of life in shared memory: the web process counts, the control process watches whether the counts move."""

from multiprocessing.shared_memory import SharedMemory

import numpy as np

WEB, LEASE = 0, 1
"""The web process itself (every 50 ms), and the operator's page through it (each renewal of the lease)."""
LEASE_S = 0.4
"""So long a page that is silent stays in control; it renews every 100 ms."""


class Beats:
    """Two counters; the owner creates and removes the segment."""

    def __init__(self, name: str | None = None) -> None:
        self._owner = name is None
        self._memory = SharedMemory(name, create=self._owner, size=16)
        self.name = self._memory.name
        self._counts = np.ndarray((2,), np.int64, self._memory.buf)

    def beat(self, which: int) -> None:
        """Count one sign of life."""
        self._counts[which] += 1

    def count(self, which: int) -> int:
        """Return the signs of life since the start."""
        return int(self._counts[which])

    def close(self) -> None:
        """Let go; the owner also removes the segment."""
        del self._counts
        self._memory.close()
        if self._owner:
            self._memory.unlink()
