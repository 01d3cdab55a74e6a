"""A versioned document as it is kept: what it is called, at which revision it is, and its versions."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Version:
    """One saved state; `content` is JSON, None where it was not read."""

    number: int
    saved_at: str
    author: str
    note: str
    label: str | None
    summary: str
    scenario: str | None
    content: str | None = None


@dataclass(frozen=True)
class Document:
    """A name with its newest version."""

    id: int
    kind: str
    name: str
    created_at: str
    archived_at: str | None
    revision: int
    tags: tuple[str, ...]
    count: int
    newest: Version

    @property
    def tag(self) -> str:
        """What stands in the ETag: never the same for two states, even if a name is used again."""
        return f"{self.id}-{self.revision}"


@dataclass(frozen=True)
class Draft:
    """A version to be; without `saved_at` of now, without `tags` the document keeps those that it has."""

    content: str
    summary: str
    scenario: str | None
    author: str
    note: str = ""
    tags: tuple[str, ...] | None = None
    label: str | None = None
    saved_at: str | None = None
    number: int | None = None


@dataclass(frozen=True)
class Edit:
    """What to change about a document; None leaves it. `labels` is by version number, a label of None takes it away."""

    tags: tuple[str, ...] | None = None
    name: str | None = None
    note: str | None = None
    labels: dict[int, str | None] | None = None
    archived: bool | None = None
