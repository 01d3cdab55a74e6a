"""Samples for drawing: every row of a short span, least and greatest values of a long one, in one binary answer."""

import json
import struct
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from backend.recordings.layout import FIELD_INDEX
from backend.recordings.overview import BLOCK, Blocks, OverviewBuilder, all_rows, overview
from backend.recordings.reader import ANOTHER_INSTANT_S, SAME_INSTANT_S, Recording
from backend.recordings.thinning import extremes, merged

Numbers = NDArray[np.float64]
MOST_POINTS = 20_000


@dataclass(frozen=True)
class Drawn:
    """What is drawn of a span: time (n,) [s] and rows (n, channels); NaN where samples are missing.

    `exact`: every sample is a row. Else rows come in pairs, least and greatest of a run of samples in the order in which they
    occurred, at the begin and the middle of the run. `of` is the number of samples in the span.
    """

    time: Numbers
    rows: Numbers
    exact: bool
    of: int


def samples_answer(
    recording: Recording,
    channels: list[str],
    from_s: float = -np.inf,
    to_s: float = np.inf,
    points: int = 2000,
    cache: Path | None = None,
) -> bytes:
    """Return the binary answer of docs/protocol.md. Raises ValueError for an unknown channel or a wrong number of points."""
    blocks = None if cache is None else lambda: overview(recording, cache)
    shown = drawn(recording, channels, from_s, to_s, points, blocks)
    low_s, high_s = recording.span
    head = {
        "from_s": float(max(from_s, low_s)), "to_s": float(min(to_s, high_s)), "samples": len(shown.time), "exact": shown.exact,
        "period_s": float(recording.head.get("sample_time_s", 0.0)), "channels": channels, "of": shown.of,
    }  # fmt: skip
    text = json.dumps(head, ensure_ascii=False, allow_nan=False).encode()
    text += b" " * (-(4 + len(text)) % 8)
    with np.errstate(over="ignore"):
        columns = np.ascontiguousarray(shown.rows.T, "<f4")
    return struct.pack("<I", len(text)) + text + shown.time.astype("<f8").tobytes() + columns.tobytes()


def drawn(
    recording: Recording,
    channels: list[str],
    from_s: float,
    to_s: float,
    points: int,
    blocks: Callable[[], Blocks] | None = None,
) -> Drawn:
    """Return what is drawn of a span in at most `points` rows; a wide span is drawn from the overview, if `blocks` gives it."""
    if not 4 <= points <= MOST_POINTS:
        raise ValueError(f"points is {points}; expected 4 to {MOST_POINTS}")
    if not from_s <= to_s:
        raise ValueError(f"the span begins at {from_s:g} s and ends at {to_s:g} s; expected an end after its begin")
    runs = points // 2
    if blocks is not None and recording.count(from_s, to_s) > runs * BLOCK:
        return _from_overview(recording, channels, from_s, to_s, runs, blocks())
    block = recording.read(["time", *channels], from_s, to_s)
    time, rows, gaps = block.rows[:, 0], block.rows[:, 1:], block.gaps()
    if len(rows) + len(gaps) <= points:
        missing = np.full((len(gaps), rows.shape[1]), np.nan)
        return Drawn(np.insert(time, gaps, time[gaps - 1]), np.insert(rows, gaps, missing, axis=0), True, len(rows))
    starts = _starts(len(rows), gaps, runs)
    ends = np.append(starts[1:], len(rows)) - 1
    pairs = extremes(rows, starts).pairs()
    return _in_pairs(pairs, time[starts], time[ends], np.isin(starts, gaps), len(rows))


def _from_overview(
    recording: Recording, channels: list[str], from_s: float, to_s: float, runs: int, blocks: Blocks
) -> Drawn:
    """Return what is drawn of whole blocks, and of the samples beside them at both ends of the span."""
    columns = [FIELD_INDEX[name] for name in channels]
    inside = blocks[(blocks["begin_s"] >= from_s - SAME_INSTANT_S) & (blocks["end_s"] <= to_s + SAME_INSTANT_S)]
    head = _as_blocks(recording, from_s, inside["begin_s"][0] - ANOTHER_INSTANT_S)
    tail = _as_blocks(recording, inside["end_s"][-1] + ANOTHER_INSTANT_S, to_s)
    inside = np.concatenate([head, inside, tail])
    low, high, low_first = (inside[name][:, columns] for name in ("low", "high", "low_first"))
    gaps = np.flatnonzero(inside["gap_before"])
    gaps = gaps[gaps > 0]
    starts = _starts(len(inside), gaps, runs)
    ends = np.append(starts[1:], len(inside)) - 1
    pairs = merged(low, high, low_first, starts).pairs()
    begin_s, end_s = inside["begin_s"][starts], inside["end_s"][ends]
    return _in_pairs(pairs, begin_s, end_s, np.isin(starts, gaps), int(inside["count"].sum()))


def _as_blocks(recording: Recording, from_s: float, to_s: float) -> Blocks:
    builder = OverviewBuilder()
    if from_s <= to_s:
        for numbers, rows in all_rows(recording, from_s, to_s):
            builder.take(numbers, rows)
    return builder.blocks()


def _starts(count: int, gaps: NDArray[np.intp], runs: int) -> NDArray[np.intp]:
    """Return where at most `runs` runs of `count` rows begin, those of nothing counted: no run goes across a gap.

    Of more gaps than a quarter of the runs only so many are kept.
    """
    most = runs // 4
    if len(gaps) > most:
        gaps = gaps[np.linspace(0, len(gaps) - 1, most).astype(np.intp)]
    even = np.linspace(0, count, min(max(1, runs - 2 * len(gaps)), count) + 1)[:-1].astype(np.intp)
    return np.unique(np.concatenate([even, gaps]))


def _in_pairs(pairs: Numbers, begin_s: Numbers, end_s: Numbers, after_gap: NDArray[np.bool_], of: int) -> Drawn:
    """Return pairs with the times of their runs, and a pair of NaN before each run that samples are missing before."""
    time = np.empty(2 * len(begin_s))
    time[0::2], time[1::2] = begin_s, 0.5 * (begin_s + end_s)
    at = np.flatnonzero(after_gap)
    places = np.repeat(2 * at, 2)
    last_s = np.repeat(end_s[at - 1], 2)
    missing = np.full((len(places), pairs.shape[1]), np.nan)
    return Drawn(np.insert(time, places, last_s), np.insert(pairs, places, missing, axis=0), False, of)
