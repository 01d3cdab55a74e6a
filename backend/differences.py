"""What differs between two dumped documents, by path and in words."""

import copy
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel

from vssea_core.changes import set_values
from vssea_core.fields import Part


@dataclass(frozen=True)
class Difference:
    """One field that differs: `path` inside its part, what stood and what stands there (None: no such field), and in words."""

    path: str
    label: str
    symbol: str
    unit: str
    before: Any
    after: Any
    words: str

    def document(self) -> dict[str, Any]:
        """Return it as JSON takes it."""
        return {
            "path": self.path, "label": self.label, "symbol": self.symbol, "unit": self.unit, "from": self.before,
            "to": self.after, "words": self.words,
        }  # fmt: skip


def differences(before: Any, after: Any, path: str = "") -> dict[str, tuple[Any, Any]]:
    """Return by path every value that differs between two dumped documents."""
    if isinstance(before, dict) and isinstance(after, dict):
        found: dict[str, tuple[Any, Any]] = {}
        if before.get("kind") != after.get("kind"):
            return {f"{path}.kind".lstrip("."): (before.get("kind"), after.get("kind"))}
        for name in after:
            found |= differences(before.get(name), after[name], f"{path}.{name}".lstrip("."))
        return found
    return {} if before == after else {path: (before, after)}


def steps(before: dict[str, Any], after: dict[str, Any], model: type[BaseModel]) -> dict[str, tuple[Any, Any]]:
    """Return by path all values that, set on `before`, make it `after`: a changed kind too, with what its defaults leave."""
    found = differences(before, after)
    kinds = {path: pair for path, pair in found.items() if path.split(".")[-1] == "kind"}
    if not kinds:
        return found
    turned = copy.deepcopy(before)
    set_values(turned, model, {path: kind for path, (_, kind) in kinds.items()})
    rest = steps(turned, after, model)
    return kinds | {path: (value_at(before, path), value) for path, (_, value) in rest.items()}


def told(before: BaseModel, after: BaseModel) -> list[Difference]:
    """Return in words what leads from one document to another of the same model."""
    found = steps(before.model_dump(mode="json"), after.model_dump(mode="json"), type(after))
    return [_told(after, path, *pair) for path, pair in found.items()]


def value_at(document: Any, path: str) -> Any:
    """Return what stands at a dotted path of a dumped document, None if nothing does."""
    for name in path.split("."):
        document = document.get(name) if isinstance(document, dict) else None
    return document


def change_words(document: Part, path: str, before: Any, after: Any) -> str:
    """Return one change as `symbol old → new unit`."""
    title, symbol, unit = labels(document, path)
    return f"{symbol or title} {_value(before)} → {_value(after)}{' ' + unit if unit else ''}"


def labels(document: BaseModel, path: str) -> tuple[str, str, str]:
    """Return title, symbol and unit of the field at a path."""
    here: Any = document
    *parents, last = path.split(".")
    for name in parents:
        here = here[int(name)] if isinstance(here, tuple) else getattr(here, name, None)
    if last == "kind":
        return (parents[-1] if parents else last).replace("_", " "), "", ""
    info = type(here).model_fields.get(last) if isinstance(here, Part) else None
    if info is None:
        return path, "", ""
    extra = info.json_schema_extra if isinstance(info.json_schema_extra, dict) else {}
    return str(info.title or last), str(extra.get("symbol") or ""), str(extra.get("unit") or "")


def _told(document: BaseModel, path: str, before: Any, after: Any) -> Difference:
    title, symbol, unit = labels(document, path)
    values = _value(after) if before is None else f"{_value(before)} → {_value(after)}"
    words = f"{symbol or title} {values}{' ' + unit if unit else ''}"
    return Difference(path, title, symbol, unit, before, after, words)


def _value(value: Any) -> str:
    if isinstance(value, bool) or value is None:
        return {True: "on", False: "off", None: "none"}[value]
    if isinstance(value, (int, float)):
        return f"{value:.4g}"
    if isinstance(value, (list, dict)):
        return f"{len(value)} terms" if isinstance(value, list) else "…"
    return str(value).replace("_", " ")
