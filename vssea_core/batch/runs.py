"""The scenario of each run: the base with values set by path. A part that several runs share is made and checked once."""

from collections import OrderedDict
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError, create_model
from pydantic_core import from_json, to_json

from vssea_core.changes import set_values
from vssea_core.field_errors import field_errors, sentence_of
from vssea_core.scenario import Scenario, check_fits

Values = dict[str, Any]
KEPT = 1024
"""Parts that are kept for the runs that share them."""
_CONFIG = ConfigDict(extra="forbid", allow_inf_nan=False)
_PART_MODELS: dict[str, type[BaseModel]] = {
    name: create_model(name, __config__=_CONFIG, **{name: (field.annotation, field)})  # type: ignore[call-overload]
    for name, field in Scenario.model_fields.items()
}


class Runs:
    """Scenarios that differ from `base` in some values."""

    def __init__(self, base: Scenario) -> None:
        self._base = base
        self._texts = {name: to_json({name: part}) for name, part in base.model_dump(mode="json").items()}
        self._parts: OrderedDict[tuple[str, str], Any] = OrderedDict()

    def scenario(self, values: Values) -> Scenario:
        """Return the base with `values` by path. Raises UnknownPath, or ValueError for values that are refused."""
        by_part: dict[str, Values] = {}
        for path, value in values.items():
            by_part.setdefault(path.split(".", 1)[0], {})[path] = value
        scenario = self._base.model_copy(update={name: self._part(name, own) for name, own in by_part.items()})
        check_fits(scenario)
        return scenario

    def _part(self, name: str, values: Values) -> Any:
        key = name, repr(values)
        if key not in self._parts:
            self._parts[key] = self._made(name, values)
            if len(self._parts) > KEPT:
                self._parts.popitem(last=False)
        return self._parts[key]

    def _made(self, name: str, values: Values) -> Any:
        document = from_json(self._texts.get(name, b"{}"))
        set_values(document, Scenario, values)
        try:
            return getattr(_PART_MODELS[name].model_validate_json(to_json(document)), name)
        except ValidationError as error:
            raise ValueError(sentence_of(field_errors(error, _PART_MODELS[name]))) from error
