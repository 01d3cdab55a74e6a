"""Rigs over REST: their files, and a look at one that changes nothing. Connecting is a command of the session."""

import asyncio
from typing import Any

from fastapi import APIRouter, Request, Response

from backend.api.caller import By
from backend.compute.pool import JobFailedError, JobRefusedError, Pool
from backend.problem import Problem
from backend.rigs.library import RigLibrary
from backend.rigs.rig_file import RigFile
from backend.session.rig_tuning import actuator_of
from backend.session.session import Session

LARGEST_FILE = 100_000
CHECK_LIMIT_S = 30.0
Document = dict[str, Any]


def rig_routes(session: Session, pool: Pool, library: RigLibrary) -> APIRouter:
    """Return the routes; what waits for a disk or a bus waits in a thread or a process."""
    router = APIRouter(prefix="/api")

    @router.get("/rigs")
    async def listed() -> Document:
        """Return all rigs: the built-in ones, and those in the data folder."""
        return {"rigs": [entry.document() for entry in await asyncio.to_thread(library.list)]}

    @router.get("/rigs/{name}")
    async def one(name: str) -> Document:
        """Return one rig, with the text of its file."""
        entry = await asyncio.to_thread(library.get, name)
        return entry.document() | {"text": entry.text}

    @router.put("/rigs/{name}", openapi_extra={"requestBody": {"content": {"application/toml": {}}}})
    async def put(name: str, request: Request, by: By) -> Document:
        """Keep a rig's file; the body is TOML, and a file that is not right is refused with the reason."""
        _refuse_connected(session, name, "changed")
        text = await _text_of(request)
        entry = await asyncio.to_thread(library.put, name, text)
        session.note("rig", f"file of rig {name} saved", by)
        return entry.document() | {"text": entry.text}

    @router.delete("/rigs/{name}", status_code=204)
    async def delete(name: str, by: By) -> Response:
        """Delete a rig's file; the built-in ones stay."""
        _refuse_connected(session, name, "deleted")
        await asyncio.to_thread(library.delete, name)
        session.note("rig", f"file of rig {name} deleted", by)
        return Response(status_code=204)

    @router.post("/rigs/{name}/check")
    async def check(name: str) -> Document:
        """Open the rig's bus, compare who answers with its file, and close it; nothing is written and nothing moves."""
        rig = await asyncio.to_thread(library.file, name)
        actuator = await asyncio.to_thread(actuator_of, session, rig)
        if session.rig.file is not None:
            in_use = f"Rig {session.rig.name} is connected, and its bus is in use; disconnect it first."
            raise Problem(409, "Rig connected", in_use)
        async with session.rig.connection.bus:
            lines = await _checked(pool, rig, actuator.motor.gear_ratio)
        return {"ok": all(line["ok"] for line in lines), "lines": lines}

    return router


async def _checked(pool: Pool, rig: RigFile, gear_ratio: float) -> list[Document]:
    try:
        lines: list[Document] = await pool.rig_check.run("check", rig, gear_ratio, time_limit_s=CHECK_LIMIT_S)
    except (JobRefusedError, JobFailedError) as failure:
        raise Problem(503, "Not checked", f"The rig could not be checked: {failure}.") from failure
    finally:
        await pool.rig_check.stop()  # it holds libraries that nobody else needs
    return lines


def _refuse_connected(session: Session, name: str, what: str) -> None:
    if session.rig.file is not None and session.rig.name == name:
        raise Problem(409, "Rig connected", f"The file of rig {name} cannot be {what} while it is connected.")


async def _text_of(request: Request) -> str:
    content = b""
    async for part in request.stream():
        content += part
        if len(content) > LARGEST_FILE:
            raise Problem(
                413, "Too large", f"The body is larger than {LARGEST_FILE} bytes; expected a rig's TOML file."
            )
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError as error:
        raise Problem(400, "Not text", f"The body is not UTF-8 text: {error}.") from error
