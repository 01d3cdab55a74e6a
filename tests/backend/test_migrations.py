"""Migrations: an old database comes up whole, a copy of it stays, and the tables are those that the program uses."""

import json
import sqlite3
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa
from alembic.autogenerate import compare_metadata
from alembic.config import Config
from alembic.migration import MigrationContext
from alembic.script import ScriptDirectory

from backend.presets.comparison import compared
from backend.presets.contents import PRESET
from backend.presets.documents import Documents
from backend.presets.last import read_last
from backend.store import kept
from backend.store.database import Database
from backend.store.migrating import HEAD, REVISIONS, keep_copy
from backend.store.tables import METADATA
from vssea_core.control.tuning import PositionObserver, SlidingMode, StateFeedback, Tuning
from vssea_core.scenarios import SCENARIOS

OLD = {
    "first": Tuning(controller=StateFeedback(natural_frequency=25.0)),
    "second": Tuning(controller=SlidingMode(), observer=PositionObserver(bandwidth=80.0)),
}
ODD = '{"controller": {"kind": "forgotten", "natural_frequency": 33.0}, "gain": 3}'


def old_database(file: Path) -> None:
    """A database as the first versions made it: two tables, no revision."""
    with closing(sqlite3.connect(file)) as connection, connection:
        columns = "name VARCHAR(80) PRIMARY KEY, saved_at VARCHAR(40) NOT NULL, tuning TEXT NOT NULL"
        connection.execute(f"CREATE TABLE presets ({columns})")
        connection.execute("CREATE TABLE last (id INTEGER PRIMARY KEY, scenario TEXT NOT NULL, preset VARCHAR(80))")
        for day, (name, tuning) in enumerate(OLD.items(), 1):
            row = (name, f"2026-01-0{day}T10:00:00.000Z", tuning.model_dump_json())
            connection.execute("INSERT INTO presets VALUES (?, ?, ?)", row)
        connection.execute("INSERT INTO presets VALUES ('odd', '2025-01-01T10:00:00.000Z', ?)", (ODD,))
        connection.execute("INSERT INTO last VALUES (1, ?, 'second')", (SCENARIOS["realistic"].model_dump_json(),))


@pytest.fixture
def old(tmp_path: Path) -> Path:
    file = tmp_path / "vssea.sqlite"
    old_database(file)
    return file


def test_an_old_database_keeps_its_presets_and_what_ran_last(old: Path) -> None:
    database = Database(f"sqlite:///{old}")
    presets = Documents(database, PRESET)
    assert [(line["name"], line["saved_at"], line["version"]) for line in presets.list()] == [
        ("second", "2026-01-02T10:00:00.000Z", 1), ("first", "2026-01-01T10:00:00.000Z", 1), ("odd", "2025-01-01T10:00:00.000Z", 1),
    ]  # fmt: skip
    for name, tuning in OLD.items():
        found = presets.get(name)
        assert found.part == tuning
        assert (found.content.scenario, found.fit.unknown, found.fit.missing) == (None, [], [])
    assert presets.list()[0]["summary"] == "sliding mode; position observer 80 rad/s"
    last = read_last(database, presets)
    assert last is not None
    assert last.scenario == SCENARIOS["realistic"]
    assert last.preset is not None
    assert (last.preset.name, last.preset.version) == ("second", 1)
    database.close()


def test_what_no_longer_fits_is_moved_as_it_was_and_named(old: Path) -> None:
    database = Database(f"sqlite:///{old}")
    found = Documents(database, PRESET).get("odd")
    assert found.raw["tuning"] == json.loads(ODD)
    assert found.fit.unknown == ["tuning.gain"]
    assert [error.field for error in found.fit.refused] == ["tuning.controller.kind"]
    database.close()


def test_a_kind_that_nobody_knows_is_compared_as_if_its_part_were_not_there(old: Path) -> None:
    """Its fields belong to no other kind: `natural_frequency` must not reach the controller in force."""
    documents = Documents(Database(f"sqlite:///{old}"), PRESET)
    comparison = compared(documents, "odd", None, "live", Tuning())
    assert [change.path for change in comparison.changes if change.path.startswith("tuning.controller")] == []
    assert [error.field for error in comparison.unfit] == ["tuning.controller.kind"]


def test_a_copy_of_the_old_file_stays_beside_it_and_is_the_old_file(old: Path) -> None:
    with closing(sqlite3.connect(old)) as connection:
        before = "\n".join(connection.iterdump())
    database = Database(f"sqlite:///{old}")
    database.open()
    database.close()
    copy = old.with_name("vssea.sqlite.before-0002")
    with closing(sqlite3.connect(copy)) as connection:
        assert "\n".join(connection.iterdump()) == before
    with closing(sqlite3.connect(old)) as connection:
        tables = {name for (name,) in connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
    assert not tables & {"presets", "last"}


def test_an_empty_file_gets_no_copy(tmp_path: Path) -> None:
    database = Database(f"sqlite:///{tmp_path / 'vssea.sqlite'}")
    database.open()
    database.close()
    assert [each.name for each in tmp_path.iterdir()] == ["vssea.sqlite"]


def test_a_migration_that_fails_leaves_the_database_as_it_was(old: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: Any) -> None:
        raise RuntimeError("power cut")

    with closing(sqlite3.connect(old)) as connection:
        before = "\n".join(connection.iterdump())
    database = Database(f"sqlite:///{old}")
    sa.event.listen(database.engine, "before_cursor_execute", _cut_at("DROP TABLE last", fail))
    with pytest.raises(RuntimeError, match="power cut"):
        database.open()
    database.close()
    with closing(sqlite3.connect(old)) as connection:
        assert "\n".join(connection.iterdump()) == before
    again = Database(f"sqlite:///{old}")
    assert len(Documents(again, PRESET).list()) == 3
    again.close()


def test_of_many_who_start_at_once_one_migrates(old: Path) -> None:
    def start(_: int) -> int:
        database = Database(f"sqlite:///{old}")
        try:
            return len(Documents(database, PRESET).list())
        finally:
            database.close()

    with ThreadPoolExecutor(4) as servers:
        assert list(servers.map(start, range(4))) == [3] * 4


def test_a_second_copy_does_not_write_over_the_first(old: Path) -> None:
    database = Database(f"sqlite:///{old}")
    copy = old.with_name("vssea.sqlite.before-0002")
    copy.write_text("the first")
    assert keep_copy(database.engine, "0001") == copy
    assert copy.read_text() == "the first"
    database.close()


def test_the_migrations_make_the_tables_that_the_program_uses(database: Database) -> None:
    with database.connect() as connection:
        found = compare_metadata(MigrationContext.configure(connection), METADATA)
    assert [each for each in found if "alembic_version" not in str(each)] == []


def test_the_program_knows_every_migration_in_order() -> None:
    config = Config()
    config.set_main_option("script_location", "backend.store:migrations")
    scripts = ScriptDirectory.from_config(config)
    assert tuple(reversed([script.revision for script in scripts.walk_revisions()])) == REVISIONS
    assert scripts.get_current_head() == HEAD


def test_a_database_that_is_up_to_date_is_opened_without_migrating(database: Database, database_url: str) -> None:
    kept.put(database, "last", 1)
    again = Database(database_url)
    statements: list[str] = []
    sa.event.listen(again.engine, "before_cursor_execute", lambda *told: statements.append(told[2].upper()))
    again.open()
    again.close()
    assert [each for each in statements if each.startswith(("CREATE", "INSERT", "UPDATE", "DROP"))] == []


def _cut_at(statement: str, fail: Any) -> Any:
    def look(connection: Any, cursor: Any, text: str, *_: Any) -> None:
        if " ".join(text.split()) == statement:
            fail()

    return look
