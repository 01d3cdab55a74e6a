"""The one error shape, RFC 9457 problem details, and how a refused value becomes a sentence."""

from dataclasses import dataclass, field
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from vssea_core.changes import models_of


@dataclass(frozen=True)
class FieldError:
    """One refused field: its path, the value given, and what was expected."""

    field: str
    value: Any
    message: str


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
    found = [_field_error(item, model, root) for item in error.errors(include_url=False)]
    first = found[0]
    more = f" ({len(found) - 1} more)" if len(found) > 1 else ""
    subject = f"{first.field} is {_worded(first.value)}; " if first.field and not first.message.endswith(".") else ""
    detail = f"{subject}{first.message.rstrip('.')}{more}.{' ' + consequence if consequence else ''}"
    return refused(detail, *found)


def _field_error(item: Any, model: type[BaseModel], root: str) -> FieldError:
    path, info, known = _walk(model, item["loc"])
    name = ".".join(part for part in (root, *path) if part)
    kind, value = item["type"], item["input"]
    if kind == "extra_forbidden":
        return FieldError(name, value, f"unknown name; known here: {', '.join(known)}")
    if kind == "value_error":
        return FieldError(name, None, f"{item['ctx']['error']}.")
    if kind == "missing":
        return FieldError(name, None, "it is missing; expected a value")
    if kind == "json_invalid":
        return FieldError(name, None, f"not JSON: {item['ctx']['error']}")
    if kind == "union_tag_not_found":
        return FieldError(f"{name}.kind", None, "it is missing; expected a kind")
    if kind in ("union_tag_invalid", "literal_error"):
        return FieldError(
            name, value, f"expected one of {item['ctx'].get('expected_tags') or item['ctx'].get('expected')}"
        )
    expected = _range(info)
    if expected and kind in _NUMERIC:
        return FieldError(name, value, f"expected {expected}")
    return FieldError(name, value, f"expected {item['msg'].removeprefix('Input should be ')}")


_NUMERIC = {
    "greater_than_equal", "less_than_equal", "finite_number", "float_type", "int_type", "int_from_float", "float_parsing",
}  # fmt: skip


def _range(info: FieldInfo | None) -> str | None:
    if info is None:
        return None
    bounds = {type(part).__name__: part for part in info.metadata}
    if "Ge" not in bounds or "Le" not in bounds:
        return None
    extra = info.json_schema_extra
    unit = str(extra.get("unit") or "") if isinstance(extra, dict) else ""
    return f"a number from {bounds['Ge'].ge:g} to {bounds['Le'].le:g} {unit}".rstrip()


def _walk(model: type[BaseModel], location: tuple[int | str, ...]) -> tuple[list[str], FieldInfo | None, list[str]]:
    """Return the path without union tags, the field it leads to, and the names known where it ends."""
    path: list[str] = []
    here: Any = model
    info: FieldInfo | None = None
    known: list[str] = list(model.model_fields)
    for part in location:
        alternatives = [
            m
            for m in models_of(here)
            if isinstance(part, str) and m.model_fields.get("kind") and m.model_fields["kind"].default == part
        ]
        if alternatives:
            here = alternatives[0]
            known = list(here.model_fields)
            continue
        path.append(str(part))
        owner = next((m for m in models_of(here) if part in m.model_fields), None)
        info = owner.model_fields[str(part)] if owner else info if isinstance(part, int) else None
        if owner:
            here = info.annotation if info else None
            known = [n for m in models_of(here) for n in m.model_fields] or known
    return path, info, known


def _worded(value: Any) -> str:
    text = repr(value) if isinstance(value, str) else str(value)
    return text if len(text) <= 60 else text[:57] + "..."


def _printable(value: Any) -> Any:
    if isinstance(value, float) and value - value != 0.0:
        return str(value)
    return value if isinstance(value, (str, int, float, bool, type(None))) else _worded(value)
