"""Which values each run of a batch has: the variations crossed, the last one changing fastest."""

import copy
import difflib
import itertools
import json
import math
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from functools import cached_property
from typing import Any, TypeVar

import numpy as np

from vssea_core.batch.columns import Column, drawn_column, grid_column, item, listed_column, type_of
from vssea_core.batch.document import Batch, Draw, Grid, Listed, Sample, Variation, Zipped, count_of
from vssea_core.batch.draws import unit_cube
from vssea_core.batch.refusals import VaryError, refused_at
from vssea_core.batch.runs import Runs, Values
from vssea_core.changes import UnknownPath, paths_of, set_value, value_at
from vssea_core.scenario import Scenario

Item = TypeVar("Item")
NEIGHBOURS = 3
LONGEST = 60
"""Characters that are shown of a value."""


class BatchPlan:
    """The runs of a batch: how many, their values, their scenarios. Raises ValueError if the batch makes no sense."""

    def __init__(self, batch: Batch) -> None:
        self.batch = batch
        self._document = batch.scenario.model_dump(mode="json")
        with np.errstate(over="ignore", invalid="ignore"):  # what is not finite is refused in a sentence
            self._columns = [[*self._columns_of(variation, place)] for place, variation in enumerate(batch.vary)]
        self._lengths = [count_of(variation) for variation in batch.vary]
        self.count = math.prod(self._lengths)
        self.paths = tuple(path for columns in self._columns for path, _ in columns)
        self.types = {path: type_of(column) for columns in self._columns for path, column in columns}
        """What a column of values is: truth values, whole numbers, numbers, or text (with JSON for what is neither)."""
        _check_apart(
            [(path, place) for variation, at in _placed(batch.vary) for path, place in _paths_in(variation, at)]
        )
        if batch.noise == "own" and "seed" in self.paths:
            raise VaryError("noise", "seed is varied, and noise own gives each run a seed too; expected one of them")

    def values(self, index: int) -> Values:
        """Return the values by path of run `index` (from 0). Raises IndexError."""
        if not 0 <= index < self.count:
            raise IndexError(f"run {index}; expected 0 to {self.count - 1}")
        places = np.unravel_index(index, self._lengths) if self._lengths else ()
        return {
            path: item(column, int(place))
            for columns, place in zip(self._columns, places, strict=True)
            for path, column in columns
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

    def _columns_of(self, variation: Variation, number: int, at: str = "") -> Iterator[tuple[str, Column]]:
        at = at or f"vary.{number}"
        match variation:
            case Zipped():
                for member, place in _placed(variation.members, f"{at}.members"):
                    yield from self._columns_of(member, number, place)
            case Sample():
                cube = unit_cube(variation, self.batch.seed, number)
                for (draw, place), unit in zip(_placed(variation.draws, f"{at}.draws"), cube.T, strict=True):
                    with refused_at(place):
                        column = drawn_column(draw, unit, *self._base_of(draw))
                    yield draw.path, column
            case Grid():
                with refused_at(at):
                    column = grid_column(variation, *self._base_of(variation))
                yield variation.path, column
            case Listed():
                with refused_at(at):
                    column = listed_column(variation, *self._base_of(variation))
                yield variation.path, column

    def _base_of(self, varied: Grid | Listed | Draw) -> tuple[float, bool]:
        """Return what values are factors of (1 if they are none), and whether the field has a whole number. Raises ValueError."""
        base = self._present(varied.path)
        whole = isinstance(base, int) and not isinstance(base, bool)
        if not varied.factor:
            return 1, whole
        factors = varied.values if isinstance(varied, Listed) else ()
        if not all(isinstance(x, int | float) and not isinstance(x, bool) for x in (base, *factors)):
            told = json.dumps(base)
            told = told if len(told) <= LONGEST else f"{told[: LONGEST - 3]}..."
            raise ValueError(f"{varied.path} is {told}; a factor needs a number there, and has to be one")
        return base, whole

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
            raise ValueError(f"{path} is no field of the scenario{told}") from None

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


def _placed(items: Sequence[Item], at: str = "vary") -> Iterator[tuple[Item, str]]:
    """Yield items of a list of the batch document, each with its place in it."""
    yield from ((item, f"{at}.{number}") for number, item in enumerate(items))


def _paths_in(variation: Variation, at: str) -> Iterator[tuple[str, str]]:
    """Yield the paths that a variation varies, each with the place of what varies it."""
    match variation:
        case Zipped():
            yield from ((member.path, place) for member, place in _placed(variation.members, f"{at}.members"))
        case Sample():
            yield from ((draw.path, place) for draw, place in _placed(variation.draws, f"{at}.draws"))
        case _:
            yield variation.path, at


def _check_apart(varied: Iterable[tuple[str, str]]) -> None:
    """Raise VaryError for a field that is varied twice, by itself or within a part that is varied too."""
    in_order = sorted((_names(path), path, place) for path, place in varied)
    for (outer_names, outer, _), (names, path, place) in itertools.pairwise(in_order):
        with refused_at(place):
            if outer_names == names:
                raise ValueError(f"{path} is varied twice; expected each field once")
            if names[: len(outer_names)] == outer_names:
                raise ValueError(f"{path} is varied, and so is all of {outer}; expected one of them")


def _names(path: str) -> tuple[str, ...]:
    """Return the names that a path leads through; item 00 of a list is item 0."""
    return tuple(str(int(name)) if name.isdecimal() else name for name in path.split("."))
