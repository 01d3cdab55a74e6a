"""What a session says in words: its state with the reason, and each change."""

from typing import Any

from backend.differences import change_words as change_words
from backend.loop.messages import State
from vssea_core.scenario import Scenario
from vssea_core.signals.documents import Reference

MOST_WORDS = 6


def state_sentence(state: State, reason: str | None, time_s: float, by: str | None, scenario: Scenario) -> str:
    """Return what the session is doing, and why."""
    following = reference_words(scenario.reference)
    match state:
        case "starting":
            return reason or "Starting: the control kernel is being compiled (some seconds at the first start)"
        case "ready":
            return "Ready at t = 0. Press Run to start"
        case "running":
            return f"Running, {following}"
        case "paused":
            return f"Paused at {time_s:.3f} s, {following}"
        case "stopped":
            return f"Stopped by {by or 'request'} at {time_s:.1f} s: motor torque off, stiffness held. Reset to go on"
        case "fault":
            return f"Fault: {reason}"
        case _:
            return f"{state.capitalize()}"  # a rig's own; rig_sentences has the words


def reference_words(reference: Reference) -> str:
    """Return the reference as a participle clause."""
    match reference.kind:
        case "sine":
            return f"tracking sine {reference.amplitude:.2f} rad, {reference.frequency_hz:.2f} Hz"
        case "move":
            return f"moving {reference.origin:.2f} to {reference.target:.2f} rad in {reference.duration_s:.2f} s"
        case "step":
            return f"stepping {reference.origin:.2f} to {reference.target:.2f} rad"
        case "multisine":
            return f"tracking {len(reference.components)} sines"
        case "filtered_step":
            return f"stepping {reference.origin:.2f} to {reference.target:.2f} rad, filtered"
        case "chirp":
            sweep = f"{reference.start_frequency_hz:.2f} to {reference.end_frequency_hz:.2f} Hz"
            return f"sweeping {sweep}, {reference.amplitude:.2f} rad"
        case "jog":
            return f"jogging at {reference.velocity:.2f} rad/s"
        case "recorded":
            return f"following {len(reference.times_s)} recorded samples"


def changes_words(scenario: Scenario, part: str, pairs: dict[str, tuple[Any, Any]]) -> list[str]:
    """Return changes of a part ("" = of the whole scenario, where another name says enough), each as words."""
    if not part and "name" in pairs:
        return [f"scenario {pairs['name'][0]} → {pairs['name'][1]}"]
    prefix = f"{part}." if part else ""
    return [change_words(scenario, f"{prefix}{path}", *pair) for path, pair in pairs.items()]


def several(words: list[str]) -> str:
    """Return some words in one line, the first of them if they are many."""
    more = len(words) - MOST_WORDS
    return ", ".join(words[:MOST_WORDS]) + (f" and {more} more" if more > 0 else "") or "no change in the end"


def whose(made_by: str, by: str) -> str:
    """Return whose change it was, if it was another's than that of `by`."""
    return "" if made_by == by else f" the change of {made_by}"
