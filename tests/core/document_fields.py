"""Every field of the scenario document, found by walking the models: where it is, and a document in which it can be set."""

from collections.abc import Iterator
from typing import Annotated, Any, NamedTuple, Union, get_args, get_origin

from pydantic.fields import FieldInfo

from vssea_core.fields import Part
from vssea_core.scenario import Scenario

Path = tuple[str | int, ...]


class Place(NamedTuple):
    """One field: the part that owns it, its path in the document, and the kinds that have to be chosen on the way."""

    owner: type[Part]
    name: str
    field: FieldInfo
    path: Path
    kinds: tuple[tuple[Path, str], ...]

    @property
    def id(self) -> str:
        """The dotted path."""
        return ".".join(str(step) for step in self.path)

    def document(self, value: object) -> dict[str, Any]:
        """Return a document that says `value` here and leaves the rest at its defaults."""
        document: dict[str, Any] = {}
        for path, kind in self.kinds:
            _put(document, (*path, "kind"), kind)
        _put(document, self.path, value)
        return _lists(document)


def places(part: type[Part] = Scenario, path: Path = (), kinds: tuple[tuple[Path, str], ...] = ()) -> Iterator[Place]:
    """Yield a Place for every field below `part` that is not a part itself."""
    for name, field in part.model_fields.items():
        here = (*path, name)
        inner = _parts(field.annotation)
        if not inner:
            yield Place(part, name, field, here, kinds)
        listed = get_origin(field.annotation) is tuple
        below: Path = (*here, 0) if listed else here
        for alternative in inner:
            chosen = ((below, alternative.model_fields["kind"].default),) if "kind" in alternative.model_fields else ()
            yield from places(alternative, below, kinds + chosen)


def limits(field: FieldInfo) -> tuple[float, float] | None:
    """Return the permitted range of a numeric field, None for any other."""
    found = {name: getattr(mark, name) for mark in field.metadata for name in ("ge", "le") if hasattr(mark, name)}
    return (found["ge"], found["le"]) if len(found) == 2 else None


def _parts(annotation: Any) -> list[type[Part]]:
    if isinstance(annotation, type) and issubclass(annotation, Part):
        return [annotation]
    if get_origin(annotation) in (tuple, Union, Annotated) or hasattr(annotation, "__args__"):
        return [part for inner in get_args(annotation) for part in _parts(inner)]
    return []


def _put(document: dict[Any, Any], path: Path, value: object) -> None:
    for step in path[:-1]:
        document = document.setdefault(step, {})
    document[path[-1]] = value


def _lists(document: Any) -> Any:
    if not isinstance(document, dict):
        return document
    if set(document) == {0}:
        return [_lists(document[0])]
    return {name: _lists(value) for name, value in document.items()}
