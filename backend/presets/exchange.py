"""Presets and actuators as files to hand on: written whole, read with every field named that does not fit."""

import json
from dataclasses import dataclass, field, replace
from typing import Any

import sqlalchemy as sa
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from backend.presets.contents import Note, PresetName, Tags
from backend.presets.documents import Documents
from backend.presets.fitting import Fit, fitted
from backend.presets.found import Found
from backend.problem import from_validation, refused
from backend.store import listing, versioned
from backend.store.document import Document, Edit, Version
from backend.store.expected import ANY
from backend.store.versioned import now
from vssea_core import __version__
from vssea_core.field_errors import FieldError, sentence_of

SCHEMA = 1
"""Counted when the form of the file changes; fields of the content may come and go without it."""


class FileVersion(BaseModel):
    """One version in a file; only its content is needed."""

    model_config = ConfigDict(extra="ignore")

    number: int | None = Field(None, ge=1)
    saved_at: str | None = Field(None, max_length=40)
    author: str = Field("", max_length=80)
    note: Note = ""
    label: str | None = Field(None, max_length=120)
    content: Any = None


class FileDocument(BaseModel):
    """One document in a file."""

    model_config = ConfigDict(extra="ignore")

    name: PresetName
    tags: Tags = ()
    archived: bool = False
    versions: list[FileVersion] = Field(min_length=1, max_length=100_000)


@dataclass
class Incoming:
    """One document of a file with how its versions fit."""

    file: FileDocument
    fits: list[Fit[Any]]
    exists: bool = False
    new: list[int] = field(default_factory=list)  # which of its versions are not yet kept

    def document(self) -> dict[str, Any]:
        """Return what was found in the file, as JSON takes it."""
        return {
            "name": self.file.name, "versions": len(self.fits), "new": len(self.new), "exists": self.exists,
            "tags": list(self.file.tags),
            "unknown": _once(name for fit in self.fits for name in fit.unknown),
            "missing": _once(name for fit in self.fits for name in fit.missing),
            "refused": [{"field": e.field, "value": e.value, "message": e.message} for fit in self.fits for e in fit.refused],
        }  # fmt: skip


def exported(documents: Documents, name: str | None, *, all_versions: bool) -> str:
    """Return the file of one document, or of all without `name`, as readable JSON. Raises Problem 404."""
    kind = documents.kind.name
    with documents.database.connect() as connection:
        if name is None:
            chosen = [
                d
                for archived in (False, True)
                for d in listing.listed(connection, kind, archived=archived, contents=True)
            ]
        else:
            chosen = [versioned.existing(connection, kind, name)]
        pieces = []
        for document in sorted(chosen, key=lambda each: each.name):
            versions = listing.versions(connection, document.id, contents=True) if all_versions else [document.newest]
            pieces.append(json.dumps(_written(document, versions), ensure_ascii=False, indent=1))
    head = {"format": f"vssea-{kind}", "schema": SCHEMA, "vssea": __version__, "exported_at": now()}
    start = json.dumps(head, ensure_ascii=False, indent=1)[:-2]
    return f'{start},\n "{documents.kind.plural}": [{",".join(pieces)}]\n}}\n'


def read(documents: Documents, file: Any, name: str | None = None) -> list[Incoming]:
    """Return what a file holds; `name` is for a content without one. Raises Problem 422 if it is no such file."""
    incoming = []
    for place, entry in enumerate(_entries(documents, file, name)):
        try:
            document = FileDocument.model_validate(entry)
        except ValidationError as error:
            raise from_validation(
                error, FileDocument, f"{documents.kind.plural}.{place}", "Nothing was imported."
            ) from error
        fits = [fitted(version.content, documents.kind.model) for version in document.versions]
        incoming.append(Incoming(document, fits))
    with documents.database.connect() as connection:
        for each in incoming:
            _look(each, connection, documents.kind.name)
    return incoming


def keep(documents: Documents, incoming: list[Incoming], by: str) -> list[Found]:
    """Keep every version that is not kept yet, all in one step. Raises Problem 422 if a field of any is refused."""
    errors = [
        FieldError(f"{each.file.name}: {error.field}", error.value, error.message)
        for each in incoming
        for fit in each.fits
        for error in fit.refused
    ]
    if errors:
        raise refused(f"What does not fit: {sentence_of(errors)}. Nothing was imported.", *errors)
    kept = documents.changed(lambda connection: _kept(documents, connection, incoming, by), ANY)
    return [Found(documents.kind, document, document.newest).read() for document in kept]


def _kept(documents: Documents, connection: sa.Connection, incoming: list[Incoming], by: str) -> list[Document]:
    kind, kept = documents.kind.name, []
    for each in incoming:
        for place in each.new:
            version, content = each.file.versions[place], each.fits[place].model
            if content is None:
                continue  # told above
            draft = documents.draft(
                content, version.author or by, version.note, None if each.exists else each.file.tags
            )
            draft = replace(draft, saved_at=version.saved_at, label=version.label, number=version.number)
            document = versioned.put(connection, kind, each.file.name, draft, ANY)
        if each.new:
            if each.file.archived and not each.exists:
                document = versioned.edit(connection, kind, each.file.name, Edit(archived=True), ANY, by)[0]
            kept.append(document)
    return kept


def _entries(documents: Documents, file: Any, name: str | None) -> list[Any]:
    kind = documents.kind
    if isinstance(file, list):
        return [entry for each in file for entry in _entries(documents, each, name)]
    if not isinstance(file, dict):
        raise refused(
            f"The file is no {kind.name}; expected an object with {kind.plural}, or with a name and a {kind.part}."
        )
    if "format" in file and file["format"] != f"vssea-{kind.name}":
        error = FieldError("format", str(file["format"]), f"expected vssea-{kind.name}")
        raise refused(
            f"The file is not of {kind.plural}: its format is {file['format']!r}; expected vssea-{kind.name}.", error
        )
    schema = file.get("schema", SCHEMA)
    if not isinstance(schema, int) or schema > SCHEMA:
        error = FieldError("schema", schema if isinstance(schema, int) else str(schema), f"expected at most {SCHEMA}")
        raise refused(f"The file is of a newer version: its schema is {schema!r}; expected at most {SCHEMA}.", error)
    if kind.plural in file:
        entries = file[kind.plural]
        return entries if isinstance(entries, list) else [entries]
    if "versions" in file and isinstance(file["versions"], list):
        return [file]
    # By hand, or as the first versions listed them: a name with the content's own parts.
    own = {part: file[part] for part in kind.model.model_fields if part in file}
    if kind.part not in own and kind.part == "tuning" and "controller" in file:
        own = {"tuning": {part: value for part, value in file.items() if part not in ("name", "note", "tags")}}
    if kind.part not in own:
        raise refused(
            f"The file holds no {kind.part}; expected an object with {kind.plural}, or with a name and a {kind.part}."
        )
    version = {"content": own, "saved_at": file.get("saved_at"), "note": file.get("note", "")}
    return [{"name": file.get("name", name), "tags": file.get("tags", []), "versions": [version]}]


def _look(incoming: Incoming, connection: Any, kind: str) -> None:
    document = listing.find(connection, kind, incoming.file.name)
    held = listing.versions(connection, document.id, contents=True) if document else []
    incoming.exists = document is not None
    known = {(version.saved_at, version.content) for version in held} | {(None, version.content) for version in held}
    for place, (version, fit) in enumerate(zip(incoming.file.versions, incoming.fits, strict=True)):
        if fit.model is None or (version.saved_at, fit.model.model_dump_json()) not in known:
            incoming.new.append(place)


def _written(document: Document, versions: list[Version]) -> dict[str, Any]:
    return {
        "name": document.name,
        "tags": list(document.tags),
        "archived": document.archived_at is not None,
        "versions": [
            {
                "number": version.number, "saved_at": version.saved_at, "author": version.author, "note": version.note,
                "label": version.label, "content": json.loads(version.content or "null"),
            }
            for version in versions
        ],
    }  # fmt: skip


def _once(names: Any) -> list[str]:
    return list(dict.fromkeys(names))
