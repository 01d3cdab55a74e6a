"""The worst plant within a box of uncertainties, by search rather than on a grid."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import Bounds, differential_evolution, minimize

from vssea_core.analysis.axes import axis_named, changed
from vssea_core.analysis.batch import Batch, Controllers, Plants, all_pairs
from vssea_core.analysis.loop import STABLE_RADIUS
from vssea_core.analysis.margin_kernel import DISK
from vssea_core.analysis.margins import finite
from vssea_core.analysis.operating_point import OperatingPoint, note_on_linearity
from vssea_core.analysis.progress import Progress, told, unheard
from vssea_core.control.prepared import prepare

Numbers = NDArray[np.float64]
Criterion = Literal["growth", "disk"]
GENERATIONS, POPULATION_A_DIMENSION, RESTARTS = 40, 12, 2
MOST_CORNERS = 256
POLISH_EVALUATIONS = 200
PER_DECADE = 16.0


@dataclass(frozen=True)
class WorstCase:
    """The worst point found: values by axis, growth [1/s] of its dominant mode, disk margin (None if unstable)."""

    values: dict[str, float]
    stable: bool
    growth: float
    disk: float | None
    evaluations: int
    note: str | None

    def document(self) -> dict[str, Any]:
        """Return plain numbers."""
        return {
            "values": self.values,
            "stable": self.stable,
            "growth": finite(self.growth),
            "disk": self.disk,
            "evaluations": self.evaluations,
            "note": self.note,
        }


def worst_case(
    point: OperatingPoint,
    box: Mapping[str, tuple[float, float]],
    criterion: Criterion = "growth",
    seed: int = 1,
    progress: Progress = unheard,
) -> WorstCase:
    """Return the WorstCase of `point` over `box`: ranges (low, high) of axes.AXES by name.

    `growth` looks for the largest growth rate, `disk` for the smallest disk margin of both breaks (an unstable plant is worse
    than any). Corners first, then differential evolution, started anew, then a local search from the best. Not a proof:
    a narrower valley may be missed. Raises ValueError for unknown axes, an empty box or range, or a controller without a
    linear loop; Cancelled if `progress` says so.
    """
    note = note_on_linearity(point.tuning)
    if not box:
        raise ValueError("the box is empty; expected a range for at least one axis")
    for name, (low, high) in box.items():
        if not low <= high or (axis_named(name).scale == "log" and low <= 0.0):
            raise ValueError(f"{name} ranges from {low:g} to {high:g}; expected an ascending range")
    search = _Search(point, box, criterion, progress)
    best = search.corners()
    many: Callable[..., Any] = search.values_of
    one: Callable[..., Any] = search.value_of
    bounds = Bounds(np.zeros(len(box)), np.ones(len(box)))
    for restart in range(RESTARTS):
        found = differential_evolution(
            many, bounds, maxiter=GENERATIONS, popsize=POPULATION_A_DIMENSION, tol=1e-4, vectorized=True,
            updating="deferred", polish=False, rng=seed + restart, x0=best,
        )  # fmt: skip
        best = search.better(best, found.x)
    options = {"maxfev": POLISH_EVALUATIONS, "xatol": 1e-4, "fatol": 1e-9}
    polished: Any = minimize(one, best, method="Nelder-Mead", bounds=bounds, options=options)  # type: ignore[call-overload]
    best = search.better(best, polished.x)
    told(progress, 1.0)
    return search.result(best, note)


class _Search:
    """Places in the unit cube, and how bad they are (smaller is worse)."""

    def __init__(
        self, point: OperatingPoint, box: Mapping[str, tuple[float, float]], criterion: Criterion, progress: Progress
    ) -> None:
        self.point, self.box, self.criterion, self.progress = point, dict(box), criterion, progress
        self.evaluations = 0
        self.expected = RESTARTS * (GENERATIONS + 1) * POPULATION_A_DIMENSION * len(box) + POLISH_EVALUATIONS
        self.same_controller = all(axis_named(name).side == "plant" for name in box)
        self.controllers = self._probed([point]) if self.same_controller else None

    def at(self, place: Numbers) -> dict[str, float]:
        """Return the values of the axes at a place (n,) of the unit cube."""
        values = {}
        for share, (name, (low, high)) in zip(place.tolist(), self.box.items(), strict=True):
            if axis_named(name).scale == "log":
                values[name] = math.exp((1.0 - share) * math.log(low) + share * math.log(high))
            else:
                values[name] = (1.0 - share) * low + share * high
        return values

    def values_of(self, places: Numbers) -> Numbers:
        """Return what is minimised at `places` (n, count): minus the growth [1/s], or the disk margin."""
        told(self.progress, self.evaluations / self.expected)
        places = places.reshape(len(self.box), -1)
        self.evaluations += places.shape[1]
        batch = self._batch([changed(self.point, self.at(place)) for place in places.T])
        if self.criterion == "growth":
            return -np.log(batch.radii()) / self.point.period_s
        radii, margins = batch.margins(PER_DECADE)
        disk = margins[:, :, DISK].min(axis=1)
        return np.where(radii < STABLE_RADIUS, disk, -np.log(radii) / self.point.period_s)

    def value_of(self, place: Numbers) -> float:
        """Return what is minimised at one place (n,)."""
        return float(self.values_of(place[:, None])[0])

    def corners(self) -> Numbers:
        """Return the worst of the corners and the centre of the box."""
        count = len(self.box)
        corners = [*product((0.0, 1.0), repeat=count)][:MOST_CORNERS]
        places = np.array([(0.5,) * count, *corners]).T
        worst: Numbers = places[:, int(np.argmin(self.values_of(places)))]
        return worst

    def better(self, one: Numbers, other: Numbers) -> Numbers:
        """Return the worse plant of two places."""
        first, second = self.values_of(np.column_stack([one, other]))
        return other if second < first else one

    def result(self, place: Numbers, note: str | None) -> WorstCase:
        """Return the WorstCase at `place`."""
        values = self.at(place)
        radii, margins = self._batch([changed(self.point, values)]).margins(PER_DECADE)
        stable = bool(radii[0] < STABLE_RADIUS)
        disk = float(margins[0, :, DISK].min()) if stable else None
        growth = math.log(radii[0]) / self.point.period_s
        return WorstCase(values, stable, growth, disk, self.evaluations, note)

    def _batch(self, points: list[OperatingPoint]) -> Batch:
        plants = Plants.of([each.plant for each in points], self.point.period_s)
        delayed = self.point.timing.compute_delay_samples != 0
        if self.controllers is not None:
            return Batch(self.controllers, plants, all_pairs(1, len(points)), self.point.period_s, delayed)
        each = np.arange(len(points))
        return Batch(self._probed(points), plants, np.stack([each, each], axis=1), self.point.period_s, delayed)

    def _probed(self, points: list[OperatingPoint]) -> Controllers:
        return Controllers.probed(
            [prepare(each.tuning, each.period_s, (each.stiffness, each.stiffness)) for each in points],
            [each.theta_ms for each in points],
            points[0].timing.compute_delay_samples != 0,
        )
