"""Single values by key, as JSON: what the next start goes on with."""

import json
from typing import Any

import sqlalchemy as sa

from backend.store.database import Database
from backend.store.tables import KEPT
from backend.store.troubles import Clash


def get(database: Database, key: str) -> Any:
    """Return a kept value, None if there is none. Raises Problem."""
    with database.connect() as connection:
        text = connection.execute(sa.select(KEPT.c.value).where(KEPT.c.key == key)).scalar()
    return None if text is None else json.loads(text)


def put(database: Database, key: str, value: Any) -> None:
    """Keep a value in place of the old one. Raises Problem."""
    text = json.dumps(value, ensure_ascii=False)
    try:
        _put(database, key, text)
    except Clash:  # another server has just made it: now it is there to be replaced
        _put(database, key, text)


def _put(database: Database, key: str, text: str) -> None:
    with database.begin() as connection:
        if connection.execute(sa.update(KEPT).where(KEPT.c.key == key).values(value=text)).rowcount == 0:
            connection.execute(sa.insert(KEPT).values(key=key, value=text))
