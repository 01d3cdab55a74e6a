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

    An item of a list is named by its number, from 0. Raises UnknownPath. The value is not checked: validate the document
    afterwards.
    """
    here: Any = document
    *parents, last = path.split(".")
    for name in parents:
        here = _child(here, name, path)
    if last == "kind" and isinstance(here, dict) and here.get("kind", value) != value:
        _change_kind(here, value, model, parents)
    elif isinstance(here, list):
        _child(here, last, path)
        here[int(last)] = value
    elif isinstance(here, dict) and last in here:
        here[last] = value
    else:
        raise UnknownPath(path, _names(here))


def value_at(document: dict[str, Any], path: str) -> Any:
    """Return what a document holds at a dotted path. Raises UnknownPath."""
    here: Any = document
    for name in path.split("."):
        here = _child(here, name, path)
    return here


def paths_of(document: Any, prefix: str = "") -> list[str]:
    """Return the paths of everything in a document that is no dict, such as tuning.observer.bandwidth."""
    if isinstance(document, dict | list) and document:
        items = document.items() if isinstance(document, dict) else enumerate(document)
        inner = [path for name, value in items for path in paths_of(value, f"{prefix}{name}.")]
        return inner if isinstance(document, dict) else [prefix[:-1], *inner]
    return [prefix[:-1]]


def _child(here: Any, name: str, path: str) -> Any:
    if isinstance(here, dict) and name in here:
        return here[name]
    if isinstance(here, list) and name.isdecimal() and int(name) < len(here):
        return here[int(name)]
    raise UnknownPath(path, _names(here))


def _names(here: Any) -> list[str]:
    if isinstance(here, list):
        return [str(place) for place in range(len(here))]
    return list(here) if isinstance(here, dict) else []


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
        if name.isdecimal():  # an item of a list: any of the models that the list may hold
            continue
        fields = [each.model_fields[name] for each in models if name in each.model_fields]
        models = [found for field in fields for found in models_of(field.annotation)]
    kinds = {each.model_fields["kind"].default: each for each in models if "kind" in each.model_fields}
    return kinds.get(kind) if isinstance(kind, str) else None


def models_of(annotation: Any) -> list[type[BaseModel]]:
    """Return the models that an annotation names, such as the alternatives of a union."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for argument in get_args(annotation) for model in models_of(argument)]
