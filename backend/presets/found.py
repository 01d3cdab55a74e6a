"""A version as it was found: what is kept, and how this program reads it."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from pydantic import BaseModel

from backend.presets.contents import Kind
from backend.presets.fitting import Fit, fitted
from backend.problem import refused
from backend.store.document import Document, Version


@dataclass(frozen=True)
class Found:
    """A document with one of its versions."""

    kind: Kind
    document: Document
    version: Version

    @cached_property
    def raw(self) -> Any:
        """The content as it was saved."""
        return json.loads(self.version.content or "null")

    @cached_property
    def fit(self) -> Fit[Any]:
        """The content as this version of the program reads it."""
        return fitted(self.raw, self.kind.model)

    def read(self) -> "Found":
        """Return itself with the content read: in the thread that found it, not where it is shown."""
        _ = self.fit
        return self

    @property
    def content(self) -> Any:
        """The content's model. Raises Problem if a field of it no longer fits."""
        if self.fit.model is None:
            first = self.fit.refused[0]
            raise refused(
                f"Version {self.version.number} of {self.kind.name} {self.document.name!r} was saved by another version of the "
                f"program and does not fit this one: {first.field}, {first.message.rstrip('.')}. Nothing was changed.",
                *self.fit.refused,
            )
        return self.fit.model

    @property
    def part(self) -> BaseModel:
        """What is compared and applied. Raises Problem as `content`."""
        part: BaseModel = getattr(self.content, self.kind.part)
        return part

    def answer(self, versions: Sequence[Version]) -> dict[str, Any]:
        """Return it as REST does, with all versions that there are."""
        return line(self.document, self.version) | {
            "content": self.raw,
            "fit": self.fit.document(),
            "versions": [_brief(version) for version in versions],
        }


def line(document: Document, version: Version | None = None) -> dict[str, Any]:
    """Return a document as a list shows it."""
    shown = version or document.newest
    return {
        "name": document.name, "version": shown.number, "saved_at": shown.saved_at, "author": shown.author, "note": shown.note,
        "tags": list(document.tags), "label": shown.label, "revision": document.revision, "etag": f'"{document.tag}"',
        "versions": document.count, "summary": shown.summary, "scenario": shown.scenario,
        "archived": document.archived_at is not None,
    }  # fmt: skip


def _brief(version: Version) -> dict[str, Any]:
    return {
        "number": version.number, "saved_at": version.saved_at, "author": version.author, "note": version.note,
        "label": version.label, "summary": version.summary, "scenario": version.scenario,
    }  # fmt: skip
