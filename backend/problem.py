"""The one error shape, RFC 9457 problem details, and how a refused value becomes a sentence."""

from dataclasses import dataclass, field
from typing import Any

from pydantic import BaseModel, ValidationError

from vssea_core.field_errors import FieldError, field_errors, sentence_of

LONGEST = 60
"""Characters that are shown of a value that is no plain one."""


@dataclass
class Problem(Exception):
    """Something that cannot be done, told in one sentence: what, what was expected, what to do."""

    status: int
    title: str
    detail: str
    errors: list[FieldError] = field(default_factory=list)
    members: dict[str, Any] = field(default_factory=dict)
    """What this kind of problem has beyond the members that all have."""

    def __str__(self) -> str:
        return self.detail

    def document(self) -> dict[str, Any]:
        """Return it as a problem details document."""
        return {
            "type": "about:blank",
            "title": self.title,
            "status": self.status,
            "detail": self.detail,
            "errors": [{"field": e.field, "value": _printable(e.value), "message": e.message} for e in self.errors],
            **self.members,
        }


UNEXPECTED = Problem(500, "Internal error", "An internal error; the server's log has the details.")


def refused(detail: str, *errors: FieldError) -> Problem:
    """Return the problem of a value or tuning that was refused."""
    return Problem(422, "Value refused", detail, list(errors))


def from_validation(error: ValidationError, model: type[BaseModel], root: str = "", consequence: str = "") -> Problem:
    """Return the problem of a document that pydantic refused; `root` is where in the scenario the document sits."""
    found = field_errors(error, model, root)
    return refused(f"{sentence_of(found)}.{' ' + consequence if consequence else ''}", *found)


def _printable(value: Any) -> Any:
    if isinstance(value, float) and value - value != 0.0:
        return str(value)
    if isinstance(value, (str, int, float, bool, type(None))):
        return value
    text = str(value)
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 3]}..."
