"""The tables as the newest migration leaves them; a test compares the two."""

import sqlalchemy as sa

METADATA = sa.MetaData()

DOCUMENTS = sa.Table(
    "documents", METADATA,
    sa.Column("id", sa.Integer, primary_key=True),
    sa.Column("kind", sa.String(20), nullable=False),
    sa.Column("name", sa.String(80), nullable=False),
    sa.Column("created_at", sa.String(40), nullable=False),
    sa.Column("archived_at", sa.String(40)),
    sa.Column("revision", sa.Integer, nullable=False),
    sa.UniqueConstraint("kind", "name", name="documents_kind_name"),
)  # fmt: skip
VERSIONS = sa.Table(
    "versions", METADATA,
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
)  # fmt: skip
EDITS = sa.Table(
    "edits", METADATA,
    sa.Column("id", sa.Integer, primary_key=True),
    sa.Column("document_id", sa.Integer, sa.ForeignKey("documents.id"), nullable=False),
    sa.Column("revision", sa.Integer, nullable=False),
    sa.Column("version", sa.Integer, nullable=False),
    sa.Column("at", sa.String(40), nullable=False),
    sa.Column("author", sa.String(80), nullable=False),
    sa.Column("words", sa.Text, nullable=False),
    sa.UniqueConstraint("document_id", "revision", name="edits_document_revision"),
)  # fmt: skip
"""What each revision of a document was, and which version was then the newest: what a stale page is told."""
DOCUMENT_TAGS = sa.Table(
    "document_tags", METADATA,
    sa.Column("document_id", sa.Integer, sa.ForeignKey("documents.id"), primary_key=True),
    sa.Column("tag", sa.String(40), primary_key=True),
)  # fmt: skip
KEPT = sa.Table(
    "kept", METADATA, sa.Column("key", sa.String(40), primary_key=True), sa.Column("value", sa.Text, nullable=False)
)
RECORDINGS = sa.Table(
    "recordings", METADATA,
    sa.Column("id", sa.String(120), primary_key=True),
    sa.Column("name", sa.String(200), nullable=False),
    sa.Column("note", sa.Text, nullable=False),
    sa.Column("tags", sa.Text, nullable=False),
    sa.Column("starred", sa.Boolean, nullable=False),
    sa.Column("revision", sa.Integer, nullable=False),
    sa.Column("summary", sa.Text),
    sa.Column("added_at", sa.String(40), nullable=False),
)  # fmt: skip
EXCERPTS = sa.Table(
    "excerpts", METADATA,
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
)  # fmt: skip
BATCHES = sa.Table(
    "batches", METADATA,
    sa.Column("id", sa.String(40), primary_key=True),
    sa.Column("name", sa.String(80), nullable=False),
    sa.Column("key", sa.String(200), unique=True),
    sa.Column("digest", sa.String(64), nullable=False),
    sa.Column("state", sa.String(20), nullable=False),
    sa.Column("created_at", sa.String(40), nullable=False),
    sa.Column("started_at", sa.String(40)),
    sa.Column("ended_at", sa.String(40)),
    sa.Column("seconds", sa.Float, nullable=False),
    sa.Column("runs", sa.Integer, nullable=False),
    sa.Column("part_size", sa.Integer, nullable=False),
    sa.Column("summary", sa.Text, nullable=False),
    sa.Column("reason", sa.Text, nullable=False),
)  # fmt: skip
"""`key` and `digest` tell a batch that is asked for twice from another one; `summary` is what is known of it, as JSON."""
