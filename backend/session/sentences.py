"""What a session says in words: its state, with the reason."""

from backend.loop.messages import State
from backend.words.changes import change_words
from vssea_core.scenario import Scenario
from vssea_core.signals.documents import Reference

__all__ = ["change_words", "reference_words", "state_sentence"]


def state_sentence(state: State, reason: str | None, time_s: float, by: str | None, scenario: Scenario) -> str:
    """Return what the session is doing, and why."""
    following = reference_words(scenario.reference)
    match state:
        case "starting":
            return "Starting: the control kernel is being compiled (some seconds at the first start)"
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
