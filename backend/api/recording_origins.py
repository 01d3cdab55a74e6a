"""Recordings that do not come from the live session, over REST: imported logs, and the same scenario simulated."""

import asyncio
import json
import uuid
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request

from backend.api.reading import document_of, number_of, read
from backend.api.resources import body_named, body_of
from backend.compute.exchange import Hearer
from backend.compute.pool import JobCancelledError, Pool
from backend.problem import Problem, refused
from backend.recordings.layout import FORMAT
from backend.recordings.library import Library
from backend.tasks.tasks import Tasks
from vssea_core import __version__
from vssea_core.field_errors import FieldError

LARGEST_LOG = 500_000_000
PIECE = 1_000_000
IMPORT_LIMIT_S = 600.0
SIMULATION_LIMIT_S = 300.0
Document = dict[str, Any]


def recording_origin_routes(pool: Pool, tasks: Tasks, library: Library, folder: str) -> APIRouter:
    """Return the routes; what is on its way is kept in `folder`."""
    router = APIRouter(prefix="/api/recordings")

    @router.post(
        "/import",
        openapi_extra={"requestBody": {"content": {"text/csv": {"schema": {"type": "string", "title": "CSV"}}}}},
    )
    async def imported(
        request: Request,
        name: Annotated[str, Query(max_length=120)] = "",
        columns: str | None = None,
        sample_rate_hz: float | None = None,
        dry_run: bool = False,
    ) -> Document:
        """Keep a rig's own log as a recording; with dry_run say what would be read."""
        mapping = _mapping(columns)
        log = await _uploaded(request, folder)
        try:
            if dry_run:
                found: Document = await read(pool.archive.run("preview_csv", log, mapping, sample_rate_hz))
                return found
            head = _head(name)
            target = str(library.folder / f"{head['id']}.mcap")
            job = pool.archive.run(
                "import_csv", log, target, head, mapping, sample_rate_hz, time_limit_s=IMPORT_LIMIT_S
            )
            await read(job)
        finally:
            await asyncio.to_thread(Path(log).unlink, missing_ok=True)
        library.added(head["id"])
        return await library.entry(head["id"])

    @router.post("/{recording}/simulate", status_code=202, openapi_extra=body_named("to_s"))
    async def simulate(recording: str, request: Request) -> Document:
        """Simulate the scenario of a recording with its live changes, and keep it beside it; a task."""
        path = str(library.path_of(recording))
        to_s = number_of(document_of(await body_of(request), "to_s"), "to_s")
        scenario, tuning_id = await read(pool.recordings.run("plan_replay", path, to_s))
        target = library.folder / f"{recording}-simulated.mcap"
        is_unwanted = asyncio.Event()

        async def work(hear: Hearer) -> bytes:
            hear(0.1, "simulating")
            rows = await pool.simulation.run(
                "simulate_rows", scenario, tuning_id, folder, time_limit_s=SIMULATION_LIMIT_S
            )
            try:
                if is_unwanted.is_set():
                    raise JobCancelledError("the simulation was cancelled")
                hear(0.7, "comparing")
                job = pool.archive.run("keep_simulated", path, scenario, tuning_id, rows, str(target))
                result: bytes = await job
            finally:
                await asyncio.to_thread(Path(rows).unlink, missing_ok=True)
            library.added(target.stem)
            return result

        return tasks.ask_work("simulate_recording", f"{recording}, simulated", work, is_unwanted.set).document()

    return router


def _head(name: str) -> dict[str, str]:
    now = datetime.now(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")
    return {
        "id": f"{now.replace(':', '-').replace('.', '-')}-import", "format": FORMAT, "vssea": __version__, "begun_at": now,
        "rig": "unknown", "name": name, "scenario": "",
    }  # fmt: skip


def _mapping(columns: str | None) -> dict[str, dict[str, Any]] | None:
    if columns is None:
        return None
    try:
        mapping = json.loads(columns)
    except (ValueError, RecursionError) as error:
        raise refused(f"columns is not JSON: {error}.", FieldError("columns", columns, f"not JSON: {error}")) from error
    if not isinstance(mapping, dict) or not all(isinstance(asked, dict) for asked in mapping.values()):
        expected = 'expected {"a heading": {"channel": "link_position", "factor": 0.01745}}'
        raise refused(f"columns is not a mapping of headings; {expected}.", FieldError("columns", columns, expected))
    return mapping


async def _uploaded(request: Request, folder: str) -> str:
    """Return the path of a new file in `folder` with the body of a request. Raises Problem if it is too large."""
    log = Path(folder) / f"{uuid.uuid4().hex}.log"
    size, piece = 0, bytearray()
    try:
        async for part in request.stream():
            size, piece = size + len(part), piece + part
            if size > LARGEST_LOG:
                raise Problem(413, "Too large", f"The log is larger than {LARGEST_LOG} bytes; import it in parts.")
            if len(piece) >= PIECE:
                await asyncio.to_thread(_append, log, bytes(piece))
                piece.clear()
        await asyncio.to_thread(_append, log, bytes(piece))
    except BaseException:
        await asyncio.to_thread(log.unlink, missing_ok=True)
        raise
    return str(log)


def _append(path: Path, content: bytes) -> None:
    with path.open("ab") as file:
        file.write(content)
