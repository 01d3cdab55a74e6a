"""A rig's own log as a recording: columns by their headings or by a mapping, times as they are, what is missing is NaN."""

from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from backend.recordings.csv_table import DELIMITERS, TextTable, text_table
from backend.recordings.csv_units import PER_TIME, factor_of, guessed, split_heading, units_for
from backend.recordings.layout import COLUMNS_KEPT, FIELD_INDEX
from backend.recordings.whole_file import whole_file
from backend.telemetry.ring import COLUMNS, EPOCH, PERIOD_S
from vssea_core.channels import INDEX

CHUNK = 1000
LARGEST_TIME_S = 1e5
"""A log whose times begin later, such as at the seconds since 1970, is shifted to begin at 0."""
SECONDS_SINCE_1970 = 1e9
"""Times from here on are taken for the time of day."""
EVEN = 0.01
"""Times are even if they differ by no more than this share of their distance."""
Document = dict[str, Any]
Mapping = dict[str, dict[str, Any]]


@dataclass(frozen=True)
class Column:
    """One column that is read: value = cell * factor + offset, in the channel's own unit."""

    heading: str
    channel: str
    unit: str
    factor: float
    offset: float
    guessed: bool


def csv_preview(path: Path, mapping: Mapping | None = None, sample_rate_hz: float | None = None) -> Document:
    """Return what an import would read. Raises ValueError with one sentence for whatever would be refused."""
    table = text_table(path)
    columns = _columns(table, mapping or {})
    time, shift_s = _times(table, columns, sample_rate_hz)
    for column in columns:
        table.numbers(column.heading)
    used = {column.heading for column in columns}
    steps = np.diff(time)
    return {
        "rows": len(table), "delimiter": DELIMITERS[table.delimiter], "decimal": "comma" if table.decimal_comma else "point",
        "from_s": float(time[0]), "to_s": float(time[-1]), "period_s": _period(time), "shift_s": shift_s,
        "even": bool(len(steps) == 0 or np.ptp(steps) <= EVEN * _period(time)),
        "columns": [vars(column) for column in columns], "derived": _derived(columns),
        "ignored": [heading for heading in table.headings if heading not in used],
    }  # fmt: skip


def csv_import(
    path: Path,
    target: Path,
    head: dict[str, str],
    mapping: Mapping | None = None,
    sample_rate_hz: float | None = None,
) -> Path:
    """Write the log at `path` as the recording `target`, with `head` as its metadata. Raises ValueError and writes nothing."""
    table = text_table(path)
    columns = _columns(table, mapping or {})
    time, shift_s = _times(table, columns, sample_rate_hz)
    values = {column.channel: _scaled(table, column) for column in columns if column.channel != "time"}
    if _derived(columns):
        values["error"] = values["reference"] - values["link_position"]
    period_s = _period(time)
    if shift_s > SECONDS_SINCE_1970:
        head = head | {"begun_at": datetime.fromtimestamp(shift_s, UTC).isoformat(timespec="milliseconds")}
    more = {"origin": "import", "begin_ns": "0", "first_sample": "0", "part": "1", "sample_time_s": repr(period_s)}
    with whole_file(target, head | more, "imported") as file:
        for first in range(0, len(time), CHUNK):
            part = slice(first, first + CHUNK)
            samples = np.full((len(time[part]), COLUMNS), np.nan)
            samples[:, EPOCH], samples[:, PERIOD_S] = 1.0, period_s
            samples[:, INDEX["time"]] = time[part]
            for channel, column in values.items():
                samples[:, COLUMNS_KEPT[FIELD_INDEX[channel]]] = column[part]
            file.append_samples(samples, first)
    return target


def _columns(table: TextTable, mapping: Mapping) -> list[Column]:
    """Return the columns that are read: those of the mapping as it says, the others as their headings say."""
    unknown = [heading for heading in mapping if heading not in table.headings]
    if unknown:
        raise ValueError(f"there is no column {unknown[0]!r}; the headings are {', '.join(table.headings)}")
    columns = [
        column
        for heading in table.headings
        if (column := _mapped(heading, mapping[heading]) if heading in mapping else _guess(heading)) is not None
    ]
    taken: dict[str, str] = {}
    for column in columns:
        if column.channel in taken:
            raise ValueError(
                f"the columns {taken[column.channel]!r} and {column.heading!r} both are {column.channel}; "
                "give one of them another channel, or null, in the mapping of columns"
            )
        taken[column.channel] = column.heading
    if not set(taken) - {"time"}:
        raise ValueError(
            f"none of the headings {', '.join(table.headings)} is a channel; expected name [unit] as in GET /api/schema, "
            'or a mapping such as {"q1": {"channel": "link_position", "factor": 0.01745}}'
        )
    return columns


def _guess(heading: str) -> Column | None:
    channel, unit, factor = guessed(heading)
    if channel is None:
        return None
    if factor is None:
        raise ValueError(_unknown_unit(heading, channel))
    return Column(heading, channel, unit, factor, 0.0, guessed=True)


def _mapped(heading: str, asked: dict[str, Any]) -> Column | None:
    channel = asked.get("channel")
    unknown = sorted(set(asked) - {"channel", "factor", "offset"})
    if unknown:
        raise ValueError(f"{heading!r} has an unknown {unknown[0]!r}; expected channel, factor and offset")
    if channel is None:
        return None
    if channel not in FIELD_INDEX:
        raise ValueError(f"{heading!r} is mapped to {channel!r}, which is no channel; known: {', '.join(FIELD_INDEX)}")
    unit = split_heading(heading)[1]
    factor: Any = asked.get("factor")
    offset: Any = asked.get("offset", 0.0)
    if factor is None:
        factor = factor_of(unit, channel)
    if factor is None:
        raise ValueError(_unknown_unit(heading, channel))
    for name, value in (("factor", factor), ("offset", offset)):
        is_number = isinstance(value, (int, float)) and not isinstance(value, bool) and np.isfinite(value)
        if not is_number:
            raise ValueError(
                f"the {name} of {heading!r} is {value!r}; expected a number that turns it into {channel}'s unit"
            )
    return Column(heading, channel, unit, float(factor), float(offset), guessed=False)


def _unknown_unit(heading: str, channel: str) -> str:
    return (
        f"the unit of {heading!r} is not one of {units_for(channel)}; give its factor in the mapping of columns: "
        f'{{"{heading}": {{"channel": "{channel}", "factor": ...}}}}'
    )


def _scaled(table: TextTable, column: Column) -> NDArray[np.float64]:
    values = table.numbers(column.heading)
    if column.factor != 1.0:
        values = values * column.factor
    return values + column.offset if column.offset != 0.0 else values


def _times(table: TextTable, columns: list[Column], sample_rate_hz: float | None) -> tuple[NDArray[np.float64], float]:
    """Return rising times (n,) [s] and what was taken off them."""
    column = next((each for each in columns if each.channel == "time"), None)
    if sample_rate_hz is not None:
        if not 0.0 < sample_rate_hz <= 1e6:
            raise ValueError(f"the sample rate is {sample_rate_hz:g} Hz; expected above 0 to 1e6 Hz")
        return np.arange(len(table)) / sample_rate_hz, 0.0
    if column is None:
        raise ValueError(
            f"no column is the time; expected a heading such as time [s] or t [{', '.join(list(PER_TIME)[1:3])}], "
            "or a sample rate"
        )
    time = _scaled(table, column)
    wrong = ~np.isfinite(time)
    wrong[1:] |= np.diff(time) <= 0.0
    if wrong.any():
        row = int(np.flatnonzero(wrong)[0])
        found = "is missing" if not np.isfinite(time[row]) else f"{time[row]:g} s is not after {time[row - 1]:g} s"
        raise ValueError(
            f"line {table.first_row + row}, column {column.heading!r}: the time {found}; expected times that rise with each row"
        )
    shift_s = float(time[0]) if time[0] > LARGEST_TIME_S or time[0] < 0.0 else 0.0
    return (time - shift_s if shift_s else time), shift_s


def _period(time: NDArray[np.float64]) -> float:
    return float(np.median(np.diff(time))) if len(time) > 1 else 0.0


def _derived(columns: list[Column]) -> list[str]:
    have = {column.channel for column in columns}
    return ["error"] if {"reference", "link_position"} <= have and "error" not in have else []
