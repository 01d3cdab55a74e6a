"""What a server refused, or why it could not be asked."""

import json
from typing import Any


class VsseaError(Exception):
    """One sentence; `status` of the answer (None without one) and `errors`, the refused fields, are for programs."""

    def __init__(self, sentence: str, status: int | None = None, errors: tuple[dict[str, Any], ...] = ()) -> None:
        super().__init__(sentence)
        self.status, self.errors = status, errors


def error_of(status: int, body: bytes, asked: str) -> VsseaError:
    """Return the error of an answer: the sentence of its problem document, or what was asked if it has none."""
    try:
        problem = json.loads(body)
        return VsseaError(str(problem["detail"]), status, tuple(problem.get("errors", ())))
    except (ValueError, KeyError, TypeError, AttributeError):
        return VsseaError(f"{asked} was answered with status {status}, and not by a VSSEA server", status)
