"""The routes that presets and actuators share: one list, versions with ETags, difference, files."""

import asyncio
import json
from collections.abc import Callable
from typing import Annotated, Any, TypeVar

from fastapi import APIRouter, Query, Request, Response
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from backend.api.caller import By
from backend.api.conditions import expected_of, tagged
from backend.api.resources import body_named, body_of
from backend.presets.comparison import compared
from backend.presets.contents import Note, PresetName, Tags
from backend.presets.documents import Content, Documents
from backend.presets.exchange import exported, keep, read
from backend.presets.found import Found
from backend.problem import from_validation
from backend.session.session import Session
from backend.store.document import Edit
from backend.store.expected import Expected

LARGEST_FILE = 4_000_000
Answer = dict[str, Any]
Asked = TypeVar("Asked", bound=BaseModel)
Label = Annotated[str, Field(max_length=120)]


class Named(BaseModel):
    """A name that an address may carry."""

    name: PresetName


class Saved(BaseModel):
    """What every PUT may say beside the content."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)

    note: Note = ""
    tags: Tags | None = None
    author: Annotated[str, Field(min_length=1, max_length=80)] | None = None


class Edited(BaseModel):
    """What a PATCH may change."""

    model_config = ConfigDict(extra="forbid")

    tags: Tags | None = None
    name: PresetName | None = None
    note: Note | None = None
    labels: dict[Annotated[int, Field(ge=1)], Label | None] | None = None
    archived: bool | None = Field(None, strict=True)


def checked(model: type[Asked], body: Any) -> Asked:
    """Return a body as `model`. Raises Problem."""
    try:
        return TypeAdapter(model).validate_json(json.dumps(body))
    except ValidationError as error:
        raise from_validation(error, model, consequence="Nothing was changed.") from error


def versioned_routes(
    session: Session, documents: Documents, saved: type[Asked], content_of: Callable[[Asked, str], Content]
) -> APIRouter:
    """Return the routes; `content_of` makes the content of what a PUT asked for, and by whom."""
    kind, router = documents.kind, APIRouter(prefix="/api")
    base = f"/{kind.plural}"

    @router.get(base)
    def listed(
        search: Annotated[str, Query(max_length=200)] = "",
        tag: Annotated[str, Query(max_length=40)] = "",
        archived: Annotated[bool, Query()] = False,
    ) -> list[Answer]:
        """Return what a search finds, newest first."""
        return documents.list(search, tag, archived=archived)

    @router.get(base + "-export")
    def export_all() -> Response:
        """Return all of them with all versions, in one file."""
        return _file(exported(documents, None, all_versions=True), kind.plural)

    @router.post(base + "/import", openapi_extra=body_named("an exported file"))
    async def import_file(
        request: Request,
        by: By,
        dry_run: Annotated[bool, Query()] = False,
        name: Annotated[str | None, Query(max_length=80)] = None,
    ) -> Answer:
        """Say what a file holds and which fields do not fit; keep it unless `dry_run`."""
        file = await body_of(request, LARGEST_FILE)
        found = await asyncio.to_thread(read, documents, file, name)
        if not dry_run:
            kept = await asyncio.to_thread(keep, documents, found, by)
            session.presets.imported(documents, kept, by)
        return {kind.plural: [each.document() for each in found], "kept": not dry_run}

    @router.get(base + "/{name}")
    def one(name: str, response: Response, version: Annotated[int | None, Query(ge=1)] = None) -> Answer:
        """Return a version, the newest unless another is named, and the list of all."""
        return _answered(documents.get(name, version), response)

    @router.put(base + "/{name}", openapi_extra=body_named("nothing, or what to save"))
    async def put(name: str, request: Request, response: Response, by: By) -> Answer:
        """Save what runs, or the body's content, as a new version."""
        known = checked(Named, {"name": name}).name
        expected = expected_of(request)
        asked: Any = checked(saved, await body_of(request))
        author = asked.author or by
        found = await session.presets.put(
            documents, known, content_of(asked, by), expected, by, author, asked.note, asked.tags
        )
        response.status_code = 201 if found.document.count == 1 else 200
        return await asyncio.to_thread(_answered, found, response)

    @router.patch(base + "/{name}", openapi_extra=body_named("tags, name, note, labels, archived"))
    async def patch(name: str, request: Request, response: Response, by: By) -> Answer:
        """Change what is said about a document."""
        expected, asked = expected_of(request), checked(Edited, await body_of(request))
        found = await session.presets.edit(documents, name, Edit(**dict(asked)), expected, by)
        return await asyncio.to_thread(_answered, found, response)

    @router.post(base + "/{name}/versions/{number}/restore")
    async def restore(name: str, number: int, request: Request, response: Response, by: By) -> Answer:
        """Make an old version's content the newest version."""
        found = await session.presets.restore(documents, name, number, expected_of(request), by)
        return await asyncio.to_thread(_answered, found, response)

    @router.delete(base + "/{name}")
    async def archive(name: str, request: Request, response: Response, by: By) -> Answer:
        """Archive: out of the list, and nothing of it lost."""
        expected: Expected | None = expected_of(request)
        found = await session.presets.archive(documents, name, expected, by)
        return await asyncio.to_thread(_answered, found, response)

    @router.get(base + "/{name}/difference")
    def difference(
        name: str,
        version: Annotated[int | None, Query(ge=1)] = None,
        against: Annotated[str, Query(max_length=80)] = "live",
    ) -> Answer:
        """Return what leads from what runs, another version or another document to a version."""
        return compared(documents, name, version, against, getattr(session.scenario, kind.part)).document()

    @router.get(base + "/{name}/export")
    def export(name: str, versions: Annotated[str, Query(pattern="^(all|newest)$")] = "all") -> Response:
        """Return one document as a file."""
        return _file(exported(documents, name, all_versions=versions == "all"), name)

    def _answered(found: Found, response: Response) -> Answer:
        tagged(response, found.document)
        return documents.answer(found)

    def _file(text: str, name: str) -> Response:
        plain = "".join(letter if letter.isascii() and (letter.isalnum() or letter in "-_") else "_" for letter in name)
        file = f"vssea-{kind.name}-{plain}.json" if name != kind.plural else f"vssea-{kind.plural}.json"
        disposition = f'attachment; filename="{file}"'
        return Response(text, media_type="application/json", headers={"Content-Disposition": disposition})

    return router
