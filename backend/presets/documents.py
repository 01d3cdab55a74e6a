"""Presets, or actuators, in the store. All methods block for a moment; the web process calls them in threads."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, TypeVar

import sqlalchemy as sa

from backend.differences import Difference, told
from backend.presets.contents import ActuatorContent, Kind, PresetContent
from backend.presets.found import Found, line
from backend.problem import Problem
from backend.store import listing, versioned
from backend.store.database import Database
from backend.store.document import Draft, Edit
from backend.store.expected import ANY, Expected, Stale
from backend.store.troubles import LOCKED, Clash

Content = PresetContent | ActuatorContent
Done = TypeVar("Done")
ATTEMPTS = 8


class Documents:
    """The documents of one kind. Every method raises Problem if the database cannot be used."""

    def __init__(self, database: Database, kind: Kind) -> None:
        self.database, self.kind = database, kind

    def list(self, search: str = "", tag: str = "", *, archived: bool = False) -> list[dict[str, Any]]:
        """Return what a search finds, newest first."""
        with self.database.connect() as connection:
            found = listing.listed(connection, self.kind.name, search, tag, archived=archived)
        return [line(document) for document in found]

    def get(self, name: str, number: int | None = None) -> Found:
        """Return a version, the newest without `number`. Raises Problem 404."""
        with self.database.connect() as connection:
            document = versioned.existing(connection, self.kind.name, name)
            version = document.newest if number is None else listing.version(connection, document.id, number)
        if version is None:
            raise Problem(
                404, "No such version", f"{self.kind.name.capitalize()} {name!r} has no version {number}; "
                f"expected 1 to {document.newest.number}."
            )  # fmt: skip
        return Found(self.kind, document, version).read()

    def answer(self, found: Found) -> dict[str, Any]:
        """Return a found version with the list of all versions."""
        with self.database.connect() as connection:
            versions = listing.versions(connection, found.document.id)
        return found.answer(versions)

    def put(
        self,
        name: str,
        content: Content,
        expected: Expected | None,
        author: str,
        note: str = "",
        tags: tuple[str, ...] | None = None,
    ) -> Found:
        """Keep a new version. Raises Problem 412 with what others changed, or 428 if a revision is needed."""
        draft = self.draft(content, author, note, tags)
        document = self.changed(
            lambda connection: versioned.put(connection, self.kind.name, name, draft, expected), expected
        )
        return Found(self.kind, document, document.newest).read()

    def edit(self, name: str, asked: Edit, expected: Expected | None, by: str) -> tuple[Found, str]:
        """Change what is said about a document; return it with the words of what changed. Raises Problem as `put`."""
        document, words = self.changed(
            lambda connection: versioned.edit(connection, self.kind.name, name, asked, expected, by), expected
        )
        return Found(self.kind, document, document.newest).read(), words

    def restore(self, name: str, number: int, expected: Expected | None, by: str) -> Found:
        """Make an old version's content the newest version. Raises Problem as `put`."""
        old = self.get(name, number)
        content = old.content
        if isinstance(content, PresetContent):
            provenance = content.provenance.model_copy(update={"source": "restored"})
            content = content.model_copy(update={"provenance": provenance})
        called = f" “{old.version.label}”" if old.version.label else ""
        return self.put(name, content, expected, by, f"version {number}{called} restored")

    def archive(self, name: str, expected: Expected | None, by: str) -> Found:
        """Take a document out of the list; it can be restored. Without `expected` whatever it is. Raises Problem as `put`."""
        return self.edit(name, Edit(archived=True), expected or ANY, by)[0]

    def draft(self, content: Content, author: str, note: str = "", tags: tuple[str, ...] | None = None) -> Draft:
        """Return content as it is kept."""
        scenario = content.scenario.name if isinstance(content, PresetContent) and content.scenario else None
        return Draft(content.model_dump_json(), self.kind.summary(content), scenario, author[:80], note, tags)

    def changed(self, change: Callable[[sa.Connection], Done], expected: Expected | None) -> Done:
        """Return what a change makes, in one transaction. Raises Problem 412 with what others changed.

        It is tried again if another server made the same document just now, and if any state will do.
        """
        for attempts_left in reversed(range(ATTEMPTS)):
            try:
                with self.database.begin() as connection:
                    return change(connection)
            except Stale as stale:
                if not attempts_left or expected is None or not expected.any:
                    raise self._stale(stale) from stale
            except Clash:
                if not attempts_left:
                    break
        raise replace(LOCKED)

    def _stale(self, stale: Stale) -> Problem:
        """Return the problem that says what others changed since the revision that the caller knows."""
        known = None
        with self.database.connect() as connection:
            document = listing.find(connection, self.kind.name, stale.document.name) or stale.document
            if stale.known is not None:
                known, edits = versioned.edits_since(connection, document.id, stale.known)
                old = known and listing.version(connection, document.id, known)
        newest = Found(self.kind, document, document.newest)
        current: dict[str, Any] = {
            "version": document.newest.number,
            "revision": document.revision,
            "etag": f'"{document.tag}"',
        }
        if known is None or not old:
            detail = f"There is a {self.kind.name} {document.name!r} already, at revision {document.revision}; nothing was saved."
            return Problem(412, "Changed meanwhile", detail, members={"current": current | {"changes": []}})
        changes = [each.words for each in _difference(Found(self.kind, document, old), newest)] + edits
        who = f" by {document.newest.author}" if document.newest.author and known != document.newest.number else ""
        made = (
            f"version {document.newest.number} was saved{who}" if known != document.newest.number else "it was edited"
        )
        what = f": {', '.join(changes)}" if changes else ""
        detail = (
            f"{self.kind.name.capitalize()} {document.name!r} has changed meanwhile, {made}{what}. Nothing was saved."
        )
        return Problem(412, "Changed meanwhile", detail, members={"current": current | {"changes": changes}})


def _difference(old: Found, new: Found) -> list[Difference]:
    return told(old.part, new.part) if old.fit.model and new.fit.model else []
