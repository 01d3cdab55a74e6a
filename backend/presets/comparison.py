"""A saved version beside what runs, or beside another version: what differs, and which of it is to be applied."""

import copy
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel

from backend.differences import Difference, told, value_at
from backend.presets.documents import Documents
from backend.presets.fitting import fitted
from backend.presets.found import Found
from backend.problem import Problem, refused
from vssea_core.field_errors import FieldError


@dataclass(frozen=True)
class Comparison:
    """What leads to a saved version; `unfit` are the fields of it that this program refuses."""

    found: Found
    changes: list[Difference]
    unfit: list[FieldError]

    def document(self) -> dict[str, Any]:
        """Return it as JSON takes it."""
        return {
            "changes": [each.document() for each in self.changes],
            "refused": [{"field": error.field, "message": error.message} for error in self.unfit],
            "same": not self.changes and not self.unfit,
        }

    def chosen(self, paths: list[str] | None) -> dict[str, Any]:
        """Return the values to set, by path: of all that differs, or of `paths` alone. Raises Problem if one cannot be set."""
        every = {each.path: each.after for each in self.changes}
        if paths is None:
            if self.unfit:
                names = ", ".join(error.field for error in self.unfit)
                raise refused(
                    f"{self.found.document.name} cannot be applied whole: {names} does not fit this version of the program. "
                    "Choose the fields to apply.",
                    *self.unfit,
                )
            return every
        unknown = [path for path in paths if path not in every]
        if unknown:
            message = f"it does not differ; what differs: {', '.join(every) or 'nothing'}"
            errors = [FieldError(path, None, message) for path in unknown]
            raise refused(
                f"{unknown[0]} does not differ, so it cannot be applied; expected paths of the difference.", *errors
            )
        self._check_kinds(paths)
        return {path: every[path] for path in paths}

    def _check_kinds(self, paths: list[str]) -> None:
        """Fields that only another kind has cannot come without it."""
        for each in self.changes:
            part, _, last = each.path.rpartition(".")
            if last == "kind" and each.path not in paths and any(path.startswith(f"{part}.") for path in paths):
                error = FieldError(
                    each.path, None, f"its fields belong to {str(each.after).replace('_', ' ')}; choose it too"
                )
                raise refused(f"{part} changes its kind, and its fields cannot be applied without {each.path}.", error)


def compared(documents: Documents, name: str, number: int | None, against: str, live: BaseModel) -> Comparison:
    """Return what leads from `live`, from another version of the same document (a number) or from another document to a version.

    Raises Problem 404 if there is no such document or version.
    """
    found = documents.get(name, number)
    base = live if against == "live" else _other(documents, name, against).part
    part, unfit = _tolerant(found, base)
    return Comparison(found, told(base, part) if part is not None else [], unfit)


def _other(documents: Documents, name: str, against: str) -> Found:
    if not against.isdecimal():
        return documents.get(against)
    try:
        return documents.get(name, int(against))
    except Problem as no_version:
        try:
            return documents.get(against)
        except Problem:
            raise no_version from None


def _tolerant(found: Found, base: BaseModel) -> tuple[BaseModel | None, list[FieldError]]:
    """Return the saved part with the base's values where its own are refused, and what is refused."""
    raw = found.raw.get(found.kind.part) if isinstance(found.raw, dict) else None
    own = fitted(raw, type(base), found.kind.part)
    if own.model is not None or not isinstance(raw, dict):
        return own.model, own.refused
    mended, standing = copy.deepcopy(raw), base.model_dump(mode="json")
    for error in own.refused:
        *parents, last = error.field.split(".")[1:] or [""]
        if last == "kind" and error.value is not None and parents:
            last = parents.pop()  # what goes with a kind that nobody knows goes with it
        here: Any = mended
        for parent in parents:
            here = here.get(parent) if isinstance(here, dict) else None
        value = value_at(standing, ".".join((*parents, last)))
        if isinstance(here, dict) and value is not None:
            here[last] = value
    return fitted(mended, type(base)).model, own.refused
