"""Many scenarios run: side by side where they can, alone where they cannot or where they end early."""

from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from vssea_core.batch.course_book import CourseBook
from vssea_core.batch.lane_access import LANES
from vssea_core.batch.lanes import Variant
from vssea_core.batch.numbers import NumbersOf, RunNumbers
from vssea_core.batch.run_lanes import run_side_by_side
from vssea_core.batch.sums import LIMIT_NAMES, METRIC_NAMES
from vssea_core.scenario import Scenario
from vssea_core.simulation.metrics import limit_shares, metrics
from vssea_core.simulation.run import simulate

Numbers = NDArray[np.float64]
State = Literal["done", "ended", "refused"]


@dataclass(frozen=True)
class Outcome:
    """What became of a run: `figures` (17,) are metrics and limit shares, over `time_s` [s]; of a refused run they are nan."""

    state: State
    figures: Numbers
    time_s: float
    reason: str = ""


FEW = 3
"""Fewer runs than this are quicker alone than in lanes."""
REFUSED = np.full(len(METRIC_NAMES) + len(LIMIT_NAMES), np.nan)


def run_scenarios(
    scenarios: Sequence[Scenario | ValueError], goes_on: Callable[[int], bool] = lambda done: True
) -> list[Outcome] | None:
    """Return the outcome of each of `scenarios`, in their order; a ValueError among them is a run that was refused before.

    Every few runs `goes_on` is told how many are done; None is returned as soon as it returns False.
    """
    outcomes: dict[int, Outcome] = {}
    numbers_of = NumbersOf()
    groups: dict[tuple[Variant | None, float, int, bool, int], list[tuple[int, RunNumbers]]] = defaultdict(list)
    for place, scenario in enumerate(scenarios):
        try:
            if isinstance(scenario, ValueError):
                raise scenario
            numbers = numbers_of(scenario)
        except (ValueError, ArithmeticError) as refusal:
            outcomes[place] = _refused(refusal)
        else:
            kind = (
                numbers.variant,
                scenario.timing.sample_time_s,
                numbers.count,
                numbers.delayed,
                len(numbers.prepared),
            )
            groups[kind].append((place, numbers))
    courses = CourseBook()
    for (variant, *_), runs in groups.items():
        runs.sort(key=lambda each: each[1].course)  # those that share a course lie side by side
        for first in range(0, len(runs), LANES):
            if not goes_on(len(outcomes)):
                return None
            together = runs[first : first + LANES]
            outcomes |= (
                _alone(together)
                if variant is None or len(together) < FEW
                else _side_by_side(variant, together, courses)
            )
    return [outcomes[place] for place in range(len(scenarios))]


def run_alone(scenario: Scenario) -> Outcome:
    """Return the outcome of one scenario, run by itself. Raises ValueError if it is refused."""
    trajectory = simulate(scenario)
    figures, shares = metrics(trajectory.rows), limit_shares(trajectory.rows)
    row = [figures[name] for name in METRIC_NAMES] + [shares.get(name, 0.0) for name in LIMIT_NAMES]
    time_s = len(trajectory) * trajectory.period_s
    return Outcome("ended" if trajectory.ending else "done", np.array(row), time_s, trajectory.ending or "")


def _alone(runs: Iterable[tuple[int, RunNumbers]]) -> dict[int, Outcome]:
    outcomes = dict[int, Outcome]()
    for place, numbers in runs:
        try:
            outcomes[place] = run_alone(numbers.scenario)
        except (ValueError, ArithmeticError) as refusal:  # one run never costs the others
            outcomes[place] = _refused(refusal)
    return outcomes


def _refused(refusal: ValueError | ArithmeticError) -> Outcome:
    is_told = isinstance(refusal, ValueError)
    return Outcome("refused", REFUSED, 0.0, str(refusal) if is_told else f"its values lead to an {refusal!r}")


def _side_by_side(variant: Variant, runs: Sequence[tuple[int, RunNumbers]], courses: CourseBook) -> dict[int, Outcome]:
    figures, gone = run_side_by_side(variant, [numbers for _, numbers in runs], courses)
    outcomes = _alone(each for each, ended in zip(runs, gone, strict=True) if ended)
    for (place, numbers), row in zip(runs, figures, strict=True):
        if place not in outcomes:
            outcomes[place] = Outcome("done", row, numbers.count * numbers.scenario.timing.sample_time_s)
    return outcomes
