"""What people say of recordings - name, note, tags, star - and what was computed of them, in the database."""

import json
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from typing import Any

import sqlalchemy as sa

from backend.problem import Problem
from backend.store.database import Database
from backend.store.tables import EXCERPTS, RECORDINGS


@dataclass(frozen=True)
class Row:
    """One recording's entry; `revision` counts the edits."""

    id: str
    name: str = ""
    note: str = ""
    tags: tuple[str, ...] = ()
    starred: bool = False
    revision: int = 0
    summary: dict[str, Any] | None = None


class Catalogue:
    """Blocks on the database for a moment; the web process calls it in a thread. Every method raises Problem."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def rows(self) -> dict[str, Row]:
        """Return all entries by id."""
        with self._database.connect() as connection:
            return {row.id: _row(row) for row in connection.execute(sa.select(RECORDINGS))}

    def row(self, recording: str) -> Row:
        """Return one entry; an empty one if nothing was said of it yet."""
        with self._database.connect() as connection:
            found = connection.execute(sa.select(RECORDINGS).where(RECORDINGS.c.id == recording)).first()
        return Row(recording) if found is None else _row(found)

    def edit(self, recording: str, changes: dict[str, Any], revision: int | None) -> Row:
        """Change what was said of a recording. A stale `revision` is refused, with what it is now."""
        with self._database.begin() as connection:
            found = connection.execute(sa.select(RECORDINGS).where(RECORDINGS.c.id == recording)).first()
            before = Row(recording) if found is None else _row(found)
            if revision is not None and revision != before.revision:
                raise Problem(
                    412, "Changed meanwhile",
                    f"Somebody else edited this recording since (edit {before.revision}, not {revision}): it is now called "
                    f"{before.name or 'nothing'!r}, {'starred' if before.starred else 'not starred'}. Look at it and try again.",
                )  # fmt: skip
            after = replace(before, **changes, revision=before.revision + 1)
            _keep(connection, after, found is not None)
        return after

    def summarised(self, recording: str, summary: dict[str, Any]) -> None:
        """Keep what was computed of a recording; this is no edit."""
        with self._database.begin() as connection:
            found = connection.execute(sa.select(RECORDINGS).where(RECORDINGS.c.id == recording)).first()
            before = Row(recording) if found is None else _row(found)
            _keep(connection, replace(before, summary=summary), found is not None)

    def forget(self, recording: str) -> None:
        """Remove what was said of a recording that is no more, and its excerpts."""
        with self._database.begin() as connection:
            connection.execute(sa.delete(RECORDINGS).where(RECORDINGS.c.id == recording))
            connection.execute(sa.delete(EXCERPTS).where(EXCERPTS.c.recording == recording))

    def protected(self) -> frozenset[str]:
        """Return the recordings that a clean-up must leave: starred ones, and those that a pinned run is part of."""
        pins = sa.select(EXCERPTS.c.recording).where(EXCERPTS.c.kind == "pin")
        stars = sa.select(RECORDINGS.c.id).where(RECORDINGS.c.starred)
        with self._database.connect() as connection:
            return frozenset(connection.execute(stars.union(pins)).scalars())


def _row(found: Any) -> Row:
    summary = json.loads(found.summary) if found.summary else None
    return Row(
        found.id, found.name, found.note, tuple(json.loads(found.tags)), bool(found.starred), found.revision, summary
    )


def _keep(connection: sa.Connection, row: Row, exists: bool) -> None:
    values = {
        "name": row.name, "note": row.note, "tags": json.dumps(row.tags, ensure_ascii=False), "starred": row.starred,
        "revision": row.revision, "summary": None if row.summary is None else json.dumps(row.summary, ensure_ascii=False),
    }  # fmt: skip
    if exists:
        connection.execute(sa.update(RECORDINGS).where(RECORDINGS.c.id == row.id).values(**values))
    else:
        now = datetime.now(UTC).isoformat(timespec="seconds")
        connection.execute(sa.insert(RECORDINGS).values(id=row.id, added_at=now, **values))
