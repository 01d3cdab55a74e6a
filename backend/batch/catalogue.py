"""The batches that are known, in the database: what was asked for, and what became of it."""

import json
import logging
from dataclasses import dataclass, field
from typing import Any

import sqlalchemy as sa

from backend.store.database import Database
from backend.store.tables import BATCHES

logger = logging.getLogger(__name__)
ACTIVE = ("queued", "running")
STATES = (*ACTIVE, "done", "cancelled", "failed")
FACTS: dict[str, Any] = {"description": "", "paths": [], "columns": [], "trajectories": "none", "engine": ""}
"""What every summary has."""
DAMAGED = "its record in the database is damaged; delete the batch and start its document anew"


@dataclass(frozen=True)
class Row:
    """One batch; `summary` has its columns, paths, engine, counts of runs and rate."""

    id: str
    name: str
    key: str | None
    digest: str
    state: str
    created_at: str
    runs: int
    part_size: int
    summary: dict[str, Any] = field(default_factory=dict)
    started_at: str | None = None
    ended_at: str | None = None
    seconds: float = 0.0
    reason: str = ""

    @property
    def parts(self) -> int:
        """How many parts it has."""
        return -(-self.runs // self.part_size)


class BatchCatalogue:
    """Blocks on the database for a moment; the web process calls it in a thread. Every method raises Problem."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def add(self, row: Row) -> None:
        """Keep a new batch. Raises Clash if its key is in use."""
        with self._database.begin() as connection:
            connection.execute(sa.insert(BATCHES).values(**_values(row)))

    def put(self, row: Row) -> None:
        """Keep what became of a batch."""
        with self._database.begin() as connection:
            connection.execute(sa.update(BATCHES).where(BATCHES.c.id == row.id).values(**_values(row)))

    def find(self, batch: str) -> Row | None:
        """Return a batch, None if there is none."""
        return self._one(BATCHES.c.id == batch)

    def find_key(self, key: str) -> Row | None:
        """Return the batch that was asked for with an idempotency key, None if there is none."""
        return self._one(BATCHES.c.key == key)

    def ids(self) -> set[str]:
        """Return the ids of all batches."""
        with self._database.connect() as connection:
            return set(connection.execute(sa.select(BATCHES.c.id)).scalars())

    def active(self) -> list[Row]:
        """Return the batches that have not ended and can be read, oldest first."""
        asked = sa.select(BATCHES).where(BATCHES.c.state.in_(ACTIVE)).order_by(BATCHES.c.created_at, BATCHES.c.id)
        with self._database.connect() as connection:
            return [row for found in connection.execute(asked) if (row := _row(found)).state in ACTIVE]

    def list(self, state: str | None, offset: int, limit: int) -> tuple[int, list[Row]]:
        """Return how many batches there are, and some of them, newest first."""
        chosen = sa.true() if state is None else BATCHES.c.state == state
        asked = sa.select(BATCHES).where(chosen).order_by(BATCHES.c.created_at.desc(), BATCHES.c.id.desc())
        with self._database.connect() as connection:
            total = connection.execute(sa.select(sa.func.count()).select_from(BATCHES).where(chosen)).scalar_one()
            return total, [_row(found) for found in connection.execute(asked.offset(offset).limit(limit))]

    def forget(self, batch: str) -> None:
        """Remove a batch."""
        with self._database.begin() as connection:
            connection.execute(sa.delete(BATCHES).where(BATCHES.c.id == batch))

    def _one(self, condition: sa.ColumnElement[bool]) -> Row | None:
        with self._database.connect() as connection:
            found = connection.execute(sa.select(BATCHES).where(condition)).first()
        return None if found is None else _row(found)


def _values(row: Row) -> dict[str, Any]:
    return {**vars(row), "summary": json.dumps(row.summary, ensure_ascii=False)}


def _row(found: Any) -> Row:
    """Return a batch; one whose record is damaged has failed, so that it is seen and can be deleted, and the others go on."""
    columns = dict(found._mapping)
    try:
        summary = json.loads(columns.pop("summary"))
        if not isinstance(summary, dict) or not FACTS.keys() <= summary.keys():
            raise ValueError("it lacks what every batch has")
    except (TypeError, ValueError) as error:
        logger.warning("the record of batch %s is damaged: %s", found.id, error)
        return Row(**columns | {"state": "failed", "reason": DAMAGED}, summary=FACTS)
    return Row(**columns, summary=summary)
