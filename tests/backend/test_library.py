"""The library of recordings: stars are safe, the oldest go first, and trouble with the database costs no recording."""

import asyncio
from collections.abc import Callable, Coroutine, Iterator
from pathlib import Path
from typing import Any, TypeVar

import pytest
import sqlalchemy as sa

from backend.compute.pool import JobRefusedError
from backend.problem import Problem
from backend.recordings.catalogue import Catalogue
from backend.recordings.folder import recover
from backend.recordings.library import Library
from backend.recordings.reader import Recording
from backend.recordings.recorder import Recorder
from backend.recordings.recording_file import RecordingFile
from backend.settings import Settings
from backend.store.database import Database
from backend.store.tables import EXCERPTS
from tests.backend.recorded import samples

Result = TypeVar("Result")


class Jobs:
    """The worker's part, done at once."""

    def __init__(self) -> None:
        self.asked: list[tuple[str, str]] = []

    async def run(self, job: str, *arguments: Any, time_limit_s: float = 60.0) -> Any:
        path = Path(arguments[0])
        self.asked.append((job, path.stem))
        if job == "recover":
            try:
                return recover(path)
            except ValueError as refusal:
                raise JobRefusedError(str(refusal)) from refusal
        facts = {"scenario": "nominal", "started_at": path.stem, "samples": 500, "state": "complete", "origin": "live"}
        return {"facts": facts, "metrics": {"peak_error": 1.0}, "picture": None}


class Shelf:
    """A library on a folder of its own, and what it told."""

    def __init__(self, folder: Path, quota_gb: float = 10.0) -> None:
        self.settings = Settings(data_dir=folder, recordings_quota_gb=quota_gb)
        self.database = Database(self.settings.database_url)
        self.recorder = Recorder(self.settings)
        self.held: list[str | None] = []
        self.recorder.hold = self.held.append  # type: ignore[method-assign]
        self.jobs, self.notes, self.messages = Jobs(), list[str](), list[dict[str, Any]]()
        self.library = Library(self.settings, Catalogue(self.database), self.recorder, self.jobs)
        self.library.folder.mkdir(parents=True, exist_ok=True)

    def put(self, name: str, finished: bool = True) -> Path:
        file = RecordingFile.create(
            self.library.folder / f"{name}.mcap",
            {"id": name, "begin_ns": "0", "first_sample": "0", "part": "1", "scenario": "realistic", "begun_at": name},
        )
        file.append_samples(samples(500), 0)
        if finished:
            file.finish()
        file.close()
        return file.path

    def started(self, work: Callable[[Library], Coroutine[Any, Any, Result]]) -> Result:
        """Do something with the library while it is running."""

        async def run() -> Result:
            self.library.start(self.messages.append, lambda sentence, _: self.notes.append(sentence))
            try:
                return await work(self.library)
            finally:
                await self.library.stop()

        return asyncio.run(run())

    def names(self) -> list[str]:
        return sorted(path.stem for path in self.library.folder.glob("*.mcap"))


@pytest.fixture
def shelf(tmp_path: Path) -> Iterator[Shelf]:
    made = Shelf(tmp_path)
    yield made
    made.database.close()


async def _summaries(library: Library, count: int) -> list[dict[str, Any]]:
    while True:
        listed = (await library.list())["recordings"]
        if sum(entry["summary"] is not None for entry in listed) >= count:
            return list(listed)
        await asyncio.sleep(0)


def test_what_a_crash_left_open_is_finished_summarised_and_told(shelf: Shelf) -> None:
    shelf.put("a", finished=False)
    shelf.put("b")
    listed = shelf.started(lambda library: _summaries(library, 2))
    assert [entry["id"] for entry in listed] == ["b", "a"]
    assert ("recover", "a") in shelf.jobs.asked
    assert ("recover", "b") not in shelf.jobs.asked
    assert shelf.notes == ["The recording a was left open and is finished now"]
    assert {"type": "recordings"} in shelf.messages


def test_what_a_full_disk_left_open_is_finished_once_there_is_room(shelf: Shelf) -> None:
    shelf.put("a", finished=False)
    (shelf.library.folder / "other.mcap").write_bytes(b"something else")
    asyncio.run(shelf.library.tidy())
    asyncio.run(shelf.library.tidy())
    assert shelf.notes == []  # no page was there to be told
    assert Recording(shelf.library.folder / "a.mcap").is_finished
    assert [name for job, name in shelf.jobs.asked if job == "recover"] == ["a", "other"]


def test_an_import_has_its_name_before_its_summary(shelf: Shelf) -> None:
    head = {"id": "a", "name": "bench", "origin": "import", "begin_ns": "0", "first_sample": "0", "part": "1"}
    file = RecordingFile.create(shelf.library.folder / "a.mcap", head)
    file.append_samples(samples(500), 0)
    file.finish()
    entry = asyncio.run(shelf.library.entry("a"))
    assert (entry["name"], entry["origin"], entry["summary"]) == ("bench", "import", None)


def test_a_summary_is_computed_once(shelf: Shelf) -> None:
    shelf.put("a")
    shelf.started(lambda library: _summaries(library, 1))
    asked = len(shelf.jobs.asked)
    shelf.started(lambda library: _summaries(library, 1))
    assert len(shelf.jobs.asked) == asked


def test_search_looks_into_name_note_and_tags_and_pages_follow_one_another(shelf: Shelf) -> None:
    for name in ("a", "b", "c"):
        shelf.put(name)
    library = shelf.library

    async def work() -> tuple[list[str], list[str], list[str]]:
        await library.edit("a", {"note": "With the heavy link", "tags": ("friday",), "starred": True})
        found = (await library.list(search="HEAVY friday"))["recordings"]
        first = (await library.list(limit=2))["recordings"]
        rest = (await library.list(limit=2, before=first[-1]["id"]))["recordings"]
        starred = (await library.list(starred=True))["recordings"]
        assert [entry["id"] for entry in starred] == ["a"]
        return tuple([entry["id"] for entry in part] for part in (found, first, rest))  # type: ignore[return-value]

    assert asyncio.run(work()) == (["a"], ["c", "b"], ["a"])


def test_a_stale_edit_is_refused_and_says_what_is_there(shelf: Shelf) -> None:
    shelf.put("a")

    async def work() -> None:
        await shelf.library.edit("a", {"name": "first"}, 0)
        with pytest.raises(Problem, match="it is now called 'first'") as refused:
            await shelf.library.edit("a", {"name": "second"}, 0)
        assert refused.value.status == 412
        assert (await shelf.library.entry("a"))["name"] == "first"

    asyncio.run(work())


def test_a_starred_recording_is_not_deleted(shelf: Shelf) -> None:
    shelf.put("a")

    async def work() -> None:
        await shelf.library.edit("a", {"starred": True})
        with pytest.raises(Problem, match="take the star away first") as refused:
            await shelf.library.delete("a")
        assert refused.value.status == 409
        await shelf.library.edit("a", {"starred": False})
        await shelf.library.delete("a")

    asyncio.run(work())
    assert shelf.names() == []


@pytest.mark.parametrize("name", ["none", "../vssea", "..", "a/b", ".beginning"])
def test_a_name_that_is_no_recording_is_refused(shelf: Shelf, name: str) -> None:
    with pytest.raises(Problem) as refused:
        shelf.library.path_of(name)
    assert refused.value.status == 404


class TestQuota:
    """Room is made for about two of four recordings."""

    @pytest.fixture
    def full(self, tmp_path: Path) -> Iterator[Shelf]:
        size = Shelf(tmp_path / "one").put("x").stat().st_size
        made = Shelf(tmp_path / "full", quota_gb=2.5 * size / 1e9)
        import os

        for age, name in enumerate(("a", "b", "c", "d")):
            path = made.put(name)
            os.utime(path, (1000.0 + age, 1000.0 + age))
        yield made
        made.database.close()

    def test_the_oldest_go_first(self, full: Shelf) -> None:
        asyncio.run(full.library.tidy())
        assert full.names() == ["c", "d"]
        assert full.held == []

    def test_starred_and_pinned_ones_stay(self, full: Shelf) -> None:
        catalogue = Catalogue(full.database)
        catalogue.edit("a", {"starred": True}, None)
        with full.database.begin() as connection:
            values = {"from_s": 0.0, "to_s": 1.0, "by": "page 1", "created_at": "", "shown": True, "label": ""}
            connection.execute(sa.insert(EXCERPTS).values(recording="b", kind="pin", **values))
        asyncio.run(full.library.tidy())
        assert full.names() == ["a", "b"]

    def test_without_anything_to_delete_the_recording_is_held_until_there_is_room(self, full: Shelf) -> None:
        catalogue = Catalogue(full.database)
        for name in ("a", "b", "c", "d"):
            catalogue.edit(name, {"starred": True}, None)
        asyncio.run(full.library.tidy())
        assert full.names() == ["a", "b", "c", "d"]
        assert "the rest is starred or pinned" in (full.held[-1] or "")
        for name in ("a", "b"):
            catalogue.edit(name, {"starred": False}, None)
        asyncio.run(full.library.tidy())
        assert full.names() == ["c", "d"]
        assert full.held[-1] is None

    def test_with_unknown_stars_nothing_is_deleted(self, full: Shelf, monkeypatch: pytest.MonkeyPatch) -> None:
        def refuse(_: object) -> frozenset[str]:
            raise Problem(503, "Database locked", "The database is locked.")

        monkeypatch.setattr(Catalogue, "protected", refuse)
        asyncio.run(full.library.tidy())
        assert full.names() == ["a", "b", "c", "d"]
        assert full.held[-1] is not None


def test_a_database_in_trouble_costs_notes_and_stars_not_the_list(
    shelf: Shelf, monkeypatch: pytest.MonkeyPatch
) -> None:
    shelf.put("a")

    def refuse(_: object) -> dict[str, Any]:
        raise Problem(503, "Database from a newer version", "The database is of a newer version.")

    monkeypatch.setattr(Catalogue, "rows", refuse)
    answer = asyncio.run(shelf.library.list())
    assert [entry["id"] for entry in answer["recordings"]] == ["a"]
    assert answer["recordings"][0]["scenario"] == "realistic"
    assert answer["trouble"] == "The database is of a newer version."
