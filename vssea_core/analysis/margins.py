"""Margins of the sampled loop: gain to both sides, phase, delay and disk, at the plant's input and at the limiter.

The first break tells what unmodelled dynamics of drive and plant may do: the observer keeps its own command. The second
tells what saturation does: observer and plant both get the limited torque.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vssea_core.analysis.loop import BREAKS, LoopModel, Pieces, System
from vssea_core.analysis.margin_kernel import (
    DELAY,
    DELAY_AT,
    DISK,
    DISK_AT,
    GAIN_DOWN,
    GAIN_DOWN_AT,
    GAIN_UP,
    GAIN_UP_AT,
    PEAK,
    PEAK_AT,
    PHASE,
    PHASE_AT,
    margins_of,
)
from vssea_core.analysis.operating_point import OperatingPoint

PER_DECADE = 60.0
"""Grid points a decade of frequency; every result is refined between them."""
MOST_CROSSOVERS = 16


@dataclass(frozen=True)
class BreakMargins:
    """Margins of one break; a frequency [rad/s] is NaN where there is no such crossing."""

    gain_up: float  # factor > 1 at which the loop is on its border; inf = none
    gain_up_frequency: float
    gain_down: float  # factor < 1 at which the loop is on its border (conditionally stable); 0 = none
    gain_down_frequency: float
    phase: float  # [rad], the smaller of lag and lead; inf = |L| never crosses 1
    phase_frequency: float
    delay_s: float  # [s] of transport delay; inf = none
    delay_frequency: float
    disk: float  # alpha = 1 / max |S - 1/2|, balanced (sigma = 0)
    disk_frequency: float
    sensitivity_peak: float  # M_s = max |S|
    sensitivity_peak_frequency: float
    crossovers: tuple[float, ...]  # [rad/s], where |L| = 1

    @property
    def disk_gain(self) -> tuple[float, float]:
        """Range of gain factors that the disk margin guarantees, by itself."""
        half = min(0.5 * self.disk, 1.0)
        return (1.0 - half) / (1.0 + half), (1.0 + half) / (1.0 - half) if half < 1.0 else math.inf

    @property
    def disk_phase(self) -> float:
        """Phase [rad] that the disk margin guarantees, by itself."""
        return 2.0 * math.atan(0.5 * self.disk)

    def document(self) -> dict[str, Any]:
        """Return plain numbers; None for what does not exist."""
        low, high = self.disk_gain
        return {
            "gain_up": finite(self.gain_up),
            "gain_up_frequency": finite(self.gain_up_frequency),
            "gain_down": self.gain_down or None,
            "gain_down_frequency": finite(self.gain_down_frequency),
            "phase": finite(self.phase),
            "phase_frequency": finite(self.phase_frequency),
            "delay_s": finite(self.delay_s),
            "delay_frequency": finite(self.delay_frequency),
            "disk": self.disk,
            "disk_frequency": self.disk_frequency,
            "disk_gain": [low, finite(high)],
            "disk_phase": self.disk_phase,
            "sensitivity_peak": self.sensitivity_peak,
            "sensitivity_peak_frequency": self.sensitivity_peak_frequency,
            "crossovers": list(self.crossovers),
        }


@dataclass(frozen=True)
class Margins:
    """Margins at both breaks, or None for both with the closed loop unstable; `note` says what a reader has to know."""

    stable: bool
    plant: BreakMargins | None
    limiter: BreakMargins | None
    note: str | None = None

    def document(self) -> dict[str, Any]:
        """Return plain numbers and lists."""
        return {
            "stable": self.stable,
            "plant": self.plant.document() if self.plant else None,
            "limiter": self.limiter.document() if self.limiter else None,
            "note": self.note,
        }


def margins(loop: LoopModel) -> Margins:
    """Return the Margins of `loop`. Frequencies are told between 0.01 rad/s and Nyquist.

    The delay margin takes a delay for a pure phase, as is exact for whole samples; a fraction of a sample also changes the
    hold, which robustness.robustness takes into account.
    """
    if not loop.stable:
        return unstable_margins(loop.radius, loop.note)
    return _margins((loop.A, loop.B, loop.C, loop.D), loop.multipliers, loop.period_s, loop.compute_delay, loop.note)


def margins_at(pieces: Pieces, point: OperatingPoint) -> Margins:
    """Return the Margins of `pieces` with the plant of `point`, as margins does, without the other inputs of the loop."""
    system = pieces.system(point.plant, BREAKS)
    multipliers = np.linalg.eigvals(system[0]).astype(np.complex128)
    radius = float(np.abs(multipliers).max())
    if not radius < 1.0 - 1e-9:
        return unstable_margins(radius, pieces.note)
    return _margins(system, multipliers, pieces.period_s, pieces.compute_delay, pieces.note)


def unstable_margins(radius: float, note: str | None) -> Margins:
    """Return Margins without numbers for a closed loop that grows by `radius` a sample."""
    sentence = f"the closed loop is unstable (it grows {radius:.4g}-fold a sample), so it has no margins"
    return Margins(False, None, None, f"{sentence}; {note}" if note else sentence)


def _margins(
    system: System, multipliers: NDArray[np.complex128], period_s: float, delayed: bool, note: str | None
) -> Margins:
    crossovers = np.empty((2, MOST_CROSSOVERS))
    numbers = margins_of(*system, multipliers, period_s, delayed, PER_DECADE, crossovers)
    plant, limiter = (_of_break(row, places) for row, places in zip(numbers, crossovers, strict=True))
    return Margins(True, plant, limiter, note)


def _of_break(row: NDArray[np.float64], crossovers: NDArray[np.float64]) -> BreakMargins:
    of: list[float] = row.tolist()
    return BreakMargins(
        of[GAIN_UP], of[GAIN_UP_AT], of[GAIN_DOWN], of[GAIN_DOWN_AT], of[PHASE], of[PHASE_AT], of[DELAY], of[DELAY_AT],
        of[DISK], of[DISK_AT], of[PEAK], of[PEAK_AT], tuple(crossovers[np.isfinite(crossovers)].tolist()),
    )  # fmt: skip


def finite(number: float) -> float | None:
    """Return `number`, or None if it is infinite or not a number: JSON has neither."""
    return number if math.isfinite(number) else None
