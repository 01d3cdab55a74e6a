"""What whoever edits a document believes it to be: the HTTP preconditions, and what becomes of one that does not hold."""

from dataclasses import dataclass

from backend.problem import Problem
from backend.store.document import Document


@dataclass(frozen=True)
class Expected:
    """That the document is new, or that its revision is one of these (as ETag `12-3`, or as the bare revision `3`)."""

    is_new: bool = False
    revisions: frozenset[str] = frozenset()
    any: bool = False

    @classmethod
    def revision(cls, revision: int | None) -> "Expected | None":
        """Expect a bare revision; None expects nothing, which only a new document allows."""
        return None if revision is None else cls(revisions=frozenset({str(revision)}))

    def holds_for(self, document: Document) -> bool:
        """Return whether an existing document is what was expected."""
        return not self.is_new and (self.any or not self.revisions.isdisjoint({document.tag, str(document.revision)}))

    @property
    def known_revision(self) -> int | None:
        """The revision that was believed to be the newest, None if none was named."""
        numbers = [text.rsplit("-", 1)[-1] for text in self.revisions]
        return max((int(text) for text in numbers if text.isdecimal()), default=None)


NEW = Expected(is_new=True)
ANY = Expected(any=True)


@dataclass
class Stale(Exception):
    """The document is not what was expected: it exists, or was edited since revision `known`."""

    document: Document
    known: int | None


def check(document: Document, expected: Expected | None) -> None:
    """Raise Stale if a document that exists is not what was expected, Problem 428 if nothing was said."""
    if expected is None:
        raise Problem(
            428,
            "Revision needed",
            f"There is a {document.kind} {document.name!r} already, at revision {document.revision}. Say which revision you "
            f'change, with If-Match: "{document.tag}" or "revision": {document.revision}; else changes of others would be lost.',
        )
    if not expected.holds_for(document):
        raise Stale(document, expected.known_revision)
