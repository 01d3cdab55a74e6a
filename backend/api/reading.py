"""What the routes of recordings and batches share: asking their workers, files as answers, channels in an address."""

import re
from collections.abc import Awaitable
from pathlib import Path
from typing import Any, TypeVar

from fastapi import Request
from fastapi.responses import FileResponse
from starlette.background import BackgroundTask

from backend.api.conditions import expected_of
from backend.compute.pool import JobFailedError, JobRefusedError
from backend.problem import Problem, refused
from vssea_core.field_errors import FieldError

Answer = TypeVar("Answer")
NUMBER = re.compile(r"\d+")


async def read(job: Awaitable[Answer], what: str = "recording") -> Answer:
    """Return what a job that reads a `what` returns. Raises Problem with its sentence if it was refused or failed."""
    try:
        return await job
    except JobRefusedError as refusal:
        sentence = str(refusal).rstrip(".")
        raise refused(f"{sentence[:1].upper()}{sentence[1:]}.") from refusal
    except JobFailedError as failure:
        raise Problem(503, "Not read", f"The {what} could not be read: {str(failure).rstrip('.')}.") from failure


def named_file(path: str, media_type: str, name: str | None = None, **headers: str) -> FileResponse:
    """Return a file as the answer and remove it afterwards; with a name the browser saves it under that."""
    removal = BackgroundTask(Path(path).unlink, missing_ok=True)
    return FileResponse(path, media_type=media_type, filename=name, headers=headers, background=removal)


def channels_in(text: str) -> list[str]:
    """Return the channels that an address names, separated by commas."""
    return [name.strip() for name in text.split(",") if name.strip()]


def revision_of(request: Request) -> int | None:
    """Return the revision that a caller knows by If-Match, None if any will do. Raises Problem for what is no ETag."""
    expected = expected_of(request)
    if expected is None or not expected.revisions:
        return None
    tag = next(iter(expected.revisions))
    if not NUMBER.fullmatch(tag):
        error = FieldError("If-Match", tag, 'expected the ETag of a recording, such as "3"')
        raise refused(f"If-Match is {tag!r}; {error.message}.", error)
    return int(tag)


def limits_of(from_s: float | None, to_s: float | None) -> tuple[float, float]:
    """Return the span that an address asks for, all of it by default."""
    return (float("-inf") if from_s is None else from_s), (float("inf") if to_s is None else to_s)


def document_of(body: Any, *known: str) -> dict[str, Any]:
    """Return a JSON body that is an object with known names only. Raises Problem."""
    names = ", ".join(known)
    if not isinstance(body, dict):
        raise refused(f"The body is no object; expected one with {names}.")
    unknown = [name for name in body if name not in known]
    if unknown:
        error = FieldError(unknown[0], None, f"unknown name; known here: {names}")
        raise refused(f"{unknown[0]} is an {error.message}.", error)
    return body


def number_of(body: dict[str, Any], name: str) -> float | None:
    """Return a number of a JSON body, None if it is not there. Raises Problem for what is none."""
    value = body.get(name)
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not abs(value) < 1e9:
        error = FieldError(name, value, "expected a time in s")
        raise refused(f"{name} is {value!r}; {error.message}.", error)
    return float(value)
