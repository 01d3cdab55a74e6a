"""What reads the results of batches: pages, rows, whole files, from the parts that are there. Needs no compiler."""

import json
import math
import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from functools import lru_cache
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.ipc
import pyarrow.parquet as pq

from backend.batch.csv_file import write_csv
from backend.batch.folder import BatchFolder

LONG: frozenset[str] = frozenset()
TOLD_PARTS = 5
MEDIA_TYPES = {
    "parquet": "application/vnd.apache.parquet",
    "csv": "text/csv; charset=utf-8",
    "arrow": "application/vnd.apache.arrow.stream",
}


def counts_by_part(folder: str) -> dict[int, dict[str, int] | None]:
    """Return the runs by state of each part that is there, None for one that cannot be read."""
    batch = BatchFolder(Path(folder))
    return {number: _counts(batch, number) for number in batch.parts()}


def page(folder: str, offset: int, limit: int, columns: list[str] | None, parts: int = 0) -> bytes:
    """Return rows `offset` to `offset + limit` of those that are there, as JSON.

    Raises ValueError for an unknown column, and if there are less than `parts`.
    """
    _check_whole(folder, parts)
    total, names, rows = 0, columns, list[tuple[Any, ...]]()
    for path in _rows_in(folder):
        count = _count(path)
        first, last = max(0, offset - total), min(count, offset + limit - total)
        if first < last or names is None or total == 0:
            table = _read(path, columns)
            names = table.column_names
            rows += _listed(table.slice(first, max(0, last - first)))
        total += count
    answer = {"offset": offset, "total": total, "columns": names or [], "rows": rows}
    return json.dumps(answer, ensure_ascii=False, allow_nan=False).encode()


def row(folder: str, run: int, part: int, parts: int = 0) -> dict[str, Any] | None:
    """Return the row of a run by column, None if its part is not there yet. Raises ValueError if there are less than `parts`."""
    path = BatchFolder(Path(folder)).rows_of(part)
    if not path.exists():
        _check_whole(folder, parts)
        return None
    with _told(path):
        table = pq.read_table(path, filters=[("run", "=", run)])
    return dict(zip(table.column_names, _listed(table)[0], strict=True))


def export(
    folder: str, what: str, form: str, target: str, parts: int = 0, none: str = "there is nothing yet"
) -> tuple[str, str]:
    """Return media type and path, in the folder `target`, of all rows or trajectories, in the order of runs.

    Raises ValueError: with `none` if there is nothing, and if there are less than `parts`.
    """
    _check_whole(folder, parts)
    paths = _rows_in(folder) if what == "results" else BatchFolder(Path(folder)).trajectories()
    if not paths:
        raise ValueError(none)
    with tempfile.NamedTemporaryFile(dir=target, suffix=f".{form}", delete=False) as file:
        written = Path(file.name)
    try:
        with _told(paths[0]):
            schema = pq.read_schema(paths[0]).with_metadata(_origin(BatchFolder(Path(folder))))
        _write(form, schema, _tables(paths), str(written))
    except BaseException:
        written.unlink(missing_ok=True)
        raise
    return MEDIA_TYPES[form], str(written)


def _rows_in(folder: str) -> list[Path]:
    batch = BatchFolder(Path(folder))
    return [batch.rows_of(number) for number in batch.parts()]


def _origin(batch: BatchFolder) -> dict[str, str]:
    """Return what a file says of itself: the batch's document, and the version of the model; what is gone is left out."""
    document, division = None, batch.division()
    with suppress(OSError):
        document = batch.document()
    told = {"vssea.batch": document, "vssea.version": None if division is None else division.version}
    return {name: value for name, value in told.items() if value is not None}


def _check_whole(folder: str, parts: int) -> None:
    """Raise ValueError if parts of a batch that is done are missing."""
    if missing := sorted({*range(parts)}.difference(BatchFolder(Path(folder)).parts())):
        few = ", ".join(str(number) for number in missing[:TOLD_PARTS])
        more = f" and {len(missing) - TOLD_PARTS} more" if len(missing) > TOLD_PARTS else ""
        what = f"of the {parts} parts of this batch's results {len(missing)} are missing ({few}{more})"
        raise ValueError(f"{what}; resume the batch, and they are computed again")


def _counts(batch: BatchFolder, number: int) -> dict[str, int] | None:
    samples = batch.trajectories_of(number)
    try:
        if samples.exists():
            pq.read_metadata(samples)
        return dict(Counter(pq.read_table(batch.rows_of(number), columns=["state"])["state"].to_pylist()))
    except (pa.ArrowException, OSError, KeyError):
        return None


@lru_cache(100_000)
def _count(path: Path) -> int:
    """Return how many rows a part has; computed anew, it has as many."""
    with _told(path):
        return int(pq.read_metadata(path).num_rows)


def _tables(paths: Iterable[Path]) -> Iterator[pa.Table]:
    for path in paths:
        with _told(path):
            table = pq.read_table(path)
        yield table


def _read(path: Path, columns: list[str] | None) -> pa.Table:
    with _told(path):
        known = pq.read_schema(path).names
    unknown = [name for name in columns or () if name not in known]
    if unknown:
        raise ValueError(f"there is no column {unknown[0]!r}; known here: {', '.join(known)}")
    with _told(path):
        return pq.read_table(path, columns=columns)


@contextmanager
def _told(path: Path) -> Iterator[None]:
    """Say which file it is that cannot be read. Raises ValueError."""
    try:
        yield
    except (pa.ArrowException, OSError) as error:
        raise ValueError(
            f"the file {path.name} of this batch's results is damaged; resume the batch, and this part is computed again"
        ) from error


def _listed(table: pa.Table) -> list[tuple[Any, ...]]:
    columns = [[_plain(value) for value in column.to_pylist()] for column in table.columns]
    return list(zip(*columns, strict=True))


def _plain(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _write(form: str, schema: pa.Schema, tables: Iterable[pa.Table], path: str) -> None:
    if form == "csv":
        write_csv(path, schema.names, tables)
        return
    if form == "parquet":
        writer: Any = pq.ParquetWriter(path, schema, compression="zstd")
    else:
        writer = pyarrow.ipc.new_stream(path, schema)
    with writer:
        for table in tables:
            writer.write_table(table)
