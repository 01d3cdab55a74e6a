"""Everything about a recording but its samples: channels, tunings, events, commands, and the scenario at both ends."""

from typing import Any

from backend.recordings.layout import FIELDS
from backend.recordings.reader import Recording
from backend.recordings.summary import facts
from backend.recordings.timeline import commands, events, scenario_document, tunings
from vssea_core.channels import CHANNELS

GROUPS = {channel.name: channel.group for channel in CHANNELS}


def details(recording: Recording) -> dict[str, Any]:
    """Return it as docs/protocol.md has it."""
    return facts(recording) | {
        "channels": [
            {"name": field.name, "symbol": field.symbol, "unit": field.unit, "label": field.label,
             "group": GROUPS.get(field.name, "loop")}
            for field in FIELDS
        ],
        "tunings": tunings(recording),
        "events": events(recording),
        "commands": commands(recording),
        "scenario": scenario_document(recording),
        "final": scenario_document(recording, recording.span[1]),
    }  # fmt: skip


def row_at(recording: Recording, time_s: float) -> list[float]:
    """Return the sample nearest to a time [s], in the order of channels.CHANNELS. Raises ValueError if there are none."""
    from_s, to_s = recording.span
    if recording.samples == 0:
        raise ValueError("the recording has no samples, so there is no pose to show")
    at_s = min(max(time_s, from_s), to_s)
    names = [channel.name for channel in CHANNELS]
    reach_s = max(float(recording.head.get("sample_time_s", 0.0) or 0.0), 1e-3)
    while True:
        rows = recording.read(names, at_s - reach_s, at_s + reach_s).rows
        if len(rows):
            return [float(value) for value in rows[abs(rows[:, 0] - at_s).argmin()]]
        if reach_s > to_s - from_s + 1.0:
            raise ValueError("the samples of the recording cannot be read, so there is no pose to show")
        reach_s *= 8.0
