"""A table of numbers from a text file of any delimiter, parsed by pyarrow; a bad cell is named by its row and its column."""

import csv
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.csv
from numpy.typing import NDArray

DELIMITERS = {";": "semicolon", "\t": "tab", ",": "comma", "|": "bar", " ": "space"}
NOTHING = ["", "nan", "NaN", "NAN", "-nan", "NA", "N/A", "null", "-"]
NUMBER = r"^[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?$|^[+-]?(inf|Inf|INF|infinity|Infinity)$"
LINES_LOOKED_AT = 20


@dataclass(frozen=True)
class TextTable:
    """A table as text: `headings` in order, `columns` of strings, `first_row` the line of the file its first row stands on."""

    headings: list[str]
    columns: Any
    first_row: int
    delimiter: str
    decimal_comma: bool

    def __len__(self) -> int:
        return int(self.columns.num_rows)

    def numbers(self, heading: str) -> NDArray[np.float64]:
        """Return a column (n,); an empty cell is NaN. Raises ValueError naming row and column of what is no number."""
        texts = pc.utf8_trim_whitespace(self.columns.column(self.headings.index(heading)).combine_chunks())
        if self.decimal_comma:
            texts = pc.replace_substring(texts, ",", ".")
        is_number = pc.fill_null(pc.match_substring_regex(texts, NUMBER), True)
        if not pc.all(is_number, min_count=0).as_py():
            bad = pc.index(is_number, False).as_py()
            raise ValueError(
                f"line {self.first_row + bad}, column {heading!r}: {_cut(texts[bad].as_py())} is not a number; "
                "expected one, or an empty cell"
            )
        return np.asarray(pc.fill_null(pc.cast(texts, pa.float64()), float("nan")).to_numpy(zero_copy_only=False))


def text_table(path: Path) -> TextTable:
    """Read a file; lines before the headings that are empty or begin with # are passed over.

    Raises ValueError for a file without headings and rows, or with a row of another length.
    """
    lines, encoding = _first_lines(path)
    skipped = next(
        (n for n, line in enumerate(lines) if line.strip() and not line.lstrip().startswith("#")), len(lines)
    )
    shown = lines[skipped:]
    if len(shown) < 2:
        raise ValueError("the file has no rows; expected a line of headings and rows of numbers below it")
    delimiter = _delimiter(shown)
    headings = [heading.strip() for heading in next(csv.reader([shown[0]], delimiter=delimiter, skipinitialspace=True))]
    double = {heading for heading in headings if headings.count(heading) > 1}
    if double:
        raise ValueError(f"the heading {sorted(double)[0]!r} stands twice; expected a name of its own for each column")
    if all(_is_number(heading) for heading in headings):
        raise ValueError(
            f"the first line, {_cut(shown[0].strip())}, is numbers; expected headings such as time [s], link_position [deg]"
        )
    columns = _read(path, encoding, delimiter, headings, skipped + 1)
    comma = delimiter != "," and any("," in cell for line in shown[1:] for cell in line.split(delimiter))
    return TextTable(headings, columns, skipped + 2, delimiter, comma)


def _read(path: Path, encoding: str, delimiter: str, headings: list[str], skipped: int) -> Any:
    uneven: list[Any] = []

    def refuse(row: Any) -> str:
        uneven.append(row)
        return "error"

    try:
        return pa.csv.read_csv(
            path,
            pa.csv.ReadOptions(use_threads=False, column_names=headings, skip_rows=skipped, encoding=encoding),
            pa.csv.ParseOptions(delimiter=delimiter, invalid_row_handler=refuse),
            pa.csv.ConvertOptions(
                column_types=dict.fromkeys(headings, pa.string()), strings_can_be_null=True, null_values=NOTHING
            ),
        )
    except pa.ArrowInvalid as error:
        if not uneven:
            raise ValueError(f"the file cannot be read as a table: {error}") from error
        row = uneven[0]
        line = f"line {row.number}" if row.number is not None else f"the line {_cut(row.text)}"
        raise ValueError(
            f"{line} has {row.actual_columns} cells and the headings are {row.expected_columns}; expected as many of both"
        ) from error


def _first_lines(path: Path) -> tuple[list[str], str]:
    with path.open("rb") as file:
        begin = file.read(1 << 16)
    for encoding in ("utf-8-sig", "latin-1"):
        try:
            text = begin.decode(encoding) if len(begin) < 1 << 16 else begin.rpartition(b"\n")[0].decode(encoding)
        except UnicodeDecodeError:
            continue
        return text.splitlines()[:LINES_LOOKED_AT], encoding.removesuffix("-sig")
    raise ValueError("the file is not text")


def _delimiter(lines: list[str]) -> str:
    """Return the delimiter that cuts the headings and the rows below into the same number of cells, at least two."""
    for delimiter in DELIMITERS:
        counts = {
            len(next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))) for line in lines if line.strip()
        }
        if len(counts) == 1 and counts != {1}:
            return delimiter
    by_heading = max(DELIMITERS, key=lines[0].count)  # an uneven row is refused by its number later
    return by_heading if by_heading in lines[0] else ","


def _is_number(text: str) -> bool:
    try:
        float(text.replace(",", "."))
    except ValueError:
        return False
    return True


def _cut(text: str) -> str:
    return repr(text if len(text) <= 40 else text[:37] + "...")
