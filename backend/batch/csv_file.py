"""Tables as CSV files: a float shows that it is one, so that readers that guess a column's type from its first rows guess right."""

from collections.abc import Iterable
from pathlib import Path

import pyarrow as pa
import pyarrow.compute as pc

AT_A_TIME = 10_000
"""Rows that are made into text at a time."""
EMPTY = '""'
SHOWS_A_FLOAT = "[.en]"  # point, exponent, inf
NEEDS_QUOTES = '^$|[",\r\n]'


def write_csv(path: str, names: list[str], tables: Iterable[pa.Table]) -> None:
    """Write a line of headings and one for each row; floats read back to the same bits, nan and null are empty. Raises OSError."""
    with Path(path).open("wb") as file:
        file.write(f"{','.join(_quoted(pa.array(names)).to_pylist())}\n".encode())
        for table in tables:
            for rows in table.to_batches(AT_A_TIME):
                file.write(_lines(rows))


def _lines(rows: pa.RecordBatch) -> bytes:
    texts = [_text(column) for column in rows.columns]
    if len(texts) == 1:  # readers skip a line with nothing in it
        texts = [pc.if_else(pc.equal(texts[0], ""), EMPTY, texts[0])]
    return "".join(f"{line}\n" for line in pc.binary_join_element_wise(*texts, ",").to_pylist()).encode()


def _text(column: pa.Array) -> pa.Array:
    if pa.types.is_string(column.type):
        text = _quoted(column)
    elif pa.types.is_floating(column.type):
        text = column.cast(pa.string())
        if pc.any(pc.equal(pc.trunc(column), column)).as_py():
            shown = pc.match_substring_regex(text, SHOWS_A_FLOAT)
            text = pc.if_else(shown, text, pc.binary_join_element_wise(text, ".0", ""))
        text = pc.if_else(pc.is_nan(column), "", text)
    else:
        text = column.cast(pa.string())
    return text.fill_null("")


def _quoted(texts: pa.Array) -> pa.Array:
    doubled = pc.binary_join_element_wise('"', pc.replace_substring(texts, '"', '""'), '"', "")
    return pc.if_else(pc.match_substring_regex(texts, NEEDS_QUOTES), doubled, texts)
