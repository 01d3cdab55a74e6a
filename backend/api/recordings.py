"""Recordings over REST: listed, edited, drawn, exported, compared. Reading and computing happen in their workers."""

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Request, Response
from fastapi.responses import FileResponse
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from backend.api.reading import channels_in, document_of, limits_of, named_file, number_of, read, revision_of
from backend.api.resources import body_named, body_of
from backend.compute.pool import Pool
from backend.problem import Problem, from_validation
from backend.recordings.library import Library
from backend.scene.replay import ReplayScene
from backend.session.session import Session

EXPORT_LIMIT_S = 900.0
REPORT_POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"
MEDIA_TYPE = "application/x-mcap"
Document = dict[str, Any]
Seconds = Annotated[float | None, Query()]
Tag = Annotated[str, Field(min_length=1, max_length=40)]


class Edited(BaseModel):
    """What a PATCH may change."""

    model_config = ConfigDict(extra="forbid", strict=True)

    name: Annotated[str, Field(max_length=120)] = ""
    note: Annotated[str, Field(max_length=4000)] = ""
    tags: Annotated[list[Tag], Field(max_length=20)] = []
    starred: bool = False


def recording_routes(
    session: Session, pool: Pool, library: Library, replay: ReplayScene | None, folder: str
) -> APIRouter:
    """Return the routes that read and edit recordings; large answers pass through files in `folder`."""
    router = APIRouter(prefix="/api/recordings")
    worker, cache = pool.recordings, str(library.cache)

    @router.get("")
    async def listed(
        search: str = "",
        starred: bool | None = None,
        origin: Literal["live", "import", "simulation"] | None = None,
        limit: Annotated[int, Query(ge=1, le=500)] = 50,
        before: str | None = None,
    ) -> Document:
        """Return the recordings, newest first, with the disk and the recorder."""
        return await library.list(search, starred, origin, limit, before)

    @router.get("/{recording}")
    async def one(recording: str) -> Response:
        """Return one recording with its channels, tunings, events, commands and scenarios."""
        entry = await library.entry(recording)
        content = await read(worker.run("describe", str(library.path_of(recording)), entry))
        return Response(content, media_type="application/json", headers={"ETag": f'"{entry["revision"]}"'})

    @router.patch("/{recording}", openapi_extra=body_named("name, note, tags, starred"))
    async def edit(recording: str, request: Request, response: Response) -> Document:
        """Change name, note, tags or star."""
        library.path_of(recording)
        try:
            asked = Edited.model_validate(await body_of(request))
        except ValidationError as error:
            raise from_validation(error, Edited) from error
        changes = asked.model_dump(exclude_unset=True)
        if "tags" in changes:
            changes["tags"] = tuple(dict.fromkeys(changes["tags"]))
        entry = await library.edit(recording, changes, revision_of(request))
        response.headers["ETag"] = f'"{entry["revision"]}"'
        return entry

    @router.delete("/{recording}")
    async def delete(recording: str) -> Document:
        """Delete a recording that is neither starred nor being written."""
        await library.delete(recording)
        return {}

    @router.get("/{recording}/samples")
    async def samples(
        recording: str,
        channels: str,
        from_s: Seconds = None,
        to_s: Seconds = None,
        points: Annotated[int, Query(ge=4, le=20_000)] = 2000,
    ) -> Response:
        """Return samples for drawing, in binary: every one of a short span, extremes of a long one."""
        path = str(library.path_of(recording))
        job = worker.run("samples_of", path, channels_in(channels), *limits_of(from_s, to_s), points, cache)
        return Response(await read(job), media_type="application/octet-stream")

    @router.get("/{recording}/export")
    async def export(
        recording: str,
        form: Literal["csv", "parquet", "json", "mcap"] = "csv",
        channels: str = "",
        from_s: Seconds = None,
        to_s: Seconds = None,
    ) -> FileResponse:
        """Return a file to take home: whole or a span, all channels or some; a whole mcap is the recording's own file."""
        path = library.path_of(recording)
        if form == "mcap" and not channels and from_s is None and to_s is None:
            return FileResponse(path, media_type=MEDIA_TYPE, filename=path.name)
        names = channels_in(channels) or None
        limits = limits_of(from_s, to_s)
        job = pool.archive.run("export", str(path), form, names, *limits, folder, time_limit_s=EXPORT_LIMIT_S)
        media_type, file = await read(job)
        return named_file(file, media_type, f"{recording}.{form}")

    @router.get("/{recording}/spectrum")
    async def spectrum(recording: str, channels: str, from_s: Seconds = None, to_s: Seconds = None) -> Response:
        """Return power spectral densities of channels over a span."""
        path = str(library.path_of(recording))
        content = await read(pool.archive.run("spectrum_of", path, channels_in(channels), *limits_of(from_s, to_s)))
        return Response(content, media_type="application/json")

    @router.get("/{recording}/difference")
    async def difference(recording: str, against: str = "live", at_s: Seconds = None) -> Document:
        """Return what leads from its scenario, at a time or at its end, to another recording's or the live one."""
        path = str(library.path_of(recording))
        other = session.scenario if against == "live" else str(library.path_of(against))
        found: Document = await read(worker.run("differ", path, at_s, other))
        return found

    @router.get("/{recording}/reference")
    async def reference(
        recording: str, channel: str = "link_position", from_s: Seconds = None, to_s: Seconds = None
    ) -> Document:
        """Return a recorded course as a reference document, ready for set_reference."""
        path = str(library.path_of(recording))
        found: Document = await read(worker.run("reference_of", path, channel, *limits_of(from_s, to_s)))
        return found

    @router.get("/{recording}/report")
    async def report(recording: str) -> FileResponse:
        """Return the report: one HTML page that needs no other file."""
        path = str(library.path_of(recording))
        file = await read(pool.archive.run("report_of", path, folder, cache, time_limit_s=EXPORT_LIMIT_S))
        return named_file(file, "text/html; charset=utf-8", **{"Content-Security-Policy": REPORT_POLICY})

    @router.post("/{recording}/scene", openapi_extra=body_named("time_s"))
    async def scene(recording: str, request: Request) -> Document:
        """Let the scene at /replay/ show the pose of a time."""
        path = str(library.path_of(recording))
        time_s = number_of(document_of(await body_of(request), "time_s"), "time_s")
        if replay is None:
            raise Problem(409, "No scene", "The 3D scene is off (VSSEA_SCENE is false); start the server with it.")
        row = await read(worker.run("pose_at", path, time_s or 0.0))
        replay.show(row)
        return {"time_s": row[0]}

    return router
