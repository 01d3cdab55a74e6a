"""The tables of the first versions: presets without versions, and what ran last."""

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None


def upgrade() -> None:
    """Make them."""
    op.create_table(
        "presets",
        sa.Column("name", sa.String(80), primary_key=True),
        sa.Column("saved_at", sa.String(40), nullable=False),
        sa.Column("tuning", sa.Text, nullable=False),
    )
    op.create_table(
        "last",
        sa.Column("id", sa.Integer, primary_key=True),
        sa.Column("scenario", sa.Text, nullable=False),
        sa.Column("preset", sa.String(80), nullable=True),
    )
