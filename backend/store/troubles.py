"""What goes wrong with a database, told once for all of it: what happened, what was kept, what to do."""

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from sqlalchemy import exc

from backend.problem import Problem

KEPT = "Nothing was changed, and the live session goes on."
LOCKED = Problem(
    503,
    "Database locked",
    f"The database is locked by another program. {KEPT} Let the other one finish, then try again.",
)
FULL = Problem(
    507,
    "Disk full",
    "The disk of the database is full. What was saved before is kept, this was not saved, and the live session goes on. "
    "Make room, then try again.",
)  # fmt: skip
READ_ONLY = Problem(
    503,
    "Database read-only",
    f"The database cannot be written. {KEPT} Give this user the right to write the file and its folder, then try again.",
)
UNREADABLE = Problem(
    503,
    "Database unreadable",
    f"The database file cannot be read: it is damaged or not a database. {KEPT} "
    "Put a copy in its place or move it away, then restart the server.",
)
NOT_OPENED = Problem(
    503,
    "Database not opened",
    f"The database file cannot be opened. {KEPT} Check VSSEA_DATABASE and the folder's rights, then try again.",
)
OUT_OF_REACH = Problem(
    503,
    "Database out of reach",
    f"The database server cannot be reached. {KEPT} Start it or correct VSSEA_DATABASE, then try again.",
)
NO_DRIVER = Problem(
    503,
    "Database driver missing",
    f"PostgreSQL needs its driver. {KEPT} Install it with pip install 'vssea[postgres]', then restart the server.",
)

_SQLITE = {
    sqlite3.SQLITE_BUSY: LOCKED, sqlite3.SQLITE_LOCKED: LOCKED, sqlite3.SQLITE_FULL: FULL,
    sqlite3.SQLITE_READONLY: READ_ONLY, sqlite3.SQLITE_PERM: READ_ONLY, sqlite3.SQLITE_CANTOPEN: NOT_OPENED,
    sqlite3.SQLITE_NOTADB: UNREADABLE, sqlite3.SQLITE_CORRUPT: UNREADABLE, sqlite3.SQLITE_IOERR: UNREADABLE,
}  # fmt: skip
_PRIMARY = 0xFF  # the rest of an extended result code says where it happened
_POSTGRES = {"53100": FULL, "55P03": LOCKED, "40001": LOCKED, "40P01": LOCKED, "57014": LOCKED, "25006": READ_ONLY}


class Clash(Exception):
    """Two transactions made what there may be once; who comes second sees the first one's when it tries again."""


def newer(revision: str) -> Problem:
    """Return the problem of a database that a newer program has changed."""
    return Problem(
        503,
        "Database from a newer version",
        f"The database was changed by a newer version of VSSEA (its revision is {revision}). It is left as it is, and the live "
        "session goes on. Install that version, or name another database with VSSEA_DATABASE.",
    )


@contextmanager
def translated() -> Iterator[None]:
    """Turn what a driver raises into a Problem; a fault of ours, such as a wrong statement, passes as it is. Raises Clash."""
    try:
        yield
    except exc.IntegrityError as error:
        raise Clash from error
    except (exc.DBAPIError, sqlite3.Error) as error:
        found = problem_of(error)
        if found is None:
            raise
        raise replace(found) from error


def problem_of(error: Exception) -> Problem | None:
    """Return the problem that a driver's error means, None if it means a fault of the program."""
    origin = error.orig if isinstance(error, exc.DBAPIError) else error
    if isinstance(origin, sqlite3.Error):
        return _SQLITE.get(getattr(origin, "sqlite_errorcode", 0) & _PRIMARY)
    state = getattr(origin, "sqlstate", None)
    if state in _POSTGRES:
        return _POSTGRES[state]
    is_lost = isinstance(error, exc.DBAPIError) and (
        error.connection_invalidated or isinstance(error, exc.OperationalError)
    )
    return OUT_OF_REACH if is_lost else None
