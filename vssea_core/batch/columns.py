"""The values of one varied field, a column of them: numbers as an array, anything else as a list."""

import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vssea_core.batch.document import Draw, Grid, Listed
from vssea_core.batch.draws import drawn, drawn_whole

Numbers = NDArray[np.float64]
Column = NDArray[Any] | list[Any]
INT64 = np.iinfo(np.int64)


def drawn_column(draw: Draw, unit: Numbers, factor_of: float, whole: bool) -> Column:
    """Return the values of a draw at numbers (n,) between 0 and 1, times `factor_of`. Raises ValueError."""
    if not whole:
        return _finite(draw.path, factor_of * drawn(draw.distribution, unit))
    try:
        values = drawn_whole(draw.distribution, unit, int(factor_of))
    except ValueError as none:
        raise ValueError(f"{draw.path} takes whole numbers, and {none}; widen its distribution") from None
    return _as_whole(_finite(draw.path, values))


def grid_column(grid: Grid, factor_of: float, whole: bool) -> Column:
    """Return the values of a grid, times `factor_of`. Raises ValueError."""
    if grid.spacing == "log" and not (grid.low > 0.0 and grid.high > 0.0):
        raise ValueError(f"{grid.path} goes from {grid.low:g} to {grid.high:g}; a log grid needs positive ends")
    values = _finite(grid.path, factor_of * _spaced(grid, grid.count))
    if not whole:
        return values
    fits = grid.count
    while (different := np.unique(np.rint(factor_of * _spaced(grid, fits))).size) < fits:
        fits = different
    if fits < grid.count:
        raise ValueError(
            f"{grid.path} takes whole numbers, and {grid.count} values from {values[0]:g} to {values[-1]:g} "
            f"repeat some of them; a count of {fits} does not"
        )
    return _as_whole(np.rint(values))


def listed_column(listed: Listed, factor_of: float, whole: bool) -> Column:
    """Return the values of a list, times `factor_of` if they are factors. Raises ValueError."""
    values: list[Any] = list(listed.values)
    if listed.factor:
        try:
            values = [factor_of * value for value in values]
        except OverflowError:
            values = [np.inf]
        _finite(listed.path, np.array([value for value in values if isinstance(value, float)]))
    return [round(value) for value in values] if whole and all(isinstance(x, float) for x in values) else values


def item(column: Column, place: int) -> Any:
    """Return one value of a column, as JSON has it."""
    return column[place].item() if isinstance(column, np.ndarray) else column[place]


def type_of(column: Column) -> type:
    """Return what a column of results holds: bool, int if all are whole and fit into 64 bits, float, or str for the rest."""
    if isinstance(column, np.ndarray):
        return int if column.dtype == np.int64 else float
    if all(isinstance(value, bool) for value in column):
        return bool
    if any(isinstance(value, bool) or not isinstance(value, int | float) for value in column):
        return str
    if all(isinstance(value, int) and INT64.min <= value <= INT64.max for value in column):
        return int
    return float if all(abs(value) <= sys.float_info.max for value in column) else str


def _spaced(grid: Grid, count: int) -> Numbers:
    space = np.geomspace if grid.spacing == "log" else np.linspace
    return np.asarray(space(grid.low, grid.high, count))


def _finite(path: str, values: Numbers) -> Numbers:
    if not np.isfinite(values).all():
        raise ValueError(f"{path} gets values beyond the largest number there is; expected smaller ones")
    return values


def _as_whole(values: Numbers) -> Column:
    """Return whole floats as integers; those that 64 bits cannot hold make the column a list."""
    return values.astype(np.int64) if np.abs(values).max() < INT64.max else [int(value) for value in values]
