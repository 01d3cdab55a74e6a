"""The files of a batch: what is damaged is found and named, and never taken for a part."""

from pathlib import Path

import pytest

from backend.batch import result_jobs
from backend.batch.engine import PartFiles
from backend.batch.folder import BatchFolder, Division
from backend.batch.part_files import parquet


@pytest.fixture
def folder(tmp_path: Path) -> BatchFolder:
    """A folder with three parts of two runs each."""
    made = BatchFolder(tmp_path / "batch")
    made.create("{}", Division(2, "a version"))
    for number in range(3):
        rows = parquet({"run": [2 * number, 2 * number + 1], "state": ["done", "ended"]})
        made.keep(number, PartFiles(rows, parquet({"run": [2 * number], "time": [0.0]}), {"done": 1, "ended": 1}))
    return made


def cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-10])


def test_how_it_is_divided_is_kept(folder: BatchFolder) -> None:
    assert folder.division() == Division(2, "a version")
    (folder.path / "parts.json").write_text("[")
    assert folder.division() is None


@pytest.mark.parametrize("kind", ["part", "trajectories"])
def test_a_part_that_cannot_be_read_is_found_by_its_number_and_may_be_put_aside(folder: BatchFolder, kind: str) -> None:
    cut(folder.path / f"{kind}-00001.parquet")
    whole = {"done": 1, "ended": 1}
    assert result_jobs.counts_by_part(str(folder.path)) == {0: whole, 1: None, 2: whole}
    folder.put_aside(1)
    assert folder.parts() == [0, 2]
    assert len(folder.trajectories()) == 2
    assert len([*folder.path.glob("*.damaged")]) == 2


def test_reading_a_damaged_part_names_the_file_and_what_to_do(folder: BatchFolder, tmp_path: Path) -> None:
    path = str(folder.path)
    cut(folder.rows_of(1))
    words = "the file part-00001.parquet of this batch's results is damaged; resume the batch"
    for read in (
        lambda: result_jobs.page(path, 0, 10, None),
        lambda: result_jobs.row(path, 2, 1),
        lambda: result_jobs.export(path, "results", "csv", str(tmp_path)),
    ):
        with pytest.raises(ValueError, match=words):
            read()
    assert result_jobs.row(path, 4, 2) == {"run": 4, "state": "done"}
    assert [file.name for file in tmp_path.iterdir()] == ["batch"]


def test_begun_anew_it_has_its_document_alone(folder: BatchFolder) -> None:
    folder.begin_anew(Division(4, "another version"))
    assert sorted(file.name for file in folder.path.iterdir()) == ["batch.json", "parts.json"]
    assert folder.division() == Division(4, "another version")
