"""How far the true plant may be from what was assumed: the nearest border of stability in each parameter, to both sides."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vssea_core.analysis.batch import Batch, Controllers, Plants, all_pairs
from vssea_core.analysis.loop import STABLE_RADIUS, Pieces
from vssea_core.analysis.margins import Margins, margins_at
from vssea_core.analysis.operating_point import LinearPlant, OperatingPoint
from vssea_core.control.prepared import prepare

FARTHEST = 10.0
"""Factor up to which a parameter is looked at, to both sides."""
FACTORS = ("link_inertia", "motor_inertia", "spring_constant")
LONGEST_DELAY_SAMPLES = 20.0
RESOLUTION = 1e-3  # relative width at which a border is known
CUTS = 7
"""Points at which a bracket is cut at once: an assembled batch costs less than as many single loops."""


def _outward() -> NDArray[np.float64]:
    """Return logarithms of the factors tried, from 0: steps of 1 % near the present plant, growing to 10 %."""
    steps, size = [0.0], 0.01
    while steps[-1] < math.log(FARTHEST):
        steps.append(steps[-1] + size)
        size = min(0.1, 1.25 * size)
    return np.array([*steps[:-1], math.log(FARTHEST)])


OUTWARD = _outward()
DELAYS = np.concatenate([np.arange(0.0, 4.0, 0.125), np.arange(4.0, LONGEST_DELAY_SAMPLES + 0.25, 0.25)])


@dataclass(frozen=True)
class StableRange:
    """Nearest factors on a true parameter at which the loop becomes unstable; None: none down to a tenth, up to tenfold."""

    below: float | None
    above: float | None

    def document(self) -> dict[str, float | None]:
        """Return plain numbers."""
        return {"below": self.below, "above": self.above}


@dataclass(frozen=True)
class Robustness:
    """Borders around one tuning and its margins; ranges and delay are None if it is unstable as it stands.

    delay_s: additional transport delay of the torque [s] at which the loop becomes unstable, None beyond 20 samples.
    """

    link_inertia: StableRange | None
    motor_inertia: StableRange | None
    spring_constant: StableRange | None
    delay_s: float | None
    margins: Margins
    period_s: float

    def document(self) -> dict[str, Any]:
        """Return plain numbers and lists."""
        return {
            **{name: found.document() if (found := getattr(self, name)) else None for name in FACTORS},
            "delay_s": self.delay_s,
            "delay_samples": None if self.delay_s is None else self.delay_s / self.period_s,
            "margins": self.margins.document(),
        }


def robustness(point: OperatingPoint) -> Robustness:
    """Return the Robustness of `point`: factors multiply its plant, so 1 is as assumed.

    The nearest border counts, not the last: beyond it there may be islands of stability. Gaps narrower than the steps of the
    search (1 % near the present plant, 10 % far away) can be missed. Raises ValueError if the controller has no linear loop.
    """
    pieces = Pieces(point)
    found = margins_at(pieces, point)
    if not found.stable:
        return Robustness(None, None, None, None, found, point.period_s)
    search = _Search(point)
    ranges = []
    for name in FACTORS:
        below = search.border(name, -OUTWARD)
        above = search.border(name, OUTWARD)
        ranges.append(StableRange(below and math.exp(below), above and math.exp(above)))
    delay = search.border("delay", DELAYS * point.period_s)
    link, motor, spring = ranges
    return Robustness(link, motor, spring, delay, found, point.period_s)


class _Search:
    """Borders of one controller, over plants that differ from its own in one parameter."""

    def __init__(self, point: OperatingPoint) -> None:
        self.plant, self.period_s = point.plant, point.period_s
        self.delayed = point.timing.compute_delay_samples != 0
        gains = prepare(point.tuning, point.period_s, (point.stiffness, point.stiffness))
        self.controllers = Controllers.probed([gains], [point.theta_ms], self.delayed)

    def border(self, name: str, places: NDArray[np.float64]) -> float | None:
        """Return the first place (logarithm of a factor, or delay [s]) where the loop is unstable, on the way along `places`.

        `places` starts where the loop is known to be stable. The place returned is on the stable side.
        """
        last = places[0]
        for start in range(1, len(places), CUTS):
            chunk = places[start : start + CUTS]
            unstable = self.unstable(name, chunk)
            if unstable.any():
                first = int(np.argmax(unstable))
                return self._narrowed(name, chunk[first - 1] if first else last, chunk[first])
            last = chunk[-1]
        return None

    def _narrowed(self, name: str, stable: float, unstable: float) -> float:
        tolerance = RESOLUTION if name != "delay" else RESOLUTION * max(stable, 0.1 * self.period_s)
        while abs(unstable - stable) > tolerance:
            cuts = np.linspace(stable, unstable, CUTS + 2)
            bad = np.append(self.unstable(name, cuts[1:-1]), True)
            first = int(np.argmax(bad))
            stable, unstable = cuts[first], cuts[first + 1]
        return float(stable)

    def unstable(self, name: str, places: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return which of `places` are unstable."""
        plants = [self._moved(name, float(place)) for place in places]
        batch = Batch(
            self.controllers, Plants.of(plants, self.period_s), all_pairs(1, len(plants)), self.period_s, self.delayed
        )
        return ~(batch.radii() < STABLE_RADIUS)

    def _moved(self, name: str, place: float) -> LinearPlant:
        return self.plant.with_delay(place) if name == "delay" else self.plant.scaled(**{name: math.exp(place)})
