"""Changes by path: `{"tuning.observer.bandwidth": 120}` applied to a dumped scenario document."""

from typing import Any, get_args

from pydantic import BaseModel


class UnknownPath(ValueError):
    """A path that leads to no field; `path` as it was given, `known` the names where it ends."""

    def __init__(self, path: str, known: list[str]) -> None:
        self.path, self.known = path, known
        super().__init__(f"{path} is not a field; known here: {', '.join(known) or 'nothing'}")


def set_value(document: dict[str, Any], model: type[BaseModel], path: str, value: Any) -> None:
    """Set the field at a dotted `path` of a `document` of `model`; a new kind takes its defaults and what both kinds share.

    Raises UnknownPath. The value is not checked: validate the document afterwards.
    """
    here: Any = document
    *parents, last = path.split(".")
    for name in parents:
        if not isinstance(here, dict) or not isinstance(here.get(name), dict):
            raise UnknownPath(path, list(here) if isinstance(here, dict) else [])
        here = here[name]
    if not isinstance(here, dict) or last not in here:
        raise UnknownPath(path, list(here) if isinstance(here, dict) else [])
    if last == "kind" and here["kind"] != value:
        _change_kind(here, value, model, parents)
    else:
        here[last] = value


def set_values(document: dict[str, Any], model: type[BaseModel], changes: dict[str, Any]) -> None:
    """Set every path of `changes`, a kind first: it decides which other names there are. Raises UnknownPath."""
    for path in sorted(changes, key=lambda path: (path.split(".")[-1] != "kind", path)):
        set_value(document, model, path, changes[path])


def _change_kind(here: dict[str, Any], kind: Any, model: type[BaseModel], place: list[str]) -> None:
    alternative = _alternative(kind, model, place)
    own = alternative().model_dump(mode="json") if alternative else {}
    kept = {name: value for name, value in here.items() if name in own and _allowed(alternative, name, value)}
    here.clear()
    here.update(own | kept | {"kind": kind})


def _allowed(model: type[BaseModel] | None, name: str, value: Any) -> bool:
    """Return whether a choice of one kind exists in the other too; two kinds may name a field alike and offer other values."""
    choices = get_args(model.model_fields[name].annotation) if model and isinstance(value, str) else ()
    return not choices or value in choices


def _alternative(kind: Any, model: type[BaseModel], place: list[str]) -> type[BaseModel] | None:
    """Return the model of `kind` at `place`, such as tuning.observer; a reference and a disturbance both have a sine."""
    models: list[type[BaseModel]] = [model]
    for name in place:
        fields = [each.model_fields[name] for each in models if name in each.model_fields]
        models = [found for field in fields for found in models_of(field.annotation)]
    kinds = {each.model_fields["kind"].default: each for each in models if "kind" in each.model_fields}
    return kinds.get(kind) if isinstance(kind, str) else None


def models_of(annotation: Any) -> list[type[BaseModel]]:
    """Return the models that an annotation names, such as the alternatives of a union."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for argument in get_args(annotation) for model in models_of(argument)]
