"""One client of a store that counts up a number in one document: `python -m tests.backend.counting URL TIMES`."""

import json
import sys

from backend.problem import Problem
from backend.store import listing, versioned
from backend.store.database import Database
from backend.store.document import Draft
from backend.store.expected import Expected, Stale
from backend.store.troubles import LOCKED

NAME = "counter"


def draft(count: int, author: str = "client") -> Draft:
    return Draft(json.dumps({"count": count}), f"counts {count}", None, author)


def read(database: Database) -> tuple[int, Expected]:
    """The number, and the expectation that nobody changes it meanwhile."""
    with database.connect() as connection:
        document = versioned.existing(connection, "preset", NAME)
    return json.loads(document.newest.content or "")["count"], Expected(revisions=frozenset({document.tag}))


def count_up(url: str, times: int) -> int:
    """Add one `times` times, trying again whenever another client was faster or held the lock; return how often that was."""
    database, refused = Database(url), 0
    try:
        for _ in range(times):
            while True:
                try:
                    count, expected = read(database)
                    with database.begin() as connection:
                        versioned.put(connection, "preset", NAME, draft(count + 1), expected)
                    break
                except Stale:
                    refused += 1
                except Problem as problem:
                    if problem.title != LOCKED.title:
                        raise
                    refused += 1
    finally:
        database.close()
    return refused


def numbers(database: Database) -> list[int]:
    """What every version held, oldest first."""
    with database.connect() as connection:
        document = versioned.existing(connection, "preset", NAME)
        versions = listing.versions(connection, document.id, contents=True)
    return [json.loads(version.content or "")["count"] for version in versions]


if __name__ == "__main__":
    print(count_up(sys.argv[1], int(sys.argv[2])))  # noqa: T201
