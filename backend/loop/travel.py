"""How encoders may travel: no farther in a cycle than their mechanics can, and not still while the other end moves."""


class Jump:
    """A change of velocity that the mechanics cannot make: `sudden` [rad/s] at once plus `acceleration` [rad/s^2]."""

    def __init__(self, sudden: float, acceleration: float, period_s: float) -> None:
        self._per_cycle = sudden * period_s
        self._per_cycle_squared = acceleration * period_s * period_s
        self._before: float | None = None
        self._step = 0.0  # rad a cycle, of the newest two positions
        self._passed = 0.0
        self.by = self.most = 0.0

    def miss(self, cycles: float = 1.0) -> None:
        """Let a cycle pass without a new position."""
        self._passed += cycles

    def happened(self, position: float, cycles: float = 1.0) -> bool:
        """Take a new position [rad], `cycles` after the last look; return whether the axis cannot have come there."""
        before, n = self._before, self._passed + cycles
        self._before, self._passed = position, 0.0
        if before is None:
            return False
        self.by = position - before - self._step * n
        self._step = (position - before) / n
        self.most = self._per_cycle * n + self._per_cycle_squared * n * n
        return abs(self.by) > self.most


class Speed:
    """Speed of an axis [rad/s] by its encoder alone, averaged over `over_s`."""

    def __init__(self, over_s: float, period_s: float) -> None:
        self._over_s, self._period_s = over_s, period_s
        self._before: float | None = None
        self._cycles = 0.0
        self.value = 0.0

    def take(self, position: float, age: int, cycles: float = 1.0) -> None:
        """Take a position [rad], `cycles` after the last look, or one that is `age` cycles old and changes nothing."""
        self._cycles += cycles
        if age != 0:
            return
        if self._before is not None:
            passed = self._cycles * self._period_s
            share = min(1.0, passed / self._over_s)
            self.value += share * ((position - self._before) / passed - self.value)
        self._before, self._cycles = position, 0.0


class Stillness:
    """How far another axis has moved while this one stood still to the count, for some time at least."""

    def __init__(self, for_s: float, period_s: float) -> None:
        self._needed = max(1, round(for_s / period_s))
        self.restart()

    def restart(self) -> None:
        """Start anew."""
        self._position: float | None = None
        self._cycles = 0
        self._low = self._high = 0.0

    def other_moved(self, position: float, other: float) -> float:
        """Take both positions [rad]; return the other's way since this one last moved, 0 before the time is over."""
        if position != self._position:
            self._position, self._cycles, self._low, self._high = position, 0, other, other
            return 0.0
        self._cycles += 1
        self._low, self._high = min(self._low, other), max(self._high, other)
        return self._high - self._low if self._cycles >= self._needed else 0.0
