"""Samples to record: numbers that no two channels share, as a ring holds them."""

import numpy as np

from backend.telemetry.ring import COLUMNS, EPOCH, PERIOD_S, Ring, RingWriter, Samples
from vssea_core.channels import INDEX

PERIOD = 1e-3


def samples(count: int, epoch: int = 1, start: int = 0, seed: int = 0) -> Samples:
    """Return samples (count, COLUMNS) of a run from its `start`-th sample on; the same sample is always the same."""
    rows = np.random.default_rng([seed, epoch]).standard_normal((start + count, COLUMNS))[start:]
    rows[:, INDEX["time"]] = PERIOD * np.arange(start, start + count)
    rows[:, EPOCH], rows[:, PERIOD_S] = epoch, PERIOD
    return rows


class Source:
    """A ring with its writer's end."""

    def __init__(self) -> None:
        self.ring = Ring()
        self._writer = RingWriter(self.ring.name)

    def put(self, rows: Samples) -> None:
        """Write samples as the control process does."""
        left = rows
        while len(left):
            _, room = self._writer.room(len(left))
            room[:] = left[: len(room)]
            self._writer.announce(len(room))
            left = left[len(room) :]

    def close(self) -> None:
        """Remove the ring."""
        del self._writer.samples, self._writer.header
        self.ring.close()
