"""Changes by path: `{"observer.bandwidth": 120}` applied to one part of the scenario document."""

import json
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from backend.problem import FieldError, Problem, from_validation, models_of, refused
from vssea_core.scenario import Scenario

CONSEQUENCE = "Nothing was changed."


class Changes(BaseModel):
    """Arguments of the commands that change a part: some paths of it, or all of it."""

    model_config = ConfigDict(extra="forbid")

    changes: dict[str, Any] = Field(default_factory=dict, max_length=64)
    replace: dict[str, Any] | None = None


def with_changes(scenario: Scenario, part: str, asked: Changes) -> Scenario:
    """Return the scenario with `part` (tuning, reference, ...) changed. Raises Problem; the scenario is left as it was."""
    document = scenario.model_dump(mode="json")
    if asked.replace is not None:
        document[part] = asked.replace
    # A kind first: it decides which other names there are.
    for path in sorted(asked.changes, key=lambda path: (path.split(".")[-1] != "kind", path)):
        _set(document[part], part, path, asked.changes[path])
    return validated(document)


def validated(document: dict[str, Any]) -> Scenario:
    """Return the document as a Scenario. Raises Problem with a sentence for each refused field."""
    try:
        return Scenario.model_validate_json(json.dumps(document))
    except ValidationError as error:
        raise from_validation(error, Scenario, consequence=CONSEQUENCE) from error


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


def _set(target: dict[str, Any], part: str, path: str, value: Any) -> None:
    here: Any = target
    *parents, last = path.split(".")
    for name in parents:
        if not isinstance(here, dict) or not isinstance(here.get(name), dict):
            raise _unknown(part, path, here)
        here = here[name]
    if not isinstance(here, dict) or last not in here:
        raise _unknown(part, path, here)
    if last == "kind" and here["kind"] != value:
        _change_kind(here, value, ".".join((part, *parents)))
    else:
        here[last] = value


def _change_kind(here: dict[str, Any], kind: Any, place: str) -> None:
    """Take another kind at `place`: its own defaults, and what both kinds share."""
    model = _alternative(kind, place)
    own = model().model_dump(mode="json") if model else {}
    kept = {name: value for name, value in here.items() if name in own}
    here.clear()
    here.update(own | kept | {"kind": kind})


def _alternative(kind: Any, place: str) -> type[BaseModel] | None:
    """Return the model of `kind` at `place`, such as tuning.observer; a reference and a disturbance both have a sine."""
    models: list[type[BaseModel]] = [Scenario]
    for name in place.split("."):
        fields = [model.model_fields[name] for model in models if name in model.model_fields]
        models = [model for field in fields for model in models_of(field.annotation)]
    kinds = {model.model_fields["kind"].default: model for model in models if "kind" in model.model_fields}
    return kinds.get(kind) if isinstance(kind, str) else None


def _unknown(part: str, path: str, here: Any) -> Problem:
    known = ", ".join(here) if isinstance(here, dict) else "nothing"
    error = FieldError(f"{part}.{path}", None, f"unknown name; known here: {known}")
    return refused(f"{part}.{path} is not a field; known here: {known}. {CONSEQUENCE}", error)
