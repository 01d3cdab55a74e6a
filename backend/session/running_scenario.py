"""The scenario that runs: as it stands now, and as it stands at t = 0, before its sequence changes it."""

from dataclasses import dataclass
from typing import Any

from backend.session.changes import Changes, after_change, begun_with, differences, valued
from backend.session.sentences import change_words
from vssea_core.scenario import Scenario


@dataclass(frozen=True)
class PartChange:
    """What differs in one part (tuning, reference, ...): before and after by path relative to it."""

    part: str
    changes: dict[str, tuple[Any, Any]]


class RunningScenario:
    """Keeps the two in step through changes by hand, changes of the sequence, and loads."""

    def __init__(self, scenario: Scenario) -> None:
        self.now = self.beginning = scenario
        self.followed = 0
        """Entries of the sequence that have been made."""

    def load(self, scenario: Scenario) -> None:
        """Begin anew with a scenario."""
        self.now = self.beginning = scenario
        self.followed = 0

    def ahead(self, scenario: Scenario) -> Scenario:
        """Return a scenario with what is left of the sequence: what was made and changed again since is not made twice."""
        return scenario.model_copy(update={"sequence": self.now.sequence[self.followed :]})

    def adopt(self, part: str, new: Scenario, asked: Changes) -> None:
        """Take over one part of `new`, which `asked` made: the sequence may have changed another one meanwhile.

        The change holds beyond a reset.
        """
        self.now = self.now.model_copy(update={part: getattr(new, part)})
        self.beginning = begun_with(self.beginning, part, asked) if self.now.sequence else self.now

    def put(self, part: str, source: Scenario) -> None:
        """Take over one part of another scenario, beyond a reset too."""
        self.now = self.now.model_copy(update={part: getattr(source, part)})
        self.beginning = self.beginning.model_copy(update={part: getattr(source, part)})

    def words_of_entry(self, index: int, before: Scenario) -> list[str]:
        """Return each change that stands at a place of the sequence as words; `before` is the scenario until then."""
        changed = self.now.sequence[index].changes.items()
        return [change_words(self.now, path, valued(before, path), value) for path, value in changed]

    def follow(self, index: int) -> list[PartChange]:
        """Make the change that stands at a place of the sequence, and return what became different, part by part."""
        changed = dict(self.now.sequence[index].changes)
        self.followed = index + 1
        before, self.now = self.now, after_change(self.now, changed)
        parts = dict.fromkeys(path.split(".")[0] for path in changed)
        return [PartChange(part, part_differences(before, self.now, part)) for part in parts]


def part_differences(before: Scenario, after: Scenario, part: str) -> dict[str, tuple[Any, Any]]:
    """Return before and after of every value that differs in a part, by path relative to it."""
    return differences(part_document(before, part), part_document(after, part))


def part_document(scenario: Scenario, part: str) -> dict[str, Any]:
    """Return a part of the scenario as JSON takes it."""
    document: dict[str, Any] = getattr(scenario, part).model_dump(mode="json")
    return document
