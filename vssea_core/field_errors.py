"""What pydantic refused of a document, told to the user: each field by its path, the value given, and what was expected."""

from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from vssea_core.changes import models_of

Location = tuple[int | str, ...]
NOTHING = "it is missing"


@dataclass(frozen=True)
class FieldError:
    """One refused field: its path, the value given, and what was expected."""

    field: str
    value: Any
    message: str

    @property
    def sentence(self) -> str:
        """All of it in words, without the full stop."""
        message = self.message.rstrip(".")
        if not self.field or self.message.endswith("."):  # it speaks for itself
            return message
        if message.startswith(NOTHING):
            return f"{self.field}{message.removeprefix('it')}"
        return f"{self.field} is {_worded(self.value)}; {message}"


def field_errors(error: ValidationError, model: type[BaseModel], root: str = "") -> list[FieldError]:
    """Return what was refused of a document of `model`; `root` is where in the scenario the document sits."""
    return [_field_error(item, model, root) for item in error.errors(include_url=False)]


def sentence_of(errors: list[FieldError]) -> str:
    """Return the first of `errors` in words, and how many there are besides; without the full stop."""
    others = len(errors) - 1
    more = f"; {others} more field{' is' if others == 1 else 's are'} refused" if others else ""
    return errors[0].sentence + more


def _field_error(item: Any, model: type[BaseModel], root: str) -> FieldError:
    path, info, known = _walk(model, item["loc"])
    name = ".".join(part for part in (root, *path) if part)
    kind, value, context = item["type"], item["input"], item.get("ctx", {})
    match kind:
        case "extra_forbidden":
            return FieldError(name, value, f"unknown name; known here: {', '.join(known)}")
        case "value_error":
            return FieldError(name, None, f"{context['error']}.")
        case "missing":
            return FieldError(name, None, f"{NOTHING}; expected a value")
        case "json_invalid":
            return FieldError(name, None, f"the document is not JSON: {context['error']}")
        case "union_tag_not_found":
            return FieldError(f"{name}.kind".lstrip("."), None, f"{NOTHING}; expected {_kinds(model, item['loc'])}")
        case "union_tag_invalid":
            return FieldError(f"{name}.kind".lstrip("."), context["tag"], f"expected one of {context['expected_tags']}")
        case "literal_error":
            return FieldError(name, value, f"expected one of {context['expected']}")
        case "too_short" | "string_too_short":
            return FieldError(name, value, f"expected at least {_counted(context['min_length'], kind)}")
        case "too_long" | "string_too_long":
            return FieldError(name, value, f"expected at most {_counted(context['max_length'], kind)}")
    expected = _range(info)
    if expected and kind in _NUMERIC:
        return FieldError(name, value, f"expected {expected}")
    return FieldError(name, value, f"expected {item['msg'].removeprefix('Input should be ')}")


_NUMERIC = {
    "greater_than_equal", "less_than_equal", "finite_number", "float_type", "int_type", "int_from_float", "float_parsing",
    "int_parsing", "int_parsing_size",
}  # fmt: skip


def _counted(number: int, kind: str) -> str:
    what = "character" if kind.startswith("string") else "item"
    return f"{number} {what}{'' if number == 1 else 's'}"


def _range(info: FieldInfo | None) -> str | None:
    if info is None:
        return None
    bounds = {type(part).__name__: part for part in info.metadata}
    if "Ge" not in bounds or "Le" not in bounds:
        return None
    extra = info.json_schema_extra
    unit = str(extra.get("unit") or "") if isinstance(extra, dict) else ""
    number, shown = ("whole number", "d") if info.annotation is int else ("number", "g")
    return f"a {number} from {bounds['Ge'].ge:{shown}} to {bounds['Le'].le:{shown}} {unit}".rstrip()


def _kinds(model: type[BaseModel], location: Location) -> str:
    """Return the kinds that a union offers, in words."""
    _, info, _ = _walk(model, location)
    kinds = [each.model_fields["kind"].default for each in models_of(info.annotation if info else None)]
    return f"one of {', '.join(map(repr, kinds))}" if kinds else "a kind"


def _walk(model: type[BaseModel], location: Location) -> tuple[list[str], FieldInfo | None, list[str]]:
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
