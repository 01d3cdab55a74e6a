"""Every error leaves in one shape: RFC 9457 problem details."""

import logging

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse, Response
from starlette.exceptions import HTTPException

from backend.problem import UNEXPECTED, Problem
from vssea_core.field_errors import FieldError

logger = logging.getLogger(__name__)


def problem_response(problem: Problem) -> JSONResponse:
    """Return the HTTP answer of a problem."""
    return JSONResponse(problem.document(), problem.status, media_type="application/problem+json")


def add_problem_handlers(app: FastAPI) -> None:
    """Make every kind of error of `app` answer in the one shape."""

    @app.exception_handler(Problem)
    async def own(_: Request, problem: Problem) -> Response:
        return problem_response(problem)

    @app.exception_handler(HTTPException)
    async def of_starlette(request: Request, error: HTTPException) -> Response:
        detail = f"{request.method} {request.url.path}: {error.detail}. GET /api/schema and /docs list what there is."
        response = problem_response(Problem(error.status_code, str(error.detail), detail))
        response.headers.update(error.headers or {})
        return response

    @app.exception_handler(RequestValidationError)
    async def of_fastapi(_: Request, error: RequestValidationError) -> Response:
        errors = [
            FieldError(".".join(map(str, item["loc"])), item.get("input"), item["msg"]) for item in error.errors()
        ]
        first = errors[0]
        return problem_response(Problem(422, "Value refused", f"{first.field}: {first.message}.", errors))

    @app.exception_handler(Exception)
    async def unexpected(_: Request, error: Exception) -> Response:
        logger.error("unexpected error", exc_info=error)
        return problem_response(UNEXPECTED)
