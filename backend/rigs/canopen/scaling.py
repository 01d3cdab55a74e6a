"""Between the model's SI units at the gear side and the drives' own: per thousand of rated torque, and encoder counts."""

import math
from typing import Self

from backend.rigs.rig_file import Drive, LinkEncoder

INT16_MAX = 32767
_WORD = 1 << 32


def wrapped(difference: int, modulus: int) -> int:
    """Return `difference` moved by whole `modulus` into [-modulus/2, modulus/2)."""
    half = modulus // 2
    return (difference + half) % modulus - half


class TorqueScale:
    """Torque [N m, gear side] of one drive in units of a thousandth of its rated torque.

    Gear side = gear ratio x efficiency x sign x motor shaft; `rated` [N m] is at the shaft, `limit` [N m] at the gear side.
    """

    __slots__ = ("_per_unit", "_units_per", "limit")

    def __init__(self, rated: float, gear_ratio: float, efficiency: float, sign: int, limit: float) -> None:
        if not (rated > 0.0 and math.isfinite(rated)):
            raise ValueError(f"a rated torque of {rated:g} N·m says nothing")
        self._per_unit = sign * rated * gear_ratio * efficiency / 1000.0
        self._units_per = 1.0 / self._per_unit
        self.limit = min(INT16_MAX, math.floor(limit * abs(self._units_per) * (1.0 + 1e-12)))

    @classmethod
    def of(cls, drive: Drive, rated_units: int, gear_ratio: float) -> Self:
        """Return the scale of a drive whose object 0x6076 says `rated_units`. Raises ValueError where it says 0."""
        rated = rated_units * drive.rated_torque_unit
        return cls(rated, gear_ratio, drive.efficiency, drive.sign, drive.torque_limit)

    def units(self, torque: float) -> int:
        """Return the torque in the drive's units, rounded, within the limit; 0 for what is no number."""
        value = torque * self._units_per
        if value >= self.limit:
            return self.limit
        if value <= -self.limit:
            return -self.limit
        return round(value) if value == value else 0

    def torque(self, units: int) -> float:
        """Return the torque [N m, gear side] of so many units."""
        return units * self._per_unit


class MotorPosition:
    """Position [rad, gear side] from a drive's 32-bit counter (0x6064), beyond its wrap-around."""

    __slots__ = ("_counts", "_per_count", "_raw")

    def __init__(self, drive: Drive, gear_ratio: float) -> None:
        self._per_count = drive.sign * math.tau / (drive.counts_per_turn * gear_ratio)
        self._raw: int | None = None
        self._counts = 0

    def take(self, raw: int) -> float:
        """Return the position for the counter's next value."""
        self._counts += raw if self._raw is None else wrapped(raw - self._raw, _WORD)
        self._raw = raw
        return self._counts * self._per_count


class LinkPosition:
    """Position [rad] from the link encoder: zero and sign of the rig's file, unrolled beyond its wrap-around.

    A single-turn encoder wraps after a turn, others after their word; the link turns less than half a turn a cycle, so the
    nearest of both is the truth. The first value is taken within half a turn of zero.
    """

    __slots__ = ("_counts", "_per_count", "_raw", "_turn", "_word")

    def __init__(self, link: LinkEncoder) -> None:
        self._per_count = link.sign * math.tau / link.counts_per_turn
        self._turn, self._word = link.counts_per_turn, 1 << link.bits
        self._raw = link.zero
        self._counts = 0

    def take(self, raw: int) -> float:
        """Return the position for the encoder's next value."""
        self._counts += wrapped(wrapped(raw - self._raw, self._word), self._turn)
        self._raw = raw
        return self._counts * self._per_count
