"""What a recording's card shows: facts, metrics over the whole of it, and a small picture. One pass, an hour never in memory."""

from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np

from backend.recordings.metrics_by_blocks import MetricsByBlocks
from backend.recordings.overview import Blocks, OverviewBuilder, all_rows, keep
from backend.recordings.reader import Recording
from backend.recordings.samples import drawn
from backend.recordings.timeline import events
from backend.telemetry.ring import WIDTH

PICTURE_POINTS = 120
PICTURED = ("link_position", "reference", "error")
Document = dict[str, Any]


def summary(recording: Recording, cache: Path | None = None) -> Document:
    """Return facts, metrics and picture; in the same pass the overview is made and kept in `cache`."""
    figures, builder = MetricsByBlocks(), OverviewBuilder()
    for numbers, rows in all_rows(recording):
        figures.take(rows[:, :WIDTH])
        builder.take(numbers, rows)
    blocks = builder.blocks()
    if cache is not None:
        keep(recording, cache, blocks)
    return {
        "facts": facts(recording, blocks),
        "metrics": figures.metrics(),
        "picture": picture(recording, blocks),
    }


def facts(recording: Recording, blocks: Blocks | None = None) -> Document:
    """Return what is known of a recording without its samples; `blocks` also tell how many are missing in it."""
    told = events(recording)
    ending = recording.ending or {}
    from_s, to_s = recording.span
    lost = int(ending.get("lost", 0) or 0)
    if blocks is not None and len(blocks):
        first = int(blocks["last_number"][0]) - int(blocks["count"][0]) + 1
        between = (int(blocks["last_number"][-1]) - first) % 2**32 + 1
        lost = max(lost, between - int(blocks["count"].sum()))
    return {
        "id": recording.head.get("id", recording.path.stem), "name": recording.head.get("name", ""),
        "scenario": recording.head.get("scenario", ""), "origin": recording.head.get("origin", "live"),
        "of": recording.head.get("of"), "started_at": _started_at(recording, from_s), "from_s": from_s, "to_s": to_s,
        "duration_s": to_s - from_s, "sample_time_s": float(recording.head.get("sample_time_s", 0.0)),
        "samples": recording.samples, "lost": lost, "state": _state(recording), "events": len(told),
        "faults": sum(event["severity"] == "fault" for event in told), "size": recording.path.stat().st_size,
        "part": int(recording.head.get("part", 1)), "ending": ending.get("reason"),
    }  # fmt: skip


def picture(recording: Recording, blocks: Blocks) -> Document | None:
    """Return a small picture: times [s] and a few channels, least and greatest values in turn; None of an empty recording."""
    if not len(blocks):
        return None
    shown = drawn(recording, list(PICTURED), -np.inf, np.inf, PICTURE_POINTS, lambda: blocks)
    columns = {name: _listed(shown.rows[:, place], 5) for place, name in enumerate(PICTURED)}
    return {"time": _listed(shown.time, 7), **columns}


def _listed(values: np.ndarray, digits: int) -> list[float | None]:
    return [float(f"{value:.{digits}g}") if np.isfinite(value) else None for value in values]


def _state(recording: Recording) -> str:
    if recording.damaged:
        return "damaged"
    if not recording.is_finished:
        return "recording"
    return "recovered" if (recording.ending or {}).get("recovered") == "true" else "complete"


def _started_at(recording: Recording, from_s: float) -> str:
    """Return when the first sample was taken, as wall time; the recording's own word for t = 0 if it is no time."""
    begun = recording.head.get("begun_at", "")
    try:
        at = datetime.fromisoformat(begun) + timedelta(seconds=from_s)
    except ValueError:
        return begun
    return at.isoformat(timespec="milliseconds").replace("+00:00", "Z")
