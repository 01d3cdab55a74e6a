"""CSV files of results: readers find each column's type, and every float comes back to the same bits."""

import csv
import math
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv
from hypothesis import given
from hypothesis import strategies as st

from backend.batch.csv_file import write_csv

FLOATS = st.floats(width=64) | st.integers(-(2**60), 2**60).map(float)
TEXTS = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\x00"), max_size=8)


def written(folder: Path, table: pa.Table) -> list[list[str]]:
    path = folder / "table.csv"
    write_csv(str(path), table.column_names, [table[:1], table[1:]])
    with path.open(encoding="utf-8", newline="") as file:
        return [*csv.reader(file)]


@given(values=st.lists(FLOATS, min_size=1))
def test_a_float_shows_that_it_is_one_and_reads_back_to_the_same_bits(
    tmp_path_factory: object, values: list[float]
) -> None:
    folder = tmp_path_factory.getbasetemp()  # type: ignore[attr-defined]
    heading, *rows = written(folder, pa.table({"gain": values, "run": range(len(values))}))
    assert heading == ["gain", "run"]
    for value, (text, _) in zip(values, rows, strict=True):
        if math.isnan(value):
            assert text == ""
        else:
            assert set(text) & set(".en")
            assert float(text).hex() == value.hex()


@given(values=st.lists(st.floats(width=32, allow_nan=False), min_size=1))
def test_a_float_of_32_bits_is_no_longer_than_it_has_to_be(tmp_path_factory: object, values: list[float]) -> None:
    folder = tmp_path_factory.getbasetemp()  # type: ignore[attr-defined]
    _, *rows = written(folder, pa.table({"torque": pa.array(values, pa.float32())}))
    assert [np.float32(text).tobytes() for (text,) in rows] == [np.float32(value).tobytes() for value in values]
    assert all(len(text.lstrip("-").replace(".", "").split("e")[0].strip("0")) <= 9 for (text,) in rows)


@given(values=st.lists(TEXTS, min_size=1))
def test_a_text_comes_back_whatever_is_in_it(tmp_path_factory: object, values: list[str]) -> None:
    folder = tmp_path_factory.getbasetemp()  # type: ignore[attr-defined]
    table = pa.table({"reason": values, "state": values})
    assert written(folder, table) == [["reason", "state"], *([value, value] for value in values)]


def test_readers_find_the_type_of_each_column(tmp_path: Path) -> None:
    table = pa.table(
        {"run": [0, 1, 2], "gain": [10.0, math.nan, 0.5], "predict": [True, False, True], "kind": ["a", "b", ""]}
    )
    written(tmp_path, table)
    read = pyarrow.csv.read_csv(tmp_path / "table.csv")
    assert read.schema == table.schema
    assert read.to_pydict() == {**table.to_pydict(), "gain": [10.0, None, 0.5]}


def test_a_file_of_one_column_has_a_line_for_each_row(tmp_path: Path) -> None:
    for column in ([math.nan, 1.0], ["", "a"], [None, 1]):
        assert len(written(tmp_path, pa.table({"lone": column}))) == 3
        assert pyarrow.csv.read_csv(tmp_path / "table.csv").num_rows == 2
