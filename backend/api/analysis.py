"""Analysis of the sampled loop over REST: one loop at once; maps, searches and the paper's report as tasks."""

import json
from pathlib import Path
from typing import Any

from fastapi import APIRouter, Request, Response
from fastapi.responses import FileResponse
from pydantic import BaseModel, ValidationError

from backend.api.resources import body_of
from backend.compute.pool import JobFailedError, JobRefusedError, Pool
from backend.compute.requests import BandwidthRequest, LoopRequest, MapRequest, PaperRequest, WorstCaseRequest
from backend.problem import Problem, from_validation, refused
from backend.session.session import Session
from backend.tasks.tasks import Tasks
from vssea_core.field_errors import FieldError

ANALYSIS_LIMIT_S = 30.0
KINDS: dict[str, type[BaseModel]] = {
    "stability_map": MapRequest, "margin_map": MapRequest, "bandwidth_sets": BandwidthRequest,
    "worst_case": WorstCaseRequest, "paper": PaperRequest,
}  # fmt: skip
TITLES = {
    "stability_map": "Stability map", "margin_map": "Margin map", "bandwidth_sets": "Stable bandwidths",
    "worst_case": "Worst case", "paper": "The paper, reproduced",
}  # fmt: skip
Document = dict[str, Any]


def analysis(session: Session, pool: Pool, tasks: Tasks, folder: str) -> APIRouter:
    """Return the routes of the analysis; reports of tasks are written below `folder`."""
    router = APIRouter(prefix="/api")

    @router.post("/analysis")
    async def loop(request: Request) -> Response:
        """Analyse one loop: poles, margins at both breaks, sensitivities, ranges of the true plant; {} is the live one."""
        asked = _with_scenario(_validated(LoopRequest, await body_of(request)), session)
        try:
            report = await pool.analysis.run("analyse_loop", asked, time_limit_s=ANALYSIS_LIMIT_S)
        except JobRefusedError as refusal:
            raise _refused(refusal) from refusal
        except JobFailedError as failure:
            raise Problem(503, "Not computed", f"The analysis could not be computed: {failure}.") from failure
        return Response(report, media_type="application/json")

    @router.get("/tasks")
    def listed() -> list[Document]:
        """Return the tasks, newest first."""
        return [task.document() for task in tasks.list()]

    @router.post("/tasks", status_code=202)
    async def ask(request: Request) -> Document:
        """Ask for a long task: stability_map, margin_map, bandwidth_sets, worst_case or paper."""
        body = await body_of(request)
        kind = body.get("kind") if isinstance(body, dict) else None
        if kind not in KINDS:
            error = FieldError("kind", kind, f"expected one of {', '.join(KINDS)}")
            raise refused(f"kind is {kind!r}; {error.message}.", error)
        asked = _validated(KINDS[kind], body)
        if isinstance(asked, PaperRequest):
            return tasks.ask(kind, TITLES[kind], "paper_task", folder).document()
        return tasks.ask(kind, TITLES[kind], "analysis_task", _with_scenario(asked, session)).document()

    @router.get("/tasks/{number}")
    def one(number: int) -> Document:
        """Return how far a task is."""
        return tasks.find(number).document()

    @router.get("/tasks/{number}/result")
    def result(number: int) -> Response:
        """Return what a task made."""
        return Response(tasks.result(number), media_type="application/json")

    @router.get("/tasks/{number}/files/{name}")
    def file(number: int, name: str) -> FileResponse:
        """Return a file that a task wrote, such as index.html of the paper's report."""
        written = json.loads(tasks.result(number)).get("folder")
        path = Path(written) / name if written and "/" not in name and not name.startswith(".") else None
        if path is None or not path.is_file():
            raise Problem(404, "No such file", f"Task {number} has no file {name!r}.")
        return FileResponse(path)

    @router.delete("/tasks/{number}")
    def cancel(number: int) -> Document:
        """Cancel a task."""
        return tasks.cancel(number).document()

    return router


def _validated(model: type[BaseModel], body: Any) -> Any:
    try:
        return model.model_validate_json(json.dumps(body))
    except ValidationError as error:
        raise from_validation(error, model) from error


def _with_scenario(asked: Any, session: Session) -> Any:
    return asked if asked.scenario is not None else asked.model_copy(update={"scenario": session.scenario})


def _refused(refusal: JobRefusedError) -> Problem:
    sentence = str(refusal)
    return refused(f"{sentence[:1].upper()}{sentence[1:]}.")
