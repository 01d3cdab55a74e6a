"""The overview of a recording: least and greatest value of every 256 samples, made once and kept beside the recordings.

A wide span is drawn from it instead of from millions of samples. One that was made of a recording that has grown since is
gone on with, as a recording only ever grows at its end.
"""

import contextlib
import os
import re
import tempfile
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from backend.recordings.layout import FIELD_INDEX, FIELDS, values_of
from backend.recordings.reader import ANOTHER_INSTANT_S, Recording
from backend.recordings.thinning import extremes

BLOCK = 256
KEPT = 50
ROWS_AT_ONCE = 64 * BLOCK
WIDTH = len(FIELDS)
BLOCKS = np.dtype(
    [
        ("count", "<i8"), ("gap_before", "?"), ("begin_s", "<f8"), ("end_s", "<f8"), ("last_number", "<i8"),
        ("low", "<f4", (WIDTH,)), ("high", "<f4", (WIDTH,)), ("low_first", "?", (WIDTH,)),
    ]
)  # fmt: skip
"""One block: consecutive samples, none missing between them, and whether samples are missing before them."""
Blocks = NDArray[np.void]


class OverviewBuilder:
    """Takes samples in order; `blocks` has the overview of all of them."""

    def __init__(self, before: Blocks | None = None) -> None:
        self._done = [] if before is None else [before]
        self._last = int(before["last_number"][-1]) if before is not None and len(before) else None
        self._numbers, self._rows = np.empty(0, np.int64), np.empty((0, WIDTH))

    def take(self, numbers: NDArray[np.int64], rows: NDArray[np.float64]) -> None:
        """Take rows (n, fields) and their sample numbers (n,)."""
        self._numbers = np.concatenate([self._numbers, numbers])
        self._rows = np.concatenate([self._rows, rows])
        self._make(is_end=False)

    def blocks(self) -> Blocks:
        """Return the blocks, the last of which may be short."""
        self._make(is_end=True)
        return np.concatenate(self._done) if self._done else np.empty(0, BLOCKS)

    def _make(self, is_end: bool) -> None:
        numbers, rows = self._numbers, self._rows
        if not len(rows):
            return
        before = numbers[0] - 1 if self._last is None else self._last
        gaps = np.flatnonzero(np.diff(numbers, prepend=before) % 2**32 != 1)
        pieces = np.unique(np.concatenate([[0], gaps, [len(rows)]]))
        starts = np.concatenate([np.arange(a, b, BLOCK) for a, b in pairwise(pieces)])
        stop = len(rows) if is_end or len(rows) - starts[-1] == BLOCK else int(starts[-1])
        starts = starts[starts < stop]
        if not len(starts):
            return
        found = extremes(rows[:stop], starts)
        made = np.empty(len(starts), BLOCKS)
        ends = np.append(starts[1:], stop) - 1
        made["count"] = ends + 1 - starts
        made["gap_before"] = np.isin(starts, gaps)
        made["begin_s"], made["end_s"] = rows[starts, FIELD_INDEX["time"]], rows[ends, FIELD_INDEX["time"]]
        made["last_number"] = numbers[ends]
        with np.errstate(over="ignore"):
            made["low"], made["high"], made["low_first"] = found.low, found.high, found.low_first
        self._done.append(made)
        self._last = int(numbers[stop - 1])
        self._numbers, self._rows = numbers[stop:], rows[stop:]


def all_rows(
    recording: Recording, from_s: float = -np.inf, to_s: float = np.inf
) -> Iterator[tuple[NDArray[np.int64], NDArray[np.float64]]]:
    """Yield sample numbers (n,) and rows (n, fields) of a span, piece by piece."""
    numbers: list[NDArray[np.int64]] = []
    rows: list[NDArray[np.float64]] = []
    count = 0
    for messages in recording.blocks(from_s, to_s):
        numbers.append(messages["sequence"].astype(np.int64))
        rows.append(values_of(messages))
        count += len(messages)
        if count >= ROWS_AT_ONCE:
            yield np.concatenate(numbers), np.concatenate(rows)
            numbers, rows, count = [], [], 0
    if count:
        yield np.concatenate(numbers), np.concatenate(rows)


def overview(recording: Recording, cache: Path) -> Blocks:
    """Return the overview of a recording: kept in the folder `cache`, gone on with, or made."""
    kept, others = _kept(recording, cache)
    if kept.exists():
        with contextlib.suppress(OSError, ValueError):
            return np.load(kept)
    before = _begun(others)
    builder = OverviewBuilder(before)
    since_s = -np.inf if before is None else before["end_s"][-1] + ANOTHER_INSTANT_S
    for numbers, rows in all_rows(recording, since_s):
        builder.take(numbers, rows)
    blocks = builder.blocks()
    keep(recording, cache, blocks)
    return blocks


def keep(recording: Recording, cache: Path, blocks: Blocks) -> None:
    """Keep an overview for the next time; a disk that refuses costs that time only."""
    kept, others = _kept(recording, cache)
    with contextlib.suppress(OSError):
        cache.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=cache, suffix=".part", delete=False) as file:
            np.save(file, blocks)
        os.replace(file.name, kept)  # noqa: PTH105 - the name came as text
        for other in others:
            other.unlink(missing_ok=True)
        by_age = sorted(cache.glob("*.npy"), key=lambda each: each.stat().st_mtime)
        for old in by_age[:-KEPT]:
            old.unlink(missing_ok=True)


def _kept(recording: Recording, cache: Path) -> tuple[Path, list[Path]]:
    """Return where the overview of a recording as it was opened is kept, and those of what it was before."""
    status = recording.status
    file = f"{recording.path.stem}@{status.st_ino}"
    kept = cache / f"{file}@{status.st_size}@{status.st_mtime_ns}.npy"
    pattern = re.compile(rf"{re.escape(file)}@(\d+)@\d+\.npy")
    others = [
        each
        for each in (cache.iterdir() if cache.is_dir() else ())
        if (found := pattern.fullmatch(each.name)) and each != kept and int(found[1]) <= status.st_size
    ]
    return kept, others


def _begun(others: list[Path]) -> Blocks | None:
    """Return the whole blocks of the longest overview of an earlier state."""
    for other in sorted(others, key=lambda each: -each.stat().st_size):
        with contextlib.suppress(OSError, ValueError):
            blocks: Blocks = np.load(other)
            if len(blocks) > 1:
                return blocks[:-1]
    return None
