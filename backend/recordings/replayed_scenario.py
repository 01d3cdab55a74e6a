"""A recording as a scenario that can be simulated: what it began with, and each live change as an entry of its sequence."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from backend.recordings.layout import CHANGES, COMMANDS, EVENTS, SCENARIO
from backend.recordings.reader import SAME_INSTANT_S, Recording
from backend.recordings.timeline import name_of, scenario_document, validated
from vssea_core.scenario import MAX_SAMPLES, Scenario, TimedChange

MOST_CHANGES = 2000
"""Each is designed anew. A scenario that is written down has fewer, but a dragged slider makes thirty a second."""
LONGEST_S = 120.0
LARGEST_CHANGE = 64
Document = dict[str, Any]


@dataclass(frozen=True)
class Replayed:
    """A scenario, and the tuning's id at its begin."""

    scenario: Scenario
    tuning_id: int


def replayed_scenario(recording: Recording, to_s: float | None = None) -> Replayed:
    """Return the scenario that gives the recording again when it is simulated, up to `to_s` [s].

    What the scenario's own sequence did is among the recorded changes, so these take its place. Raises ValueError, with the
    span that can be simulated, if it is too long, has too many changes, was stopped, or does not begin at t = 0.
    """
    name = name_of(recording)
    document = scenario_document(recording)
    if document is None:
        raise ValueError(f"{name} holds no scenario to simulate; choose a recording of the live session")
    period_s = float(document["timing"]["sample_time_s"])
    first_s, last_s = recording.span
    if recording.samples == 0:
        raise ValueError(f"{name} has no samples; choose another recording")
    if first_s > 0.5 * period_s:
        raise ValueError(
            f"{name} begins at t = {first_s:g} s, and what the actuator did before is not in it; "
            "choose the part that begins at t = 0"
        )
    end_s = last_s if to_s is None else min(to_s, last_s)
    changes = recording.documents(CHANGES)
    _refuse_long(recording, changes, end_s, period_s, is_asked=to_s is not None)
    samples = int(np.floor(end_s / period_s + 1e-6)) + 1
    sequence = _sequence(document, [change for change in changes if change["at_s"] <= end_s + SAME_INSTANT_S])
    document["sequence"], document["duration_s"] = [], samples * period_s
    scenario = validated(document, name).model_copy(update={"sequence": sequence})
    begun = recording.documents(SCENARIO)[0]
    return Replayed(scenario, int(begun.get("tuning_id", 1)))


def _refuse_long(
    recording: Recording, changes: list[Document], end_s: float, period_s: float, *, is_asked: bool
) -> None:
    """Raise ValueError with the longest span that can be simulated, if `end_s` is beyond it."""
    limits = [
        (LONGEST_S - period_s, f"a simulation lasts at most {LONGEST_S:g} s"),
        ((MAX_SAMPLES - 1) * period_s, f"a simulation has at most {MAX_SAMPLES} samples"),
    ]
    if len(changes) > MOST_CHANGES:
        over_s = float(changes[MOST_CHANGES]["at_s"])
        limits.append((over_s - period_s, f"at most {MOST_CHANGES} changes are simulated again, and more were made"))
    stopped_s = stop_time(recording)
    if stopped_s is not None:
        limits.append((stopped_s - period_s, f"STOP was pressed at {stopped_s:g} s, and a scenario has no STOP"))
    limit_s, why = min(limits)
    if end_s <= limit_s + 1e-6 * period_s:
        return
    span = f"{end_s:g} s were asked for" if is_asked else f"it lasts {end_s:g} s"
    if limit_s < 0.0:
        raise ValueError(f"{name_of(recording)} cannot be simulated: {why}")
    raise ValueError(
        f"{name_of(recording)} can be simulated up to {np.floor(limit_s * 1e6) / 1e6:g} s, and {span}: {why}; "
        f'ask for that span with {{"to_s": {np.floor(limit_s * 1e6) / 1e6:.10g}}}'
    )


def stop_time(recording: Recording) -> float | None:
    """Return when the motor was stopped on request [s], None if it never was."""
    times = [
        float(event["at_s"])
        for event in recording.documents(EVENTS)
        if event.get("kind") == "state" and str(event.get("message", "")).startswith("Stopped")
    ]
    if not times:  # the event may have come after the recording ended
        times = [
            float(told["at_s"])
            for told in recording.documents(COMMANDS)
            if told.get("command") == "stop" and told["ok"]
        ]
    return min(times, default=None)


def _sequence(document: Document, changes: list[Document]) -> tuple[TimedChange, ...]:
    """Return the recorded changes as entries of a sequence, each with the paths whose values it changed."""
    parts = {name: value for name, value in document.items() if isinstance(value, dict)}
    entries = []
    for change in changes:
        part, after = change["part"], change["document"]
        paths = paths_between(parts[part], after, part)
        parts[part] = after
        paths = paths if len(paths) <= LARGEST_CHANGE else {part: after}
        entries.append(TimedChange(at_s=change["at_s"], changes=paths))
    return tuple(entries)


def paths_between(before: Any, after: Any, path: str) -> Document:
    """Return the values by path that turn one document into the other; a new kind comes with all that belongs to it."""
    if not isinstance(before, dict) or not isinstance(after, dict):
        return {} if before == after else {path: after}
    if before.get("kind") != after.get("kind"):
        return {f"{path}.{name}": value for name, value in after.items()}
    if set(before) != set(after):
        return {path: after}
    found: Document = {}
    for name, value in after.items():
        found |= paths_between(before[name], value, f"{path}.{name}")
    return found
