"""Excerpts of recordings - pinned runs and what triggers captured - in the database."""

import json
from dataclasses import replace
from typing import Any, cast

import sqlalchemy as sa

from backend.session.excerpt import Excerpt
from backend.store.database import Database
from backend.store.tables import EXCERPTS

IN_DATA = ("period_s", "words", "metrics", "tuning")
"""What has no column of its own: nothing is searched by it."""


class Excerpts:
    """Blocks on the database for a moment; the session calls it in threads. Every method raises Problem."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def list(self) -> list[Excerpt]:
        """Return all, oldest first."""
        with self._database.connect() as connection:
            return [_excerpt(row) for row in connection.execute(sa.select(EXCERPTS).order_by(EXCERPTS.c.id))]

    def add(self, excerpt: Excerpt) -> Excerpt:
        """Keep one and return it with its id."""
        document = excerpt.document()
        columns = {name: value for name, value in document.items() if name != "id" and name not in IN_DATA}
        data = json.dumps({name: document[name] for name in IN_DATA}, ensure_ascii=False)
        with self._database.begin() as connection:
            done = connection.execute(sa.insert(EXCERPTS).values(**columns, data=data))
            return replace(excerpt, id=cast(tuple[int], done.inserted_primary_key)[0])

    def change(self, excerpt: Excerpt) -> None:
        """Keep another label, or whether it is shown."""
        new = {"label": excerpt.label, "shown": excerpt.shown}
        with self._database.begin() as connection:
            connection.execute(sa.update(EXCERPTS).where(EXCERPTS.c.id == excerpt.id).values(**new))

    def remove(self, number: int) -> None:
        """Forget one."""
        with self._database.begin() as connection:
            connection.execute(sa.delete(EXCERPTS).where(EXCERPTS.c.id == number))


def _excerpt(row: Any) -> Excerpt:
    data = json.loads(row.data or "{}")
    return Excerpt(
        row.recording, row.kind, row.label, row.from_s, row.to_s, row.by, row.created_at, row.at_s, row.shown,
        period_s=data.get("period_s"), words=tuple(data.get("words", ())), metrics=data.get("metrics", {}),
        tuning=data.get("tuning", {}), id=row.id,
    )  # fmt: skip
