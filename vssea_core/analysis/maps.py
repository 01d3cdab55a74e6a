"""Maps over two parameters: where the loop is stable, how fast it decays or grows, and its worst margins.

Rows of a map are independent: they are worked on by threads, since kernels and LAPACK run without the interpreter lock.
"""

import math
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vssea_core.analysis.axes import Axis, axis_named
from vssea_core.analysis.batch import Batch, Controllers, Plants, all_pairs
from vssea_core.analysis.loop import STABLE_RADIUS
from vssea_core.analysis.margin_kernel import DELAY, DISK, GAIN_DOWN, GAIN_UP, PHASE
from vssea_core.analysis.operating_point import OperatingPoint, note_on_linearity
from vssea_core.analysis.prepared_rows import PreparedRows
from vssea_core.analysis.progress import Progress, told, unheard

Numbers = NDArray[np.float64]
PER_DECADE = 24.0
"""Grid points a decade for the margins of a map; each is refined, so only features narrower than that are lost."""
MOST_CELLS = 250_000


@dataclass(frozen=True)
class MapAxis:
    """One axis of a map: the name of an axes.Axis and its values, ascending."""

    name: str
    values: tuple[float, ...]

    @property
    def axis(self) -> Axis:
        """What the axis changes."""
        return axis_named(self.name)

    def document(self) -> dict[str, Any]:
        """Return name, words, unit, scale and values."""
        axis = self.axis
        return {
            "name": axis.name, "label": axis.label, "unit": axis.unit, "scale": axis.scale, "values": list(self.values),
        }  # fmt: skip


def map_axis(name: str, count: int, low: float | None = None, high: float | None = None) -> MapAxis:
    """Return `count` values of the axis `name` over [low, high] (its usual range if None), on its own scale.

    Raises ValueError for an unknown name, fewer than one value, or a range that is empty or not positive on a log scale.
    """
    axis = axis_named(name)
    start, end = axis.low if low is None else low, axis.high if high is None else high
    if count < 1:
        raise ValueError(f"{name} has {count} values; expected at least 1")
    if not start <= end or (axis.scale == "log" and start <= 0.0):
        raise ValueError(
            f"{name} runs from {start:g} to {end:g} {axis.unit}; expected an ascending range"
            f"{' above zero' if axis.scale == 'log' else ''}"
        )
    values = np.geomspace(start, end, count) if axis.scale == "log" else np.linspace(start, end, count)
    return MapAxis(name, tuple(values.tolist()))


@dataclass(frozen=True)
class StabilityMap:
    """Growth rates [1/s] of the dominant mode, ln(radius)/T, (len(y), len(x)); stable where negative."""

    x: MapAxis
    y: MapAxis
    growth: Numbers
    stable: NDArray[np.bool_]
    note: str | None = None

    def document(self) -> dict[str, Any]:
        """Return plain lists, a row for each value of y; None for a growth that is not finite."""
        return {
            "x": self.x.document(),
            "y": self.y.document(),
            "growth": _lists(self.growth),
            "stable": self.stable.tolist(),
            "note": self.note,
        }


@dataclass(frozen=True)
class MarginMap:
    """Worst margins of both breaks, (len(y), len(x)), NaN where unstable: disk alpha, phase [rad], delay [s], gain factors."""

    x: MapAxis
    y: MapAxis
    disk: Numbers
    phase: Numbers
    delay_s: Numbers
    gain_up: Numbers
    gain_down: Numbers
    stable: NDArray[np.bool_]
    note: str | None = None

    def document(self) -> dict[str, Any]:
        """Return plain lists, a row for each value of y; None where unstable or infinite."""
        layers = ("disk", "phase", "delay_s", "gain_up", "gain_down")
        return {
            "x": self.x.document(),
            "y": self.y.document(),
            **{name: _lists(getattr(self, name)) for name in layers},
            "stable": self.stable.tolist(),
            "note": self.note,
        }


def stability_map(
    point: OperatingPoint, x: MapAxis, y: MapAxis, progress: Progress = unheard, workers: int = 2
) -> StabilityMap:
    """Return the StabilityMap around `point`.

    Raises ValueError for equal axes, too many cells or a controller without a linear loop; Cancelled if `progress` says so.
    """
    note = _checked(point, x, y)

    def row(batch: Batch) -> Numbers:
        return batch.radii()

    radii = np.array(_rows(point, x, y, row, progress, workers))
    with np.errstate(divide="ignore"):
        growth = np.log(radii) / point.period_s
    return StabilityMap(x, y, growth, radii < STABLE_RADIUS, note)


def margin_map(
    point: OperatingPoint, x: MapAxis, y: MapAxis, progress: Progress = unheard, workers: int = 2
) -> MarginMap:
    """Return the MarginMap around `point`. Raises as stability_map does."""
    note = _checked(point, x, y)

    def row(batch: Batch) -> tuple[Numbers, Numbers]:
        return batch.margins(PER_DECADE)

    found = _rows(point, x, y, row, progress, workers)
    radii = np.array([radius for radius, _ in found])
    margins = np.array([each for _, each in found])
    least, most = margins.min(axis=2), margins.max(axis=2)
    return MarginMap(
        x, y, least[..., DISK], least[..., PHASE], least[..., DELAY], least[..., GAIN_UP], most[..., GAIN_DOWN],
        radii < STABLE_RADIUS, note,
    )  # fmt: skip


def _checked(point: OperatingPoint, x: MapAxis, y: MapAxis) -> str | None:
    if x.name == y.name:
        raise ValueError(f"both axes of the map are {x.name!r}; expected two different ones")
    if len(x.values) * len(y.values) > MOST_CELLS:
        raise ValueError(
            f"a map of {len(x.values)} by {len(y.values)} has {len(x.values) * len(y.values)} cells; "
            f"expected at most {MOST_CELLS}, so use fewer values"
        )
    return note_on_linearity(point.tuning)


def _rows(
    point: OperatingPoint,
    x: MapAxis,
    y: MapAxis,
    work: Callable[[Batch], Any],
    progress: Progress,
    workers: int,
) -> list[Any]:
    """Return `work` of the batch of each row, in order, worked on by threads."""
    prepared = PreparedRows(point, x, y)

    def of_row(index: int) -> Any:
        return work(row_batch(point, x, y.axis.change, y.values[index], prepared.of_row(index)))

    told(progress, 0.0)
    found: list[Any] = []
    with ThreadPoolExecutor(workers) as threads:
        pending = [threads.submit(of_row, index) for index in range(len(y.values))]
        try:
            for done, future in enumerate(pending):
                found.append(future.result())
                told(progress, (done + 1) / len(pending))
        finally:
            for future in pending:
                future.cancel()
    return found


def row_batch(
    point: OperatingPoint,
    x: MapAxis,
    change_y: Callable[[OperatingPoint, float], OperatingPoint],
    value: float,
    prepared: Sequence[Numbers],
) -> Batch:
    """Return the Batch of one row: all values of `x`, `value` of the other axis, with the `prepared` tuning of each cell."""
    here = change_y(point, value)
    period, delayed = point.period_s, point.timing.compute_delay_samples != 0
    if x.axis.side == "plant":
        controllers = Controllers.probed([prepared[0]], [here.theta_ms], delayed)
        plants = Plants.of([x.axis.change(here, each).plant for each in x.values], period)
    else:
        angles = [
            x.axis.change(here, each).theta_ms if x.axis.side == "stiffness" else here.theta_ms for each in x.values
        ]
        controllers = Controllers.probed(
            prepared if len(prepared) > 1 else [prepared[0]] * len(angles), angles, delayed
        )
        plants = Plants.of([here.plant], period)
    return Batch(controllers, plants, all_pairs(len(controllers.theta_ms), len(plants.rows)), period, delayed)


def _lists(values: Numbers) -> list[list[float | None]]:
    return [[float(each) if math.isfinite(each) else None for each in row] for row in values]
