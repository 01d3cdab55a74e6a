"""A recording taken home: CSV with units, Parquet with everything that belongs to it, a span of it, or its figures as JSON."""

import json
import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet

from backend.recordings.layout import FIELD_INDEX, FIELDS, values_of
from backend.recordings.metrics_by_blocks import MetricsByBlocks
from backend.recordings.overview import all_rows
from backend.recordings.reader import Recording
from backend.recordings.span_file import write_span
from backend.recordings.summary import facts
from backend.recordings.timeline import commands, events, scenario_document, tunings
from backend.telemetry.ring import WIDTH

ROWS_AT_ONCE = 100_000
"""Rows of a row group, and of what is in memory at a time."""
MEDIA_TYPES = {
    "csv": "text/csv; charset=utf-8",
    "parquet": "application/vnd.apache.parquet",
    "json": "application/json",
    "mcap": "application/x-mcap",
}
WHOLE_ROWS = ("json", "mcap")
Tell = Callable[[float, str], object]


def export(
    recording: Recording,
    form: str,
    channels: list[str] | None,
    from_s: float,
    to_s: float,
    folder: str,
    tell: Tell | None = None,
) -> tuple[str, str]:
    """Return media type and path of a new file in `folder`: form csv, parquet, json or mcap. All channels if none is named.

    Raises ValueError for another form, an unknown channel, or a span without samples.
    """
    if form not in MEDIA_TYPES:
        raise ValueError(f"form is {form!r}; expected one of {', '.join(MEDIA_TYPES)}")
    if form in WHOLE_ROWS and channels:
        raise ValueError(f"a {form} export has all channels; expected none to be named, or form csv or parquet")
    names = _named(channels)
    with tempfile.NamedTemporaryFile(dir=folder, suffix=f".{form}", delete=False) as file:
        path = file.name
    with ExitStack() as undo:
        undo.callback(os.unlink, path)
        if form == "json":
            told = _document(recording, from_s, to_s)
            Path(path).write_text(json.dumps(told, ensure_ascii=False, allow_nan=False), "utf-8")
        elif form == "mcap":
            write_span(recording, from_s, to_s, Path(path))
        else:
            tables = _tables(recording, names, from_s, to_s, tell or (lambda share, words: None))
            (_write_csv if form == "csv" else _write_parquet)(path, _schema(recording, names), tables)
        undo.pop_all()
    return MEDIA_TYPES[form], path


def heading(name: str) -> str:
    """Return a channel's heading in a CSV: its name and its unit in brackets."""
    unit = FIELDS[FIELD_INDEX[name]].unit
    return f"{name} [{unit}]" if unit else name


def _named(channels: list[str] | None) -> list[str]:
    names = channels or list(FIELD_INDEX)
    unknown = [name for name in names if name not in FIELD_INDEX]
    if unknown:
        raise ValueError(f"a recording has no channel {unknown[0]!r}; known: {', '.join(FIELD_INDEX)}")
    return names if "time" in names else ["time", *names]


def _tables(recording: Recording, names: list[str], from_s: float, to_s: float, tell: Tell) -> Iterator[np.ndarray]:
    """Yield rows (n, names) of the span, at most some more than ROWS_AT_ONCE at a time. Raises ValueError if there are none."""
    columns = [FIELD_INDEX[name] for name in names]
    total = max(1, recording.count(from_s, to_s))
    waiting: list[np.ndarray] = []
    count = done = 0
    for messages in recording.blocks(from_s, to_s):
        waiting.append(values_of(messages)[:, columns])
        count += len(messages)
        if count >= ROWS_AT_ONCE:
            yield np.concatenate(waiting)
            done, count, waiting = done + count, 0, []
            tell(min(1.0, done / total), f"{done} of {total} samples")
    if count:
        yield np.concatenate(waiting)
    elif not done:
        low, high = recording.span
        raise ValueError(
            f"there are no samples from {from_s:g} to {to_s:g} s; this recording goes from {low:g} to {high:g} s"
        )


def _schema(recording: Recording, names: list[str]) -> pa.Schema:
    fields = []
    for name in names:
        field = FIELDS[FIELD_INDEX[name]]
        about = {"unit": field.unit or "1", "symbol": field.symbol, "label": field.label}
        fields.append(pa.field(name, pa.float64(), nullable=False, metadata=about))
    of_file: dict[str, object] = {
        "vssea.recording": recording.head, "vssea.scenario": scenario_document(recording), "vssea.changes": tunings(recording),
        "vssea.events": events(recording), "vssea.commands": commands(recording),
    }  # fmt: skip
    return pa.schema(fields, metadata={key: json.dumps(value, ensure_ascii=False) for key, value in of_file.items()})


def _table(rows: np.ndarray, schema: pa.Schema) -> pa.Table:
    return pa.table([pa.array(np.ascontiguousarray(column)) for column in rows.T], schema=schema)


def _write_parquet(path: str, schema: pa.Schema, tables: Iterator[np.ndarray]) -> None:
    with pa.parquet.ParquetWriter(path, schema, compression="zstd", use_dictionary=False) as writer:
        for rows in tables:
            writer.write_table(_table(rows, schema), row_group_size=len(rows))


def _write_csv(path: str, schema: pa.Schema, tables: Iterator[np.ndarray]) -> None:
    plain = pa.csv.WriteOptions(include_header=False)
    with Path(path).open("wb") as file:
        file.write((",".join(heading(name) for name in schema.names) + "\n").encode())
        for rows in tables:
            pa.csv.write_csv(_table(rows, schema), file, plain)


def _document(recording: Recording, from_s: float, to_s: float) -> dict[str, object]:
    figures, count, times = MetricsByBlocks(), 0, (0.0, 0.0)
    for _, rows in all_rows(recording, from_s, to_s):
        figures.take(rows[:, :WIDTH])
        times = (float(rows[0, 0]) if count == 0 else times[0]), float(rows[-1, 0])
        count += len(rows)
    span = {"from_s": times[0], "to_s": times[1], "duration_s": times[1] - times[0], "samples": count}
    return {
        "facts": facts(recording) | span, "metrics": figures.metrics(), "scenario": scenario_document(recording),
        "final": scenario_document(recording, np.inf), "changes": tunings(recording), "events": events(recording),
        "commands": commands(recording),
    }  # fmt: skip
