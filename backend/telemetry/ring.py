"""The telemetry ring in shared memory: the control process writes, everyone else reads.

One writer, no locks. A sample is written before the count that announces it; a reader copies first and then looks whether
the writer has meanwhile come round to what it copied.
"""

from dataclasses import dataclass
from multiprocessing.shared_memory import SharedMemory

import numpy as np
from numpy.typing import NDArray

from vssea_core.channels import CHANNELS

WIDTH = len(CHANNELS)
EPOCH, PERIOD_S, LATENESS_US, EXECUTION_US = WIDTH, WIDTH + 1, WIDTH + 2, WIDTH + 3
"""Columns after the channels: the run a sample belongs to, its sample time, how late its tick started and how long it took."""
COLUMNS = WIDTH + 4
CAPACITY = 65_536
WRITTEN, OVERRUNS, REAL_TIME, RUNS = 0, 1, 2, 3
HEADER = 8
MARGIN = 1024
"""Samples that the writer may be filling at a time; a reader keeps that far away from its end."""

Samples = NDArray[np.float64]


def _arrays(memory: SharedMemory) -> tuple[NDArray[np.int64], Samples]:
    header = np.ndarray((HEADER,), np.int64, memory.buf)
    samples = np.ndarray((CAPACITY, COLUMNS), np.float64, memory.buf, offset=HEADER * 8)
    return header, samples


class Ring:
    """The segment itself; its owner creates it before anyone opens it and removes it at the end."""

    def __init__(self) -> None:
        self._memory = SharedMemory(create=True, size=HEADER * 8 + CAPACITY * COLUMNS * 8)
        self.name = self._memory.name

    def close(self) -> None:
        """Remove the segment; who still has it open keeps it until it lets go."""
        self._memory.close()
        self._memory.unlink()


class RingWriter:
    """The control process's end."""

    def __init__(self, name: str) -> None:
        self._memory = SharedMemory(name)
        self.header, self.samples = _arrays(self._memory)

    @property
    def written(self) -> int:
        """Number of samples written since the start."""
        return int(self.header[WRITTEN])

    def room(self, count: int) -> tuple[int, Samples]:
        """Return the place of the next samples, at most `count` and MARGIN, as a view (n, COLUMNS) to be filled."""
        place = int(self.header[WRITTEN]) % CAPACITY
        return place, self.samples[place : min(place + min(count, MARGIN), CAPACITY)]

    def announce(self, count: int) -> None:
        """Make the next `count` samples visible."""
        self.header[WRITTEN] += count

    def close(self) -> None:
        """Let go of the segment."""
        del self.header, self.samples
        self._memory.close()


@dataclass(frozen=True)
class Piece:
    """Consecutive samples (n, COLUMNS) from sequence number `first`; `lost` were overwritten before they could be read."""

    first: int
    samples: Samples
    lost: int = 0


class RingReader:
    """A reader's end; any number of them."""

    def __init__(self, name: str) -> None:
        self._memory = SharedMemory(name)
        self._header, self._samples = _arrays(self._memory)

    @property
    def written(self) -> int:
        """Number of samples written since the start."""
        return int(self._header[WRITTEN])

    @property
    def overruns(self) -> int:
        """Ticks that started a whole period late or more."""
        return int(self._header[OVERRUNS])

    @property
    def real_time(self) -> bool:
        """Whether the control process got real-time scheduling."""
        return bool(self._header[REAL_TIME])

    def latest(self) -> Samples | None:
        """Return the newest sample (COLUMNS,), or None before the first."""
        written = self.written
        return self._samples[(written - 1) % CAPACITY].copy() if written else None

    def since(self, first: int, most: int = CAPACITY) -> Piece:
        """Return the samples from sequence number `first` on, at most `most`, with what was lost before them."""
        written = self.written
        oldest = max(0, written - CAPACITY + MARGIN)
        start = max(first, oldest)
        stop = min(written, start + most)
        if stop <= start:
            return Piece(start, np.empty((0, COLUMNS)), start - first if start > first else 0)
        places = np.arange(start, stop) % CAPACITY
        copied = self._samples[places]
        overwritten = min(stop - start, max(0, self.written - CAPACITY + MARGIN - start))
        return Piece(start + overwritten, copied[overwritten:], start + overwritten - first)

    def last(self, count: int) -> Piece:
        """Return the newest `count` samples."""
        return self.since(max(0, self.written - count))

    def close(self) -> None:
        """Let go of the segment."""
        del self._header, self._samples
        self._memory.close()
