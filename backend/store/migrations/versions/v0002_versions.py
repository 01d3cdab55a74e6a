"""Versioned documents, kept values, recordings and excerpts; the old presets and the last run move into them.

The words about an old preset are made here, and not by today's code: a migration must do in ten years what it does now.
"""

import json
from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"


def upgrade() -> None:
    """Make the tables, move what there is, and drop the old ones."""
    tables = _create()
    connection = op.get_bind()
    if "presets" in sa.inspect(connection).get_table_names():
        _move_presets(connection, *tables)
        op.drop_table("presets")
    if "last" in sa.inspect(connection).get_table_names():
        _move_last(connection, tables[-1])
        op.drop_table("last")


def _create() -> tuple[sa.Table, ...]:
    documents = op.create_table(
        "documents",
        sa.Column("id", sa.Integer, primary_key=True),
        sa.Column("kind", sa.String(20), nullable=False),
        sa.Column("name", sa.String(80), nullable=False),
        sa.Column("created_at", sa.String(40), nullable=False),
        sa.Column("archived_at", sa.String(40)),
        sa.Column("revision", sa.Integer, nullable=False),
        sa.UniqueConstraint("kind", "name", name="documents_kind_name"),
    )
    versions = op.create_table(
        "versions",
        sa.Column("id", sa.Integer, primary_key=True),
        sa.Column("document_id", sa.Integer, sa.ForeignKey("documents.id"), nullable=False),
        sa.Column("number", sa.Integer, nullable=False),
        sa.Column("saved_at", sa.String(40), nullable=False),
        sa.Column("author", sa.String(80), nullable=False),
        sa.Column("note", sa.Text, nullable=False),
        sa.Column("label", sa.String(120)),
        sa.Column("summary", sa.Text, nullable=False),
        sa.Column("scenario", sa.String(80)),
        sa.Column("content", sa.Text, nullable=False),
        sa.UniqueConstraint("document_id", "number", name="versions_document_number"),
    )
    edits = op.create_table(
        "edits",
        sa.Column("id", sa.Integer, primary_key=True),
        sa.Column("document_id", sa.Integer, sa.ForeignKey("documents.id"), nullable=False),
        sa.Column("revision", sa.Integer, nullable=False),
        sa.Column("version", sa.Integer, nullable=False),
        sa.Column("at", sa.String(40), nullable=False),
        sa.Column("author", sa.String(80), nullable=False),
        sa.Column("words", sa.Text, nullable=False),
        sa.UniqueConstraint("document_id", "revision", name="edits_document_revision"),
    )
    op.create_table(
        "document_tags",
        sa.Column("document_id", sa.Integer, sa.ForeignKey("documents.id"), primary_key=True),
        sa.Column("tag", sa.String(40), primary_key=True),
    )
    kept = op.create_table(
        "kept", sa.Column("key", sa.String(40), primary_key=True), sa.Column("value", sa.Text, nullable=False)
    )
    op.create_table(
        "recordings",
        sa.Column("id", sa.String(120), primary_key=True),
        sa.Column("name", sa.String(200), nullable=False),
        sa.Column("note", sa.Text, nullable=False),
        sa.Column("tags", sa.Text, nullable=False),
        sa.Column("starred", sa.Boolean, nullable=False),
        sa.Column("revision", sa.Integer, nullable=False),
        sa.Column("summary", sa.Text),
        sa.Column("added_at", sa.String(40), nullable=False),
    )
    op.create_table(
        "excerpts",
        sa.Column("id", sa.Integer, primary_key=True),
        sa.Column("recording", sa.String(120), index=True),
        sa.Column("kind", sa.String(20), nullable=False),
        sa.Column("label", sa.String(200), nullable=False),
        sa.Column("from_s", sa.Float, nullable=False),
        sa.Column("to_s", sa.Float, nullable=False),
        sa.Column("at_s", sa.Float),
        sa.Column("by", sa.String(80), nullable=False),
        sa.Column("created_at", sa.String(40), nullable=False),
        sa.Column("shown", sa.Boolean, nullable=False),
        sa.Column("data", sa.Text),
    )
    return documents, versions, edits, kept


def _move_presets(
    connection: sa.Connection, documents: sa.Table, versions: sa.Table, edits: sa.Table, _: sa.Table
) -> None:
    for row in connection.execute(sa.text("SELECT name, saved_at, tuning FROM presets ORDER BY saved_at, name")).all():
        values = {"kind": "preset", "name": row.name, "created_at": row.saved_at, "revision": 1}
        document_id = connection.execute(sa.insert(documents).values(values).returning(documents.c.id)).scalar_one()
        number = {
            "document_id": document_id,
            "number": 1,
            "saved_at": row.saved_at,
            "author": "",
            "note": "",
            "scenario": None,
        }
        tuning = _read(row.tuning)
        provenance = {"source": "live", "vssea": "", "recording": None, "at_s": None, "by": ""}
        content = json.dumps({"tuning": tuning, "scenario": None, "provenance": provenance}, ensure_ascii=False)
        connection.execute(sa.insert(versions).values(number | {"summary": _summary(tuning), "content": content}))
        edit = {"document_id": document_id, "revision": 1, "version": 1, "at": row.saved_at, "author": "", "words": ""}
        connection.execute(sa.insert(edits).values(edit))


def _move_last(connection: sa.Connection, kept: sa.Table) -> None:
    row = connection.execute(sa.text("SELECT scenario, preset FROM last")).first()
    if row is None:
        return
    preset = None if row.preset is None else {"name": row.preset, "version": 1}
    value = json.dumps({"scenario": _read(row.scenario), "preset": preset}, ensure_ascii=False)
    connection.execute(sa.insert(kept).values(key="last", value=value))


def _read(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return text  # moved as it is: what cannot be read today may be mended by hand


def _summary(tuning: Any) -> str:
    parts = []
    for part, name, words in (("controller", "natural_frequency", "poles "), ("observer", "bandwidth", "")):
        found = tuning.get(part) if isinstance(tuning, dict) else None
        if not isinstance(found, dict) or not isinstance(kind := found.get("kind"), str):
            continue
        value = found.get(name)
        figure = f"{words}{value:g} rad/s" if isinstance(value, int | float) and not isinstance(value, bool) else ""
        noun = kind.replace("_", " ") + (" observer" if part == "observer" else "")
        parts.append(f"{noun}{', ' if figure and words else ' ' if figure else ''}{figure}")
    return "; ".join(parts)
