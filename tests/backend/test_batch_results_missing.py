"""What is said of results that are not there: why there are none, and which parts of a batch that is done are missing."""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.ipc
import pyarrow.parquet as pq
import pytest

from backend.batch.catalogue import FACTS, Row
from backend.batch.engine import PartFiles
from backend.batch.folder import BatchFolder, Division
from backend.batch.listed import whole_parts, why_none
from backend.batch.part_files import parquet
from backend.batch.result_jobs import export, page, row


def row_of(state: str, trajectories: str = "none") -> Row:
    return Row("id", "name", None, "", state, "", 40, 4, FACTS | {"trajectories": trajectories})


@pytest.fixture
def folder(tmp_path: Path) -> str:
    """A folder of ten parts of four runs, of which parts 2 to 8 are missing."""
    batch = BatchFolder(tmp_path)
    for number in (0, 1, 9):
        rows = {"run": np.arange(4 * number, 4 * number + 4), "state": ["done"] * 4}
        batch.keep(number, PartFiles(parquet(rows), b"", {}))
    return str(tmp_path)


def test_results_of_a_batch_that_is_done_name_the_parts_that_are_missing(folder: str, tmp_path: Path) -> None:
    parts = whole_parts(row_of("done"))
    words = r"of the 10 parts .* 7 are missing \(2, 3, 4, 5, 6 and 2 more\); resume the batch"
    with pytest.raises(ValueError, match=words):
        page(folder, 0, 10, None, parts)
    with pytest.raises(ValueError, match=words):
        row(folder, 9, 2, parts)
    for what in ("results", "trajectories"):
        with pytest.raises(ValueError, match=words):
            export(folder, what, "parquet", str(tmp_path), parts)


@pytest.mark.parametrize("state", ["queued", "running", "cancelled", "failed"])
def test_results_of_any_other_batch_are_those_that_are_there(folder: str, tmp_path: Path, state: str) -> None:
    parts = whole_parts(row_of(state))
    assert b'"total": 12' in page(folder, 0, 10, None, parts)
    assert row(folder, 9, 2, parts) is None
    assert Path(export(folder, "results", "parquet", str(tmp_path), parts)[1]).exists()


@pytest.mark.parametrize(
    ("state", "trajectories", "what", "words"),
    [
        ("running", "ended", "trajectories", "there are no trajectories yet; wait for the first part that has any"),
        ("queued", "none", "results", "there are no results yet; wait"),
        ("done", "ended", "trajectories", "no run of this batch ended early, so no samples were kept"),
        ("done", "all", "trajectories", "no run of this batch could start, so no samples were kept"),
        ("cancelled", "none", "results", "was cancelled before a part was kept; resume it"),
        ("failed", "all", "trajectories", "failed before a part that kept any samples; resume it"),
    ],
)
def test_why_there_is_nothing_is_told_by_what_became_of_the_batch(
    tmp_path: Path, state: str, trajectories: str, what: str, words: str
) -> None:
    none = why_none(row_of(state, trajectories), what)
    with pytest.raises(ValueError, match=words):
        export(str(tmp_path), what, "parquet", str(tmp_path), 0, none)


@pytest.mark.parametrize("what", ["results", "trajectories"])
def test_a_file_says_which_batch_and_version_it_is_of(tmp_path: Path, what: str) -> None:
    batch = BatchFolder(tmp_path / "batch")
    batch.create('{"name": "mine"}', Division(4, "a version"))
    table = parquet({"run": np.arange(4), "state": ["done"] * 4})
    batch.keep(0, PartFiles(table, table, {}))
    for form, read in (("parquet", pq.read_table), ("arrow", lambda path: pa.ipc.open_stream(path).read_all())):
        found = read(export(str(batch.path), what, form, str(tmp_path))[1])
        assert found.schema.metadata == {b"vssea.batch": b'{"name": "mine"}', b"vssea.version": b"a version"}
        assert found["run"].to_pylist() == [0, 1, 2, 3]
    batch.document_path.unlink()
    assert pq.read_schema(export(str(batch.path), what, "parquet", str(tmp_path))[1]).metadata == {
        b"vssea.version": b"a version"
    }
