"""The courses of runs side by side: one for all of them, kept for the next set, or several, a block of samples at a time."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vssea_core.batch import layout as at
from vssea_core.batch.courses import fill_course
from vssea_core.batch.lane_access import LANES
from vssea_core.batch.numbers import RunNumbers

Numbers = NDArray[np.float64]
EMPTY = np.empty((0, 0, at.COURSE_SIZE))


class CourseBook:
    """Gives the courses of the runs for which it was opened last; most batches vary plant or tuning alone, and have one."""

    def __init__(self) -> None:
        self.which = np.zeros(LANES, dtype=np.int64)
        self.link_terms = self.motor_terms = EMPTY
        self._different: list[RunNumbers] = []
        self._predicts = False
        self._kept_for: tuple[bytes, int, float, bool] | None = None
        self._kept = self._room = EMPTY

    def open(self, runs: Sequence[RunNumbers], predicts: bool) -> None:
        """Open it for up to LANES `runs` of one kind."""
        kinds = {each.course: each for each in reversed(runs)}
        places = {kind: place for place, kind in enumerate(kinds)}
        self._different, self._predicts = list(kinds.values()), predicts
        self.which[:] = 0
        self.which[: len(runs)] = [places[each.course] for each in runs]
        self.link_terms = _stacked([each.inputs.link_terms for each in self._different])
        self.motor_terms = _stacked([each.inputs.motor_terms for each in self._different])
        if len(kinds) == 1:
            self._keep(runs[0])

    def pages(self, first: int, count: int) -> Numbers:
        """Return the courses (m, count, COURSE_SIZE) of `count` samples from `first` on."""
        if len(self._different) == 1:
            return self._kept[:, first : first + count]
        shape = len(self._different), count, at.COURSE_SIZE
        if self._room.shape != shape:
            self._room = np.empty(shape)
        for each, course in zip(self._different, self._room, strict=True):
            self._fill(each, first, course)
        return self._room

    def _keep(self, only: RunNumbers) -> None:
        key = only.course, only.count, only.scenario.timing.sample_time_s, self._predicts
        if key != self._kept_for:
            self._kept_for, self._kept = key, np.empty((1, only.count, at.COURSE_SIZE))
            self._fill(only, 0, self._kept[0])

    def _fill(self, each: RunNumbers, first: int, course: Numbers) -> None:
        fill_course(
            each.reference, each.slew, each.inputs.link_terms, each.inputs.motor_terms, self._predicts,
            first, len(course), each.scenario.timing.sample_time_s, course,
        )  # fmt: skip


def _stacked(tables: Sequence[Numbers]) -> Numbers:
    """Return tables of disturbance terms (m, n, 16), filled up with terms that never act."""
    stacked = np.full((len(tables), max(len(table) for table in tables), tables[0].shape[1]), np.inf)
    stacked[:, :, 0] = 0.0
    for to, table in zip(stacked, tables, strict=True):
        to[: len(table)] = table
    return stacked
