"""What differs between the scenarios of two recordings, or between a recording and the live session."""

from typing import Any

from backend.differences import told
from backend.recordings.reader import Recording
from backend.recordings.timeline import known_scenario
from vssea_core.scenario import Scenario

ABOUT = ("name", "description")
"""Fields that say what a scenario is called, not what it does."""


def difference(recording: Recording, at_s: float | None, against: Recording | Scenario) -> dict[str, Any]:
    """Return what changes from a recording's scenario, at `at_s` [s] or at its end, to another's at its end or the live one.

    Raises ValueError if a recording holds no scenario.
    """
    before = known_scenario(recording, recording.span[1] if at_s is None else at_s)
    after = known_scenario(against, against.span[1]) if isinstance(against, Recording) else against
    changes = [each.document() for each in told(before, after) if each.path not in ABOUT]
    return {"changes": changes, "same": not changes}
