"""What differs between two scenarios, by path and in words."""

from typing import Any

from vssea_core.fields import Part
from vssea_core.scenario import Scenario


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


def change_words(scenario: Scenario, path: str, before: Any, after: Any) -> str:
    """Return one change as `symbol old → new unit`."""
    label, unit = label_and_unit(scenario, path)
    return f"{label} {_value(before)} → {_value(after)}{' ' + unit if unit else ''}"


def difference_entries(before: Scenario, after: Scenario) -> list[dict[str, Any]]:
    """Return every field that differs, with path, label, unit, both values and the change in words."""
    found = differences(before.model_dump(mode="json"), after.model_dump(mode="json"))
    entries = []
    for path, (old, new) in found.items():
        label, unit = label_and_unit(after, path)
        words = change_words(after, path, old, new)
        entries.append({"path": path, "label": label, "unit": unit, "from": old, "to": new, "words": words})
    return entries


def label_and_unit(scenario: Scenario, path: str) -> tuple[str, str]:
    """Return the symbol or title of the field at a dotted path, and its unit; the path itself of what is no field."""
    here: Any = scenario
    *parents, last = path.split(".")
    for name in parents:
        here = here[int(name)] if isinstance(here, tuple) else getattr(here, name, None)
    if last == "kind":
        return parents[-1].replace("_", " "), ""
    info = type(here).model_fields.get(last) if isinstance(here, Part) else None
    if info is None:
        return path, ""
    extra = info.json_schema_extra if isinstance(info.json_schema_extra, dict) else {}
    return str(extra.get("symbol") or info.title or last), str(extra.get("unit") or "")


def _value(value: Any) -> str:
    if isinstance(value, bool) or value is None:
        return {True: "on", False: "off", None: "none"}[value]
    if isinstance(value, (int, float)):
        return f"{value:.4g}"
    if isinstance(value, (list, dict)):
        return f"{len(value)} terms" if isinstance(value, list) else "…"
    return str(value).replace("_", " ")
