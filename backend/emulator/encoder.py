"""A position encoder: counts of an angle, and what can go wrong with it."""

import math

WRAP = 1 << 32


class Encoder:
    """Counts of an angle [rad]; `zero` is the angle at which it counts 0."""

    def __init__(self, counts_per_turn: float, zero: float = 0.0) -> None:
        self.counts_per_rad = counts_per_turn / (2.0 * math.pi)
        self.zero = zero
        self.jump = 0.0
        self._frozen: int | None = None

    def freeze(self, angle: float) -> None:
        """Keep showing what it shows now."""
        self._frozen = self.counts(angle)

    def mend(self) -> None:
        """Take back what went wrong."""
        self.jump, self._frozen = 0.0, None

    def counts(self, angle: float) -> int:
        """Return the counts of an angle, as a signed number of 32 bits."""
        if self._frozen is not None:
            return self._frozen
        count = round((angle - self.zero + self.jump) * self.counts_per_rad)
        return (count + WRAP // 2) % WRAP - WRAP // 2
