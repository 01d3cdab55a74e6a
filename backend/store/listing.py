"""Reading versioned documents: one, its versions, or all that a search finds, in one statement each."""

from typing import Any

import sqlalchemy as sa

from backend.store.document import Document, Version
from backend.store.tables import DOCUMENT_TAGS, DOCUMENTS, VERSIONS

_SEPARATOR = "\n"  # stands in no tag


def find(connection: sa.Connection, kind: str, name: str) -> Document | None:
    """Return a document with its newest version's content, archived or not; None if there is none."""
    row = connection.execute(_documents(kind, VERSIONS.c.content).where(DOCUMENTS.c.name == name)).first()
    return None if row is None else _document(row, row.content)


def listed(
    connection: sa.Connection,
    kind: str,
    search: str = "",
    tag: str = "",
    *,
    archived: bool = False,
    contents: bool = False,
) -> list[Document]:
    """Return the documents, newest first, that hold every word of `search` in name, note, tags, labels or summary."""
    asked = _documents(kind, VERSIONS.c.content if contents else sa.null().label("content"))
    asked = asked.where(DOCUMENTS.c.archived_at.is_not(None) if archived else DOCUMENTS.c.archived_at.is_(None))
    if tag:
        asked = asked.where(_tagged(DOCUMENT_TAGS.c.tag == tag))
    for word in search.split():
        asked = asked.where(_holds(word))
    asked = asked.order_by(VERSIONS.c.saved_at.desc(), VERSIONS.c.id.desc())
    return [_document(row, row.content) for row in connection.execute(asked)]


def version(connection: sa.Connection, document_id: int, number: int) -> Version | None:
    """Return a version with its content, None if there is none."""
    asked = sa.select(VERSIONS).where(VERSIONS.c.document_id == document_id, VERSIONS.c.number == number)
    row = connection.execute(asked).first()
    return None if row is None else _version(row, row.content)


def versions(connection: sa.Connection, document_id: int, *, contents: bool = False) -> list[Version]:
    """Return all versions of a document, oldest first."""
    columns = [column for column in VERSIONS.c if contents or column.name != "content"]
    asked = sa.select(*columns).where(VERSIONS.c.document_id == document_id).order_by(VERSIONS.c.number)
    return [_version(row, row.content if contents else None) for row in connection.execute(asked)]


def _documents(kind: str, content: Any) -> sa.Select[Any]:
    own = VERSIONS.alias("own")
    of_document = own.c.document_id == DOCUMENTS.c.id
    count = sa.select(sa.func.count()).where(of_document).correlate(DOCUMENTS).scalar_subquery()
    newest = sa.select(sa.func.max(own.c.number)).where(of_document).correlate(DOCUMENTS).scalar_subquery()
    tags = sa.select(sa.func.aggregate_strings(DOCUMENT_TAGS.c.tag, _SEPARATOR))
    tags = tags.where(DOCUMENT_TAGS.c.document_id == DOCUMENTS.c.id).correlate(DOCUMENTS)
    told = [column for column in VERSIONS.c if column.name not in ("id", "document_id", "content")]
    is_newest = (VERSIONS.c.document_id == DOCUMENTS.c.id) & (VERSIONS.c.number == newest)
    return (
        sa.select(DOCUMENTS, *told, content, count.label("count"), tags.scalar_subquery().label("tags"))
        .select_from(DOCUMENTS.join(VERSIONS, is_newest))
        .where(DOCUMENTS.c.kind == kind)
    )


def _tagged(condition: sa.ColumnElement[bool]) -> sa.ColumnElement[bool]:
    return sa.exists().where(DOCUMENT_TAGS.c.document_id == DOCUMENTS.c.id, condition)


def _holds(word: str) -> sa.ColumnElement[bool]:
    texts = (DOCUMENTS.c.name, VERSIONS.c.note, VERSIONS.c.summary, VERSIONS.c.scenario, VERSIONS.c.author)
    any_version = VERSIONS.alias("any_version")
    labelled = sa.exists().where(
        any_version.c.document_id == DOCUMENTS.c.id, any_version.c.label.icontains(word, autoescape=True)
    )
    found = [text.icontains(word, autoescape=True) for text in texts]
    return sa.or_(*found, _tagged(DOCUMENT_TAGS.c.tag.icontains(word, autoescape=True)), labelled)


def _document(row: Any, content: str | None) -> Document:
    tags = tuple(sorted(row.tags.split(_SEPARATOR))) if row.tags else ()
    return Document(
        row.id,
        row.kind,
        row.name,
        row.created_at,
        row.archived_at,
        row.revision,
        tags,
        row.count,
        _version(row, content),
    )


def _version(row: Any, content: str | None) -> Version:
    return Version(row.number, row.saved_at, row.author, row.note, row.label, row.summary, row.scenario, content)
