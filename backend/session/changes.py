"""Changes by path: `{"observer.bandwidth": 120}` applied to one part of the scenario document."""

import json
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from backend.differences import differences as differences
from backend.differences import value_at
from backend.problem import Problem, from_validation, refused
from vssea_core.changes import UnknownPath, set_values
from vssea_core.field_errors import FieldError
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
    try:
        set_values(document, Scenario, {f"{part}.{path}": value for path, value in asked.changes.items()})
    except UnknownPath as unknown:
        error = FieldError(unknown.path, None, f"unknown name; known here: {', '.join(unknown.known) or 'nothing'}")
        raise refused(f"{unknown}. {CONSEQUENCE}", error) from unknown
    return validated(document)


def begun_with(beginning: Scenario, part: str, asked: Changes) -> Scenario:
    """Return the scenario of t = 0 with a live change of `part`; what does not fit there any more is left out."""
    try:
        return with_changes(beginning, part, asked)
    except Problem:
        return beginning


def after_change(scenario: Scenario, changed: dict[str, Any]) -> Scenario:
    """Return the scenario with a change of its own sequence made; such a change was checked when it was written."""
    document = scenario.model_dump(mode="json")
    set_values(document, Scenario, changed)
    return validated(document)


def valued(scenario: Scenario, path: str) -> Any:
    """Return what stands at a dotted path of the scenario, None if nothing does."""
    return value_at(scenario.model_dump(mode="json"), path)


def validated(document: dict[str, Any]) -> Scenario:
    """Return the document as a Scenario. Raises Problem with a sentence for each refused field."""
    try:
        return Scenario.model_validate_json(json.dumps(document))
    except ValidationError as error:
        raise from_validation(error, Scenario, consequence=CONSEQUENCE) from error
