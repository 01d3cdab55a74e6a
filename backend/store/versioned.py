"""Changing versioned documents. Each call belongs in one transaction of the caller (`with database.begin()`).

An edit counts the revision with a condition on the one it has read. That holds between threads, processes and servers
alike: of two edits of one revision, one finds it gone.
"""

from datetime import UTC, datetime

import sqlalchemy as sa

from backend.problem import Problem
from backend.store.document import Document, Draft, Edit
from backend.store.expected import NEW, Expected, Stale, check
from backend.store.listing import find
from backend.store.tables import DOCUMENT_TAGS, DOCUMENTS, EDITS, VERSIONS


def existing(connection: sa.Connection, kind: str, name: str) -> Document:
    """Return a document, archived or not. Raises Problem 404."""
    document = find(connection, kind, name)
    if document is None:
        raise Problem(
            404, f"No such {kind}", f"There is no {kind} {name!r}; GET /api/{kind}s lists those that there are."
        )
    return document


def put(connection: sa.Connection, kind: str, name: str, draft: Draft, expected: Expected | None) -> Document:
    """Keep a new version of a document that is as expected, or a new document; an archived one comes back with it.

    Raises Stale, Problem 428, and what the transaction raises (Clash if another one makes the same document now).
    """
    document = find(connection, kind, name)
    if document is None:
        if expected is not None and expected.revisions:
            raise Problem(
                412,
                f"No such {kind}",
                f"There is no {kind} {name!r} any more. Nothing was saved; save it under If-None-Match: *.",
            )
        document_id, number, revision = _insert(connection, kind, name), draft.number or 1, 1
    else:
        if document.archived_at is None or expected not in (None, NEW):
            check(document, expected)
        document_id, number = document.id, document.newest.number + 1
        revision = _count(connection, document, expected, archived_at=None)
    saved_at = draft.saved_at or now()
    connection.execute(
        sa.insert(VERSIONS).values(
            document_id=document_id, number=number, saved_at=saved_at, author=draft.author, note=draft.note, label=draft.label,
            summary=draft.summary, scenario=draft.scenario, content=draft.content,
        )
    )  # fmt: skip
    if draft.tags is not None:
        _set_tags(connection, document_id, draft.tags)
    _note(connection, document_id, revision, number, draft.author, "")
    return existing(connection, kind, name)


def edit(
    connection: sa.Connection, kind: str, name: str, asked: Edit, expected: Expected | None, by: str
) -> tuple[Document, str]:
    """Change what is said about a document and return it with what changed in words, "" if nothing did.

    Raises Stale, Problem 404, 409 (another has the name), 422 (no such version) or 428.
    """
    document = existing(connection, kind, name)
    check(document, expected)
    words: list[str] = []
    values: dict[str, str | None] = {}
    if asked.name is not None and asked.name != document.name:
        if find(connection, kind, asked.name) is not None:
            raise Problem(
                409, "Name taken", f"There is a {kind} {asked.name!r} already, perhaps archived; choose another name."
            )
        values["name"] = asked.name
        words.append(f"renamed from {document.name}")
    if asked.archived is not None and asked.archived != (document.archived_at is not None):
        values["archived_at"] = now() if asked.archived else None
        words.append("archived" if asked.archived else "taken out of the archive")
    if asked.tags is not None and set(asked.tags) != set(document.tags):
        _set_tags(connection, document.id, asked.tags)
        words.append(f"tags: {', '.join(sorted(asked.tags)) or 'none'}")
    if asked.note is not None and asked.note != document.newest.note:
        _set_on_version(connection, document, document.newest.number, note=asked.note)
        words.append(f"note: {asked.note or 'none'}")
    for number, label in (asked.labels or {}).items():
        _set_on_version(connection, document, number, label=label or None)
        words.append(f"version {number} {f'named {label}' if label else 'without a name'}")
    if words:
        revision = _count(connection, document, expected, **values)
        _note(connection, document.id, revision, document.newest.number, by, "; ".join(words))
    return existing(connection, kind, asked.name or name), "; ".join(words)


def edits_since(connection: sa.Connection, document_id: int, revision: int) -> tuple[int | None, list[str]]:
    """Return which version was the newest at a revision, None if that never was, and the words of the edits after it."""
    asked = (
        sa.select(EDITS)
        .where(EDITS.c.document_id == document_id, EDITS.c.revision >= revision)
        .order_by(EDITS.c.revision)
    )
    rows = connection.execute(asked).all()
    known = rows[0].version if rows and rows[0].revision == revision else None
    return known, [row.words for row in rows if row.revision > revision and row.words]


def now() -> str:
    """Return the time as all tables keep it."""
    return datetime.now(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")


def _insert(connection: sa.Connection, kind: str, name: str) -> int:
    values = {"kind": kind, "name": name, "created_at": now(), "revision": 1}
    return int(connection.execute(sa.insert(DOCUMENTS).values(values).returning(DOCUMENTS.c.id)).scalar_one())


def _count(connection: sa.Connection, document: Document, expected: Expected | None, **values: str | None) -> int:
    revision = document.revision + 1
    unchanged = (DOCUMENTS.c.id == document.id) & (DOCUMENTS.c.revision == document.revision)
    counted = connection.execute(sa.update(DOCUMENTS).where(unchanged).values(revision=revision, **values))
    if counted.rowcount != 1:
        raise Stale(document, expected.known_revision if expected else None)
    return revision


def _set_tags(connection: sa.Connection, document_id: int, tags: tuple[str, ...]) -> None:
    connection.execute(sa.delete(DOCUMENT_TAGS).where(DOCUMENT_TAGS.c.document_id == document_id))
    for tag in dict.fromkeys(tags):
        connection.execute(sa.insert(DOCUMENT_TAGS).values(document_id=document_id, tag=tag))


def _set_on_version(connection: sa.Connection, document: Document, number: int, **values: str | None) -> None:
    place = (VERSIONS.c.document_id == document.id) & (VERSIONS.c.number == number)
    if connection.execute(sa.update(VERSIONS).where(place).values(**values)).rowcount != 1:
        raise Problem(
            422, "No such version", f"{document.kind.capitalize()} {document.name!r} has no version {number}; "
            f"expected 1 to {document.newest.number}."
        )  # fmt: skip


def _note(connection: sa.Connection, document_id: int, revision: int, version: int, author: str, words: str) -> None:
    values = {"document_id": document_id, "revision": revision, "version": version, "at": now(), "author": author}
    connection.execute(sa.insert(EDITS).values(values | {"words": words}))
