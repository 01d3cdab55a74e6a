"""A database in trouble is told in one sentence: what happened, what is kept, what to do; and nothing is half written."""

import json
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa

from backend.problem import Problem
from backend.store import kept, versioned
from backend.store.database import RETRY_AFTER_S, Database
from backend.store.expected import ANY
from backend.store.troubles import problem_of
from tests.backend.counting import NAME, draft, numbers
from tests.backend.live_page import LivePage
from tests.backend.server import Server

FUTURE = "9999"


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "vssea.sqlite"


@contextmanager
def opened(file: Path, **options: Any) -> Iterator[Database]:
    database = Database(f"sqlite:///{file}", **options)
    yield database
    database.close()


@pytest.fixture
def filled(file: Path) -> Path:
    """A database with one document of one version."""
    with opened(file) as database, database.begin() as connection:
        versioned.put(connection, "preset", NAME, draft(1), None)
    return file


@contextmanager
def locked(file: Path) -> Iterator[None]:
    """Another program that is writing."""
    with closing(sqlite3.connect(file, isolation_level=None)) as other:
        other.execute("BEGIN IMMEDIATE")
        yield
        other.execute("ROLLBACK")


def from_the_future(file: Path) -> None:
    with closing(sqlite3.connect(file)) as connection, connection:
        connection.execute("UPDATE alembic_version SET version_num = ?", (FUTURE,))


def put(database: Database, count: int, size: int = 0) -> None:
    with database.begin() as connection:
        made = draft(count, "x" * 80)
        big = type(made)(**(vars(made) | {"content": json.dumps({"count": count, "more": "x" * size})}))
        versioned.put(connection, "preset", NAME, big, ANY)


def test_a_full_disk_keeps_what_was_saved_and_takes_more_once_there_is_room(filled: Path) -> None:
    with opened(filled) as database:
        database.open()
        with database.begin() as connection:
            pages = connection.exec_driver_sql("PRAGMA page_count").scalar_one()
            connection.exec_driver_sql(f"PRAGMA max_page_count = {pages + 2}")
        with pytest.raises(Problem, match=r"disk of the database is full\. What was saved before is kept") as problem:
            put(database, 2, size=100_000)
        assert problem.value.status == 507
        assert problem.value.detail.endswith("Make room, then try again.")
        assert numbers(database) == [1]
        with database.begin() as connection:
            connection.exec_driver_sql("PRAGMA max_page_count = 100000")
        put(database, 2, size=100_000)
        assert numbers(database) == [1, 2]


def test_a_lock_of_another_program_is_waited_for_a_bounded_time_and_then_told(
    filled: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("backend.store.database.BUSY_S", 0.05)
    with opened(filled) as database:
        database.open()
        with locked(filled):
            assert numbers(database) == [1]  # reading goes on
            with pytest.raises(Problem, match=r"locked by another program\. Nothing was changed") as problem:
                put(database, 2)
            assert problem.value.status == 503
        put(database, 2)
        assert numbers(database) == [1, 2]


def test_a_database_from_a_newer_version_is_left_as_it_is(filled: Path) -> None:
    from_the_future(filled)
    before = filled.read_bytes()
    with opened(filled) as database:
        for attempt in (lambda: kept.put(database, "last", 1), lambda: numbers(database)):
            with pytest.raises(
                Problem, match=f"changed by a newer version of VSSEA .its revision is {FUTURE}."
            ) as problem:
                attempt()
            assert problem.value.title == "Database from a newer version"
            assert "the live session goes on" in problem.value.detail
    assert filled.read_bytes() == before
    assert [each.name for each in filled.parent.iterdir()] == [filled.name]


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda file: file.write_bytes(b"something else" * 400), "damaged or not a database"),
        (lambda file: (file.unlink(), file.mkdir()), "cannot be opened"),
    ],
    ids=["another file", "a folder"],
)
def test_a_file_that_is_no_database_is_told_and_left(filled: Path, spoil: Any, words: str) -> None:
    spoil(filled)
    with opened(filled) as database, pytest.raises(Problem, match=words) as problem:
        numbers(database)
    assert problem.value.status == 503


@pytest.mark.postgres
def test_a_server_that_is_not_there_is_told() -> None:
    database = Database("postgresql://nobody@/nothing?host=/nowhere")
    with pytest.raises(Problem, match="cannot be reached"):
        database.open()


def test_a_database_is_tried_again_after_a_while_and_not_at_every_request(
    filled: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = 100.0
    content = filled.read_bytes()
    filled.write_bytes(b"x" * 5000)
    with opened(filled, clock=lambda: now) as database:
        with pytest.raises(Problem):
            numbers(database)
        filled.write_bytes(content)
        with pytest.raises(Problem):
            numbers(database)
        now += RETRY_AFTER_S
        assert numbers(database) == [1]


def test_a_wrong_statement_is_no_trouble_of_the_database(filled: Path) -> None:
    with opened(filled) as database, pytest.raises(sa.exc.OperationalError), database.connect() as connection:
        connection.exec_driver_sql("SELECT nothing FROM nowhere")
    assert problem_of(sqlite3.OperationalError("no such table")) is None


@pytest.mark.parametrize("trouble", ["newer", "unreadable"])
def test_a_server_with_a_database_in_trouble_runs_and_says_so(data_dir: Path, trouble: str) -> None:
    data_dir.mkdir()
    file = data_dir / "vssea.sqlite"
    if trouble == "newer":
        with opened(file) as database:
            database.open()
        from_the_future(file)
    else:
        file.write_bytes(b"something else" * 400)
    before = file.read_bytes()
    server = Server(data_dir).wait_until_running()
    try:
        assert server.get("/api/health").json()["session"] == "running"
        for asked in (server.get("/api/presets"), server.get("/api/actuators/rig"), server.get("/api/presets-export")):
            assert asked.status_code == 503
            assert asked.json()["title"].startswith("Database")
        server.post("/api/session/tune", {"changes": {"observer.bandwidth": 70.0}}).raise_for_status()
        saved = server.post("/api/session/save_preset", {"name": "a"})
        assert (saved.status_code, saved.json()["title"]) == (503, asked.json()["title"])
        told = [event for event in server.get("/api/session/events").json() if event["kind"] == "preset"]
        assert [event["severity"] for event in told] == ["warning"]
        assert told[0]["text"].endswith("What runs now is not kept for the next start.")
        with LivePage(server) as page:
            assert page.hello["document"]["scenario"]["tuning"]["observer"]["bandwidth"] == 70.0
    finally:
        assert server.terminate() == ""
    assert file.read_bytes() == before
