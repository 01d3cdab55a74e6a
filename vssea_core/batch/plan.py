"""Which values each run of a batch has: the variations crossed, the last one changing fastest."""

import copy
import difflib
import json
import math
from collections.abc import Iterator
from contextlib import suppress
from functools import cached_property
from typing import Any

import numpy as np

from vssea_core.batch.document import Batch, Draw, Grid, Listed, Sample, Variation, Zipped, count_of
from vssea_core.batch.draws import drawn, unit_cube
from vssea_core.batch.runs import Runs, Values
from vssea_core.changes import UnknownPath, paths_of, set_value, value_at
from vssea_core.scenario import Scenario

NEIGHBOURS = 3


class BatchPlan:
    """The runs of a batch: how many, their values, their scenarios. Raises ValueError if the batch makes no sense."""

    def __init__(self, batch: Batch) -> None:
        self.batch = batch
        self._document = batch.scenario.model_dump(mode="json")
        self._columns = [self._columns_of(variation, place) for place, variation in enumerate(batch.vary)]
        self._lengths = [count_of(variation) for variation in batch.vary]
        self.count = math.prod(self._lengths)
        self.paths = tuple(path for columns in self._columns for path in columns)
        self.types = {path: _type_of(column) for columns in self._columns for path, column in columns.items()}
        """What a column of values is: whole numbers, numbers, or text (with JSON for what is neither)."""
        twice = next((path for path in self.paths if self.paths.count(path) > 1), None)
        if twice is not None:
            raise ValueError(f"vary: {twice} is varied twice; expected each field once")

    def values(self, index: int) -> Values:
        """Return the values by path of run `index` (from 0). Raises IndexError."""
        if not 0 <= index < self.count:
            raise IndexError(f"run {index}; expected 0 to {self.count - 1}")
        places = np.unravel_index(index, self._lengths) if self._lengths else ()
        return {
            path: column[int(place)]
            for columns, place in zip(self._columns, places, strict=True)
            for path, column in columns.items()
        }

    def scenario(self, index: int) -> Scenario:
        """Return the scenario of run `index`. Raises ValueError if its values are refused, IndexError."""
        values = self.values(index)
        if self.batch.noise == "own":
            values = {"seed": (self.batch.scenario.seed + index) % 2**31, **values}
        return self._runs.scenario(values)

    def scenarios(self, first: int, count: int) -> Iterator[Scenario | ValueError]:
        """Yield the scenarios of some runs; a ValueError for one that is refused."""
        for index in range(first, min(first + count, self.count)):
            try:
                yield self.scenario(index)
            except ValueError as refusal:
                yield refusal

    @cached_property
    def _runs(self) -> Runs:
        return Runs(self.batch.scenario)

    def _columns_of(self, variation: Variation, place: int) -> dict[str, list[Any]]:
        match variation:
            case Zipped():
                return {
                    path: column
                    for member in variation.members
                    for path, column in self._columns_of(member, place).items()
                }
            case Sample():
                cube = unit_cube(variation, self.batch.seed, place)
                columns = {draw.path: drawn(draw.distribution, cube[:, i]) for i, draw in enumerate(variation.draws)}
                return {draw.path: self._scaled(draw, columns[draw.path].tolist()) for draw in variation.draws}
            case Grid():
                if variation.spacing == "log" and not (variation.low > 0.0 and variation.high > 0.0):
                    ends = f"{variation.low:g} to {variation.high:g}"
                    raise ValueError(f"vary: {variation.path} goes from {ends}; a log grid needs positive ends")
                space = np.geomspace if variation.spacing == "log" else np.linspace
                values = space(variation.low, variation.high, variation.count).tolist()
                return {variation.path: self._scaled(variation, values)}
            case Listed():
                return {variation.path: self._scaled(variation, list(variation.values))}

    def _scaled(self, varied: Grid | Listed | Draw, values: list[Any]) -> list[Any]:
        base = self._present(varied.path)
        whole = isinstance(base, int) and not isinstance(base, bool)
        if varied.factor:
            if not all(isinstance(x, int | float) and not isinstance(x, bool) for x in (base, *values)):
                raise ValueError(
                    f"vary: {varied.path} is {json.dumps(base)}; a factor needs a number there, and has to be one"
                )
            values = [base * value for value in values]
        return [round(value) for value in values] if whole and all(isinstance(x, float) for x in values) else values

    def _present(self, path: str) -> Any:
        """Return what the base has at a path, None where only another kind has it. Raises ValueError."""
        try:
            return value_at(self._document, path)
        except UnknownPath:
            known = sorted({known for document in self._kinds() for known in paths_of(document)})
            if path in known:
                return None
            near = difflib.get_close_matches(path, known, NEIGHBOURS, cutoff=0.4)
            told = f"; nearest: {', '.join(near)}" if near else ""
            raise ValueError(f"vary: {path} is no field of the scenario{told}") from None

    def _kinds(self) -> Iterator[dict[str, Any]]:
        """Yield the base's document, and what it is with each kind that is varied."""
        yield self._document
        listed = (each for variation in self.batch.vary for each in getattr(variation, "members", (variation,)))
        for each in listed:
            if isinstance(each, Listed) and each.path.endswith(".kind"):
                for kind in each.values:
                    document = copy.deepcopy(self._document)
                    with suppress(UnknownPath):
                        set_value(document, Scenario, each.path, kind)
                        yield document


def _type_of(column: list[Any]) -> type:
    if any(isinstance(value, bool) or not isinstance(value, int | float) for value in column):
        return str
    return int if all(isinstance(value, int) for value in column) else float
