"""The engine by URL, opened at its first use. All calls block for a moment; the web process makes them in threads."""

import sqlite3
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import sqlalchemy as sa

from backend.problem import Problem
from backend.store.migrating import bring_up_to_date
from backend.store.troubles import NO_DRIVER, translated

BUSY_S = 2.0
"""How long a statement waits for another program's lock."""
RETRY_AFTER_S = 5.0
"""A database that could not be opened is tried again so much later."""
CONNECT_LIMIT_S = 5


class Database:
    """One database for everything that is kept.

    Whoever asks while it cannot be used gets the reason as a Problem; nothing is then written.
    """

    def __init__(self, url: str, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._turn = threading.Lock()
        self._is_open = False
        self._trouble: Problem | None = None
        self._tried_at = 0.0
        try:
            self.engine: sa.Engine = engine_for(url)
        except ModuleNotFoundError:
            self._trouble, self._tried_at = NO_DRIVER, float("inf")

    def open(self) -> None:
        """Bring the tables up to date, once. Raises Problem if the database cannot be used."""
        if self._is_open:
            return
        with self._turn:
            if self._is_open:
                return
            if self._trouble is not None and self._clock() < self._tried_at + RETRY_AFTER_S:
                raise replace(self._trouble)
            try:
                with translated():
                    bring_up_to_date(self.engine)
            except Problem as problem:
                self._trouble, self._tried_at = problem, self._clock()
                raise
            self._is_open, self._trouble = True, None

    @contextmanager
    def connect(self) -> Iterator[sa.Connection]:
        """Give a connection for reading: all of it sees one state. Raises Problem."""
        self.open()
        with translated(), self.engine.connect() as connection:
            yield connection

    @contextmanager
    def begin(self) -> Iterator[sa.Connection]:
        """Give a connection for writing; all of it is kept at the end, or nothing if anything is raised. Raises Problem, Clash."""
        self.open()
        with translated(), self.engine.execution_options(writes=True).begin() as connection:
            yield connection

    def close(self) -> None:
        """Let go of it."""
        if hasattr(self, "engine"):
            self.engine.dispose()


def engine_for(url: str) -> sa.Engine:
    """Return an engine that waits a bounded time for locks. Raises ModuleNotFoundError without PostgreSQL's driver."""
    parsed = sa.make_url(url)
    if parsed.get_backend_name() != "sqlite":
        options = {"connect_timeout": CONNECT_LIMIT_S, "options": f"-c lock_timeout={1000 * BUSY_S:.0f}"}
        return sa.create_engine(parsed.set(drivername="postgresql+psycopg"), connect_args=options, pool_pre_ping=True)
    # Without the driver's own transactions: it would begin one too late for a read before a write.
    engine = sa.create_engine(parsed, connect_args={"timeout": BUSY_S, "isolation_level": None})
    sa.event.listen(engine, "connect", _set_up)
    sa.event.listen(engine, "begin", _begin)
    return engine


def _set_up(connection: Any, _: object) -> None:
    connection.execute("PRAGMA foreign_keys = ON")
    try:
        connection.execute("PRAGMA journal_mode = WAL")
    except sqlite3.OperationalError as error:
        if error.sqlite_errorcode != sqlite3.SQLITE_BUSY:  # else another one is just setting it
            raise


def _begin(connection: sa.Connection) -> None:
    # A writer takes its turn at the start: no read inside it can be out of date when it writes.
    writes = connection.get_execution_options().get("writes")
    connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")
