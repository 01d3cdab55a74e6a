"""The courses of runs side by side: one for all of them, kept for the next set, or several, a block of samples at a time."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vssea_core.batch import layout as at
from vssea_core.batch.courses import fill_commands, fill_loads, fill_targets
from vssea_core.batch.lane_access import LANES
from vssea_core.batch.numbers import RunNumbers

Numbers = NDArray[np.float64]


class Course:
    """One of the things that come from outside, `size` numbers a sample, which `fill` computes from its source."""

    def __init__(self, size: int, fill: Callable[..., None]) -> None:
        self._size, self._fill = size, fill
        self.which = np.zeros(LANES, dtype=np.int64)
        """Which of the courses is that of each lane; lanes that nobody needs have the first."""
        self._different: list[tuple[Any, ...]] = []
        self._kept_for: tuple[bytes, int, float] | None = None
        self._kept = self._room = np.empty((0, 0, size))

    def open(self, keys: Sequence[bytes], sources: Sequence[tuple[Any, ...]], count: int, period_s: float) -> None:
        """Open it for up to LANES runs of `count` samples; those with the same key share a course."""
        places: dict[bytes, int] = {}
        self.which[:], self._different = 0, []
        for lane, (key, source) in enumerate(zip(keys, sources, strict=True)):
            if key not in places:
                places[key] = len(places)
                self._different.append(source)
            self.which[lane] = places[key]
        kept_for = keys[0], count, period_s
        if len(places) == 1 and kept_for != self._kept_for:
            self._kept_for, self._kept = kept_for, np.empty((1, count, self._size))
            self._fill(*self._different[0], 0, count, period_s, self._kept[0])

    @property
    def is_kept(self) -> bool:
        """Whether there is one for all runs, which is computed already."""
        return len(self._different) == 1

    def pages(self, first: int, count: int, period_s: float) -> Numbers:
        """Return the courses (m, count, size) of `count` samples from `first` on."""
        if self.is_kept:
            return self._kept[:, first : first + count]
        shape = len(self._different), count, self._size
        if self._room.shape != shape:
            self._room = np.empty(shape)
        for source, course in zip(self._different, self._room, strict=True):
            self._fill(*source, first, count, period_s, course)
        return self._room


class CourseBook:
    """The courses of the runs for which it was opened last; most batches vary plant or tuning alone, and have one."""

    def __init__(self) -> None:
        self.targets = Course(at.COMMAND - at.TARGET, fill_targets)
        self.commands = Course(at.LINK_LOADS - at.COMMAND, fill_commands)
        self.loads = Course(at.STEPS - at.LINK_LOADS, fill_loads)
        self.link_terms = self.motor_terms = np.empty((0, 0, 0))

    @property
    def are_kept(self) -> bool:
        """Whether all runs have all of them in common."""
        return self.targets.is_kept and self.commands.is_kept and self.loads.is_kept

    def open(self, runs: Sequence[RunNumbers], predicts: bool) -> None:
        """Open it for up to LANES `runs` of one kind."""
        count, period = runs[0].count, runs[0].scenario.timing.sample_time_s
        targets, commands, loads = zip(*(each.course for each in runs), strict=True)
        also = b"%d" % predicts
        self.targets.open([key + also for key in targets], [(each.reference, predicts) for each in runs], count, period)
        self.commands.open(commands, [(each.slew,) for each in runs], count, period)
        terms = [(each.inputs.link_terms, each.inputs.motor_terms) for each in runs]
        self.loads.open(loads, terms, count, period)
        terms += terms[:1] * (LANES - len(terms))
        self.link_terms, self.motor_terms = (_stacked(tables) for tables in zip(*terms, strict=True))


def _stacked(tables: Sequence[Numbers]) -> Numbers:
    """Return the disturbance terms of each lane (LANES, n, 16), filled up with terms that never act."""
    stacked = np.full((len(tables), max(len(table) for table in tables), tables[0].shape[1]), np.inf)
    stacked[:, :, 0] = 0.0
    for to, table in zip(stacked, tables, strict=True):
        to[: len(table)] = table
    return stacked
