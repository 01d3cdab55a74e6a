"""Reading a document that another version, or a hand, has written: every field that does not fit is named."""

import json
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar, get_args, get_origin

from pydantic import BaseModel, ValidationError

from backend.problem import from_validation
from vssea_core.changes import models_of
from vssea_core.field_errors import FieldError

Model = TypeVar("Model", bound=BaseModel)


@dataclass
class Fit(Generic[Model]):
    """A document as this version reads it: `model` is None where a field is refused."""

    model: Model | None = None
    unknown: list[str] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)
    refused: list[FieldError] = field(default_factory=list)

    def document(self) -> dict[str, Any]:
        """Return what does not fit, as JSON takes it."""
        return {
            "unknown": self.unknown,
            "missing": self.missing,
            "refused": [
                {"field": error.field, "value": error.value, "message": error.message} for error in self.refused
            ],
        }


def fitted(document: Any, model: type[Model], root: str = "") -> Fit[Model]:
    """Return the document as `model`: without the names it does not know, with defaults for those it lacks."""
    fit: Fit[Model] = Fit()
    known = _known(document, model, root, fit)
    try:
        fit.model = model.model_validate_json(json.dumps(known))
    except ValidationError as error:
        fit.refused = [_shown(found) for found in from_validation(error, model, root).errors]
    return fit


def _known(document: Any, annotation: Any, path: str, fit: Fit[Any]) -> Any:
    models = models_of(annotation)
    if not models:
        return document
    if get_origin(annotation) is dict and isinstance(document, dict):
        return {
            name: _known(value, get_args(annotation)[1], _join(path, name), fit) for name, value in document.items()
        }
    if isinstance(document, list):
        return [_known(item, annotation, f"{path}.{number}".lstrip("."), fit) for number, item in enumerate(document)]
    if not isinstance(document, dict):
        return document
    model = _meant(document, models)
    if model is None:
        return document  # validation says which kinds there are
    fields = model.model_fields
    fit.unknown += [_join(path, name) for name in document if name not in fields]
    fit.missing += [
        _join(path, name)
        for name, info in fields.items()
        if name not in document and name != "kind" and not info.is_required()
    ]
    return {
        name: _known(value, fields[name].annotation, _join(path, name), fit)
        for name, value in document.items()
        if name in fields
    }


def _meant(document: dict[str, Any], models: list[type[BaseModel]]) -> type[BaseModel] | None:
    if len(models) == 1:
        return models[0]
    return next((model for model in models if model.model_fields["kind"].default == document.get("kind")), None)


def _join(path: str, name: str) -> str:
    return f"{path}.{name}" if path else name


def _shown(error: FieldError) -> FieldError:
    value = error.value
    is_plain = isinstance(value, str | bool | int | type(None)) or (isinstance(value, float) and value - value == 0.0)
    return error if is_plain else FieldError(error.field, str(value)[:60], error.message)
