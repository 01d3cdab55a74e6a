"""Schema, scenarios, simulations and the session's commands over REST."""

import json
from pathlib import Path
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Request, Response
from fastapi.responses import FileResponse
from pydantic import ValidationError
from starlette.background import BackgroundTask

from backend.api.caller import By, Key
from backend.compute.pool import JobFailedError, JobRefusedError, Pool
from backend.problem import Problem, from_validation, refused
from backend.session.session import Session
from vssea_core import __version__
from vssea_core.channels import CHANNELS, LIMITS
from vssea_core.scenario import Scenario
from vssea_core.scenarios import SCENARIOS

SIMULATION_LIMIT_S = 60.0
LARGEST_BODY = 1_000_000
Document = dict[str, Any]


async def content_of(request: Request, largest: int = LARGEST_BODY) -> bytes:
    """Return the body of a request. Raises Problem if it is larger than that."""
    parts, size = [], 0
    async for part in request.stream():
        size += len(part)
        if size > largest:
            raise Problem(413, "Too large", f"The body is larger than {largest} bytes; expected one JSON document.")
        parts.append(part)
    return b"".join(parts)


async def body_of(request: Request, largest: int = LARGEST_BODY) -> Any:
    """Return the JSON body of a request, {} if it is empty. Raises Problem."""
    content = await content_of(request, largest)
    if not content.strip():
        return {}
    try:
        return json.loads(content)
    except (ValueError, RecursionError) as error:
        raise Problem(400, "Not JSON", f"The body is not JSON: {error}.") from error


def resources(session: Session, pool: Pool, folder: str) -> APIRouter:
    """Return the REST routes; answers of simulations pass through files in `folder`."""
    router = APIRouter(prefix="/api")

    @router.get("/health")
    def health() -> Document:
        """Say that the server answers, and the session's state."""
        return {"status": "ok", "version": __version__, "session": session.status.state}

    @router.get("/schema")
    def schema() -> Document:
        """JSON schema of the scenario with units, ranges and sources; channels; commands; limits."""
        return {
            "scenario": Scenario.model_json_schema(),
            "channels": [channel._asdict() for channel in CHANNELS],
            "commands": session.command_names(),
            "limits": [limit._asdict() for limit in LIMITS],
        }

    @router.get("/scenarios")
    def scenarios() -> list[Document]:
        """Return the ready scenarios."""
        return [scenario.model_dump(mode="json") for scenario in SCENARIOS.values()]

    @router.get("/scenarios/{name}")
    def scenario(name: str) -> Document:
        """Return one ready scenario."""
        if name not in SCENARIOS:
            raise Problem(404, "No such scenario", f"There is no scenario {name!r}; known: {', '.join(SCENARIOS)}.")
        return SCENARIOS[name].model_dump(mode="json")

    @router.post("/simulate", openapi_extra=body_named(Scenario.__name__))
    async def simulate(
        request: Request,
        trajectory: Annotated[Literal["none", "json", "csv", "binary"], Query()] = "none",
        every: Annotated[int, Query(ge=1, le=100_000)] = 1,
        allow_unstable: Annotated[bool, Query()] = False,
    ) -> Response:
        """Simulate a scenario: metrics, and its trajectory as JSON, CSV or binary frames, every `every`-th sample."""
        document = await body_of(request)
        try:
            asked = Scenario.model_validate_json(json.dumps(document))
        except ValidationError as error:
            raise from_validation(error, Scenario) from error
        try:
            media_type, path = await pool.simulation.run(
                "simulate_to_file", asked, trajectory, every, allow_unstable, folder, time_limit_s=SIMULATION_LIMIT_S
            )
        except JobRefusedError as refusal:
            sentence = str(refusal)
            raise refused(f"{sentence[:1].upper()}{sentence[1:]}.") from refusal
        except JobFailedError as failure:
            raise Problem(503, "Not computed", f"The simulation could not be computed: {failure}.") from failure
        return FileResponse(path, media_type=media_type, background=BackgroundTask(Path(path).unlink, missing_ok=True))

    @router.get("/session")
    def snapshot() -> Document:
        """Return what the live session is doing."""
        return session.snapshot() | {"scenario": session.document()["scenario"]}

    @router.get("/session/events")
    def events(last: Annotated[int, Query(ge=1, le=500)] = 100) -> list[Document]:
        """Return the newest events, oldest first."""
        return session.log.last(last)

    @router.get("/session/history")
    def history(last: Annotated[int, Query(ge=1, le=200)] = 200) -> list[Document]:
        """Return the newest changes that were made, oldest first."""
        return session.history.last(last)

    @router.post("/session/{command}", openapi_extra=body_named("arguments of the command"))
    async def command(command: str, request: Request, by: By, key: Key) -> Document:
        """Run a command of the live session; docs/protocol.md lists them."""
        return await session.command(command, await body_of(request), by, key)

    return router


def body_named(title: str) -> Document:
    """Return what the API's documentation says of a body that a route reads by itself."""
    return {"requestBody": {"content": {"application/json": {"schema": {"type": "object", "title": title}}}}}
