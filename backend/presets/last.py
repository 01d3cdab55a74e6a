"""What ran last, for the next start: the scenario, and the preset in force with the version."""

from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError

from backend.presets.documents import Documents
from backend.presets.found import Found
from backend.problem import Problem
from backend.store import kept
from backend.store.database import Database
from vssea_core.scenario import Scenario

KEY = "last"


@dataclass(frozen=True)
class InForce:
    """The preset that the live tuning was saved as or taken from; it is what the page counts changes since."""

    document_id: int
    name: str
    version: int
    saved_at: str
    revision: int
    tuning: dict[str, Any]

    @classmethod
    def of(cls, found: Found) -> "InForce":
        """Return a found preset as the one in force. Raises Problem if it does not fit this version of the program."""
        document, version = found.document, found.version
        tuning = found.part.model_dump(mode="json")
        return cls(document.id, document.name, version.number, version.saved_at, document.revision, tuning)

    def document(self) -> dict[str, Any]:
        """Return it as pages see it."""
        return {
            "name": self.name, "version": self.version, "saved_at": self.saved_at, "revision": self.revision,
            "tuning": self.tuning,
        }  # fmt: skip


@dataclass(frozen=True)
class Last:
    """What ran when the server ended."""

    scenario: Scenario
    preset: InForce | None


def read_last(database: Database, presets: Documents) -> Last | None:
    """Return what ran when the server ended, None at a first start or if it no longer fits. Raises Problem."""
    value = kept.get(database, KEY)
    if not isinstance(value, dict):
        return None
    try:
        scenario = Scenario.model_validate(value.get("scenario"))
    except ValidationError:
        return None
    named = value.get("preset")
    try:
        preset = InForce.of(presets.get(named["name"], named["version"])) if isinstance(named, dict) else None
    except (Problem, KeyError):
        preset = None
    return Last(scenario, preset)


def keep_last(database: Database, scenario: Scenario, preset: InForce | None) -> None:
    """Keep what runs for the next start. Raises Problem."""
    named = preset and {"name": preset.name, "version": preset.version}
    kept.put(database, KEY, {"scenario": scenario.model_dump(mode="json"), "preset": named})
