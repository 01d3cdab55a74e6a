"""The tuned controller for use elsewhere, over REST: of any scenario, or of the live session."""

import json
from typing import Annotated, Literal

from fastapi import APIRouter, Query, Request, Response
from pydantic import ValidationError

from backend.api.resources import body_of
from backend.compute.pool import JobFailedError, JobRefusedError, Pool
from backend.problem import Problem, from_validation, refused
from backend.session.session import Session
from vssea_core.scenario import Scenario

EXPORT_LIMIT_S = 60.0
Form = Annotated[Literal["json", "mat", "c"], Query()]
FILES = {"json": "controller.json", "mat": "controller.mat", "c": "vssea_controller.zip"}


def export(session: Session, pool: Pool) -> APIRouter:
    """Return the routes of the export."""
    router = APIRouter(prefix="/api")

    async def exported(scenario: Scenario, form: str) -> Response:
        try:
            media_type, content = await pool.simulation.run(
                "export_controller", scenario, form, time_limit_s=EXPORT_LIMIT_S
            )
        except JobRefusedError as refusal:
            sentence = str(refusal)
            raise refused(f"{sentence[:1].upper()}{sentence[1:]}.") from refusal
        except JobFailedError as failure:
            raise Problem(503, "Not computed", f"The controller could not be exported: {failure}.") from failure
        named = {"Content-Disposition": f'attachment; filename="{FILES[form]}"'}
        return Response(content, media_type=media_type, headers=named)

    @router.get("/export")
    async def of_session(form: Form = "json") -> Response:
        """Return the controller of the live session: as JSON, for MATLAB, or as C source with test vectors."""
        return await exported(session.scenario, form)

    @router.post(
        "/export",
        openapi_extra={
            "requestBody": {"content": {"application/json": {"schema": {"type": "object", "title": "Scenario"}}}}
        },
    )
    async def of_scenario(request: Request, form: Form = "json") -> Response:
        """Return the controller of a scenario: as JSON, for MATLAB, or as C source with test vectors."""
        document = await body_of(request)
        try:
            scenario = Scenario.model_validate_json(json.dumps(document))
        except ValidationError as error:
            raise from_validation(error, Scenario) from error
        return await exported(scenario, form)

    return router
