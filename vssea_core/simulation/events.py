"""What a scenario asks for and what hits it, one event after another, and how the recorded link answered each.

An event's window ends where the next event begins, so that each figure belongs to one cause.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import groupby
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vssea_core.channels import INDEX
from vssea_core.scenario import Scenario
from vssea_core.simulation.settling import recovery_time
from vssea_core.simulation.step_response import BAND, StepMetrics, step_metrics

Rows = NDArray[np.float64]
Kind = Literal["reference", "disturbance", "stiffness"]

RECOVERY_BAND = 1e-3
"""Error [rad] within which the link counts as recovered."""
SLACK_S = 1e-9
REST_TO_REST = {"origin", "target", "start_s", "dwell_s", "repeat"}


class Event(NamedTuple):
    """One thing that happens, by the document: when [s], and for a move or step of the reference from where to where [rad]."""

    kind: Kind
    time_s: float
    label: str
    origin: float = math.nan
    target: float = math.nan


@dataclass(frozen=True)
class EventMetrics:
    """How the link answered one event, over the window `time_s` to `until_s` [s]."""

    kind: Kind
    label: str
    time_s: float
    until_s: float
    peak_error: float
    """Largest |reference - link| in the window [rad]."""
    recovery_time_s: float | None
    """Seconds until |reference - link| is within the recovery band for good; None if it is not by the window's end."""
    step: StepMetrics | None
    """For a move or step of the reference: link position against the document's target, from the event's time."""
    undefined: dict[str, str] = field(default_factory=dict)
    """Why a figure is None, by its name."""


def event_metrics(
    scenario: Scenario,
    rows: Rows,
    *,
    band: float = BAND,
    recovery_band: float = RECOVERY_BAND,
    reference_set_at_s: float = 0.0,
) -> tuple[EventMetrics, ...]:
    """Return the EventMetrics of every event of `scenario` that `rows` (samples, channels) recorded from its start on.

    `band` is the settling band as a share of a step, `recovery_band` in rad; `reference_set_at_s` is when the references were
    set, in scenario time [s]. Disturbances of one instant are one event; events of one instant share a window.
    """
    if not len(rows):
        return ()
    time = rows[:, INDEX["time"]]
    first, end = float(time[0]), float(time[-1])
    events = _merged(_events(scenario, end, reference_set_at_s))
    answers = []
    for event in events:
        if not first - SLACK_S <= event.time_s <= end + SLACK_S:
            continue
        later = [other.time_s for other in events if other.time_s > event.time_s + SLACK_S]
        until = min([*later, math.inf])
        window = rows[(time >= event.time_s - SLACK_S) & (time < until - SLACK_S)]
        if len(window):
            answers.append(_answer(event, window, min(until, end), band, recovery_band))
    return tuple(answers)


def _answer(event: Event, window: Rows, until_s: float, band: float, recovery_band: float) -> EventMetrics:
    time, position, error = (window[:, INDEX[name]] for name in ("time", "link_position", "error"))
    step = None
    if event.kind == "reference":
        step = step_metrics(time, position, event.origin, event.target, band, origin_s=event.time_s)
    recovery = recovery_time(time, error, event.time_s, recovery_band)
    undefined = {}
    if recovery is None:
        left = abs(float(error[-1]))
        undefined["recovery_time_s"] = f"error {left:.3g} rad at the end, outside the band of {recovery_band:g} rad"
    return EventMetrics(
        kind=event.kind,
        label=event.label,
        time_s=event.time_s,
        until_s=until_s,
        peak_error=float(np.abs(error).max()),
        recovery_time_s=recovery,
        step=step,
        undefined=undefined,
    )


def _merged(events: Iterator[Event]) -> list[Event]:
    """Return the events in order of time, those of one kind and instant as one that names them all."""
    ordered = sorted(events, key=lambda event: (event.time_s, event.kind))
    groups = [list(group) for _, group in groupby(ordered, key=lambda event: (event.time_s, event.kind))]
    return [group[0]._replace(label="; ".join(dict.fromkeys(event.label for event in group))) for group in groups]


def _events(scenario: Scenario, end_s: float, set_at_s: float) -> Iterator[Event]:
    yield from _moves(scenario.reference.model_dump(), end_s, set_at_s)
    stiffness = scenario.stiffness_reference
    if stiffness.kind == "move":
        label = f"stiffness {stiffness.stiffness:g} to {stiffness.target:g} N·m/rad"
        yield Event("stiffness", set_at_s + stiffness.start_s, label)
    for side in type(scenario.disturbances).model_fields:
        for term in getattr(scenario.disturbances, side):
            name = f"{term.kind} on the {side.replace('_', ' ')}"
            yield Event("disturbance", term.start_s, f"{name} starts")
            if term.end_s is not None:
                yield Event("disturbance", term.end_s, f"{name} ends")


def _moves(reference: dict[str, Any], end_s: float, set_at_s: float) -> Iterator[Event]:
    """Yield the moves or steps of a reference that rests in between, up to `end_s`; other references have none."""
    if not reference.keys() >= REST_TO_REST:
        return
    origin, target = reference["origin"], reference["target"]
    cycle = reference.get("duration_s", 0.0) + reference["dwell_s"]
    turn, start = 0, set_at_s + reference["start_s"]
    while start + turn * cycle <= end_s:
        yield Event(
            "reference", start + turn * cycle, f"{reference['kind']} {origin:g} to {target:g} rad", origin, target
        )
        if not reference["repeat"]:
            return
        origin, target = target, origin
        turn += 1
