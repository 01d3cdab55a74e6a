"""Which observer bandwidths a loop stands, at each stiffness: there is no single border in g, but intervals.

Model mismatch gives islands, with a lower border too; chosen minimal margins make them smaller.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vssea_core.analysis.axes import AXES, axis_named, changed
from vssea_core.analysis.batch import Batch, Controllers, Plants, all_pairs
from vssea_core.analysis.loop import STABLE_RADIUS
from vssea_core.analysis.maps import PER_DECADE
from vssea_core.analysis.margin_kernel import DELAY, DISK, GAIN_DOWN, GAIN_UP, PHASE
from vssea_core.analysis.operating_point import OperatingPoint, note_on_linearity
from vssea_core.analysis.progress import Progress, told, unheard
from vssea_core.control.prepared import prepare

Numbers = NDArray[np.float64]
TRIED = 121
"""Bandwidths tried at first, on a logarithmic scale; narrower islands can be missed."""
RESOLUTION = 2e-3
CUTS = 4


@dataclass(frozen=True)
class LeastMargins:
    """Margins asked for, at both breaks: gain factors, phase [rad], delay [s], disk alpha. The defaults ask for stability."""

    gain_up: float = 1.0
    gain_down: float = 1.0
    phase: float = 0.0
    delay_s: float = 0.0
    disk: float = 0.0

    @property
    def asks(self) -> bool:
        """Whether anything beyond stability is asked for."""
        return self != LeastMargins()

    def met(self, margins: Numbers) -> NDArray[np.bool_]:
        """Return which of `margins` (n, 2, fields) meet them; NaN (unstable) does not."""
        least, most = margins.min(axis=1), margins.max(axis=1)
        return np.asarray(
            (least[:, GAIN_UP] >= self.gain_up)
            & (most[:, GAIN_DOWN] <= self.gain_down)
            & (least[:, PHASE] >= self.phase)
            & (least[:, DELAY] >= self.delay_s)
            & (least[:, DISK] >= self.disk)
        )


@dataclass(frozen=True)
class BandwidthSet:
    """At one stiffness [N m/rad]: the intervals of g [rad/s] in which every plant is stable and has the margins."""

    stiffness: float
    intervals: tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class BandwidthSets:
    """One BandwidthSet for each stiffness, within `low` to `high` [rad/s]; an interval that ends there may go on."""

    low: float
    high: float
    sets: tuple[BandwidthSet, ...]
    note: str | None

    def document(self) -> dict[str, Any]:
        """Return plain numbers and lists."""
        return {
            "low": self.low,
            "high": self.high,
            "sets": [
                {"stiffness": each.stiffness, "intervals": [list(interval) for interval in each.intervals]}
                for each in self.sets
            ],
            "note": self.note,
        }


def bandwidth_sets(
    point: OperatingPoint,
    stiffnesses: Sequence[float],
    mismatches: Sequence[Mapping[str, float]] = ({},),
    least: LeastMargins = LeastMargins(),
    low: float = 5.0,
    high: float = 1000.0,
    progress: Progress = unheard,
) -> BandwidthSets:
    """Return the BandwidthSets of `point` at `stiffnesses` [N m/rad], on all plants of `mismatches` at once.

    A mismatch gives values of axes.AXES that change the plant, e.g. {"link_inertia": 2.0}. Borders are known to 0.2 %.
    Raises ValueError for a mismatch that is not one of the plant, an empty range, or a controller without a linear loop.
    """
    if not 0.0 < low < high:
        raise ValueError(f"bandwidths from {low:g} to {high:g} rad/s; expected an ascending range above zero")
    for name in (name for mismatch in mismatches for name in mismatch):
        if axis_named(name).side != "plant":
            plants = ", ".join(axis.name for axis in AXES.values() if axis.side == "plant")
            raise ValueError(f"mismatch {name!r} does not change the plant; expected one of {plants}")
    note = note_on_linearity(point.tuning)
    tried = np.geomspace(low, high, TRIED)
    prepared = {float(g): _prepared(point, float(g)) for g in tried}
    sets = []
    for index, stiffness in enumerate(stiffnesses):
        told(progress, index / len(stiffnesses))
        here = replace(point, stiffness=stiffness)
        judge = _Judge(here, mismatches, least, prepared)
        sets.append(BandwidthSet(stiffness, tuple(judge.intervals(tried))))
    told(progress, 1.0)
    return BandwidthSets(low, high, tuple(sets), note)


def _prepared(point: OperatingPoint, bandwidth: float) -> Numbers:
    return prepare(changed(point, {"bandwidth": bandwidth}).tuning, point.period_s)


class _Judge:
    """Whether bandwidths are good at one stiffness."""

    def __init__(
        self,
        point: OperatingPoint,
        mismatches: Sequence[Mapping[str, float]],
        least: LeastMargins,
        prepared: Mapping[float, Numbers],
    ) -> None:
        self.point, self.least, self.prepared = point, least, prepared
        self.plants = Plants.of([changed(point, dict(mismatch)).plant for mismatch in mismatches], point.period_s)

    def good(self, bandwidths: Numbers) -> NDArray[np.bool_]:
        """Return which of `bandwidths` are stable with the margins asked for, on every plant."""
        rows = [self.prepared[g] if g in self.prepared else _prepared(self.point, g) for g in bandwidths.tolist()]
        delayed = self.point.timing.compute_delay_samples != 0
        controllers = Controllers.probed(rows, [self.point.theta_ms] * len(rows), delayed)
        pairs = all_pairs(len(rows), len(self.plants.rows))
        batch = Batch(controllers, self.plants, pairs, self.point.period_s, delayed)
        good = self.least.met(batch.margins(PER_DECADE)[1]) if self.least.asks else batch.radii() < STABLE_RADIUS
        return np.asarray(good.reshape(len(rows), -1).all(axis=1))

    def intervals(self, tried: Numbers) -> list[tuple[float, float]]:
        """Return the good intervals, their ends narrowed down between two of `tried`, on the good side."""
        good = self.good(tried)
        found: list[tuple[float, float]] = []
        start: float | None = None
        for i, here in enumerate(good):
            if here and start is None:
                start = tried[0] if i == 0 else self._edge(tried[i], tried[i - 1])
            if start is not None and not here:
                found.append((float(start), self._edge(tried[i - 1], tried[i])))
                start = None
        if start is not None:
            found.append((float(start), float(tried[-1])))
        return found

    def _edge(self, good: float, bad: float) -> float:
        while abs(math.log(bad / good)) > RESOLUTION:
            cuts = np.geomspace(good, bad, CUTS + 2)
            wrong = np.append(~self.good(cuts[1:-1]), True)
            first = int(np.argmax(wrong))
            good, bad = cuts[first], cuts[first + 1]
        return float(good)
