"""Prepared tunings for the cells of a map, without preparing each of them where two parameters do not meet."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from vssea_core.analysis.axes import Axis
from vssea_core.analysis.operating_point import OperatingPoint
from vssea_core.control.prepared import prepare

Numbers = NDArray[np.float64]


class Values(Protocol):
    """An axis of a map: what it changes, and its values."""

    @property
    def values(self) -> tuple[float, ...]:
        """Values, ascending."""

    @property
    def axis(self) -> Axis:
        """What they change."""


class PreparedRows:
    """The numbers of `prepare` for every cell: prepared once for each value of an axis that changes the tuning.

    Where both axes do (poles and bandwidth, say), their numbers are put together from both, if the corners of the map show
    that no number depends on both; else each cell is prepared.
    """

    def __init__(self, point: OperatingPoint, x: Values, y: Values) -> None:
        self.point, self.x, self.y = point, x, y
        self.period_s = point.period_s
        self.base = prepare(point.tuning, self.period_s)
        self.of_x = self._along(x)
        self.of_y = self._along(y)
        self.separable = len(self.of_x) == 1 or len(self.of_y) == 1 or self._corners_agree()

    def of_row(self, index: int) -> Sequence[Numbers]:
        """Return the prepared tunings of row `index`: one for each value of x, or a single one if x does not change them."""
        if len(self.of_x) == 1:
            return [self._of_y(index)]
        if self.separable:
            return [self._joined(each, self._of_y(index)) for each in self.of_x]
        return [self._prepared(index, column) for column in range(len(self.of_x))]

    def _along(self, axis: Values) -> list[Numbers]:
        if axis.axis.side != "tuning":
            return [self.base]
        return [prepare(axis.axis.change(self.point, value).tuning, self.period_s) for value in axis.values]

    def _of_y(self, index: int) -> Numbers:
        return self.of_y[index] if len(self.of_y) > 1 else self.of_y[0]

    def _prepared(self, row: int, column: int) -> Numbers:
        point = self.y.axis.change(self.point, self.y.values[row])
        return prepare(self.x.axis.change(point, self.x.values[column]).tuning, self.period_s)

    def _joined(self, along_x: Numbers, along_y: Numbers) -> Numbers:
        return np.where(along_x != self.base, along_x, along_y)

    def _corners_agree(self) -> bool:
        for row in (0, len(self.of_y) - 1):
            for column in (0, len(self.of_x) - 1):
                joined = self._joined(self.of_x[column], self.of_y[row])
                if not np.array_equal(joined, self._prepared(row, column)):
                    return False
        return True
