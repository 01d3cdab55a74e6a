"""A level crossing is found exactly once, wherever the pieces that are read begin and end."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from backend.session.trigger_source import Crossing, LevelSource
from backend.telemetry.ring import COLUMNS, EPOCH
from vssea_core.channels import INDEX

Edge = st.sampled_from(["rising", "falling", "either"])


def samples(values: list[float], epochs: list[int] | None = None) -> NDArray[np.float64]:
    rows = np.zeros((len(values), COLUMNS))
    rows[:, INDEX["error"]] = values
    rows[:, EPOCH] = epochs or 1
    return rows


def crossing(level: float = 0.0, edge: str = "rising") -> Crossing:
    return Crossing(LevelSource(kind="level", channel="error", level=level, edge=edge))  # type: ignore[arg-type]


def crosses(before: float, now: float, level: float, edge: str) -> bool:
    """One pair of samples, written as the words say it."""
    up, down = before < level <= now, before > level >= now
    return {"rising": up, "falling": down, "either": up or down}[edge]


@given(
    st.lists(st.tuples(st.integers(-3, 3), st.integers(1, 2)), max_size=40),
    st.integers(-2, 2),
    Edge,
    st.lists(st.integers(0, 40), max_size=5),
)
def test_pieces_find_what_one_look_at_all_samples_finds(
    rows: list[tuple[int, int]], level: int, edge: str, cuts: list[int]
) -> None:
    rows = sorted(rows, key=lambda row: row[1])  # runs follow each other
    values, runs = [float(value) for value, _ in rows], [run for _, run in rows]
    expected = [
        i for i in range(1, len(rows))
        if runs[i - 1] == runs[i] and crosses(values[i - 1], values[i], level, edge)
    ]  # fmt: skip
    found, watched, borders = [], crossing(level, edge), sorted({0, len(rows), *(min(cut, len(rows)) for cut in cuts)})
    for start, stop in pairwise(borders):
        at = watched.first(samples(values[start:stop], runs[start:stop]))
        if at is not None:
            found.append(start + at)
    assert found == [  # of each piece the first
        first for start, stop in pairwise(borders)
        for first in [next((i for i in expected if start <= i < stop), None)] if first is not None
    ]  # fmt: skip


def test_a_crossing_between_two_reads_is_found_once() -> None:
    watched = crossing()
    assert watched.first(samples([-2.0, -1.0])) is None
    assert watched.first(samples([1.0, 2.0])) == 0
    assert watched.first(samples([3.0, 4.0])) is None


@pytest.mark.parametrize(("edge", "found"), [("rising", 2), ("falling", 4), ("either", 2)])
def test_the_edge_says_which_way(edge: str, found: int) -> None:
    assert crossing(0.0, edge).first(samples([-2.0, -1.0, 1.0, 2.0, -1.0])) == found


def test_a_signal_that_is_beyond_the_level_when_armed_fires_only_after_it_came_back() -> None:
    watched = crossing()
    assert watched.first(samples([1.0, 2.0])) is None
    assert watched.first(samples([-1.0, 1.0])) == 1


def test_a_new_run_begins_without_a_crossing() -> None:
    watched = crossing()
    assert watched.first(samples([-1.0, -1.0], [1, 1])) is None
    assert watched.first(samples([1.0, 1.0, -1.0, 1.0], [2, 2, 2, 2])) == 3


def test_what_was_lost_is_not_a_crossing() -> None:
    watched = crossing()
    watched.first(samples([-1.0]))
    watched.forget()
    assert watched.first(samples([1.0])) is None


def test_missing_values_are_no_crossing() -> None:
    assert crossing().first(samples([-1.0, np.nan, 1.0])) is None


@pytest.mark.parametrize("name", ["time", "colour"])
def test_only_a_channel_can_be_watched(name: str) -> None:
    with pytest.raises(ValueError, match="is not a channel to trigger on"):
        LevelSource(kind="level", channel=name)
