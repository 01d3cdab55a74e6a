"""Bringing a database to the tables of this version: told apart by its revision, migrated in one transaction, a copy kept."""

import os
import threading
from contextlib import closing
from pathlib import Path

import sqlalchemy as sa

from backend.store.troubles import newer

REVISIONS = ("0001", "0002", "0003")
"""All that this version knows, oldest first; migrations/versions has one module for each."""
HEAD = REVISIONS[-1]
UNVERSIONED = "0001"
"""A database with presets and without a revision: that of the first versions, which kept none."""
_POSTGRES_LOCK = 7_305_801
_one_at_a_time = threading.Lock()  # alembic's context is one for the whole process


def bring_up_to_date(engine: sa.Engine) -> None:
    """Migrate the database if it is older. Raises Problem if it is newer, and what the driver raises; then it is as it was."""
    with engine.connect() as connection:
        found = revision_of(connection)
    if found == HEAD:
        return
    if found is not None and found not in REVISIONS:
        raise newer(found)
    if found is not None and engine.dialect.name == "sqlite":
        keep_copy(engine, found)
    with _one_at_a_time, engine.execution_options(writes=True).begin() as connection:
        if engine.dialect.name == "postgresql":
            connection.execute(sa.select(sa.func.pg_advisory_xact_lock(_POSTGRES_LOCK)))
        found = revision_of(connection)  # another process may have been first
        if found != HEAD:
            _migrate(connection, found)


def revision_of(connection: sa.Connection) -> str | None:
    """Return the revision of a database, None if it is empty."""
    tables = sa.inspect(connection).get_table_names()
    if "alembic_version" in tables:
        rows = connection.execute(sa.text("SELECT version_num FROM alembic_version")).scalars().all()
        if rows:
            return str(rows[0])
    return UNVERSIONED if "presets" in tables else None


def keep_copy(engine: sa.Engine, revision: str) -> Path | None:
    """Copy a SQLite file beside itself, as `<name>.before-<next revision>`, once; None for a database in memory."""
    if not engine.url.database or engine.url.database == ":memory:":
        return None
    file = Path(engine.url.database)
    following = REVISIONS[REVISIONS.index(revision) + 1]
    copy = file.with_name(f"{file.name}.before-{following}")
    if copy.exists():
        return copy
    partial = copy.with_name(f"{copy.name}.{os.getpid()}-{threading.get_ident()}")
    partial.unlink(missing_ok=True)
    try:
        with closing(engine.raw_connection()) as connection:  # outside of any transaction
            connection.cursor().execute("VACUUM INTO ?", (str(partial),))
        if not copy.exists():  # else another process was first, and may have migrated before this copy was made
            partial.rename(copy)
    finally:
        partial.unlink(missing_ok=True)
    return copy


def _migrate(connection: sa.Connection, found: str | None) -> None:
    # Imported here: a start that has nothing to migrate does not wait for it.
    from alembic import command
    from alembic.config import Config

    config = Config()
    config.set_main_option("script_location", "backend.store:migrations")
    config.attributes["connection"] = connection
    if found is not None:
        command.stamp(config, found)
    command.upgrade(config, HEAD)
