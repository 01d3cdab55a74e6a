"""A span of a recording as a recording of its own."""

from pathlib import Path

import numpy as np

from backend.recordings.chunks import Document
from backend.recordings.layout import CHANGES, COLUMNS_KEPT, COMMANDS, EVENTS, SCENARIO, values_of
from backend.recordings.reader import Recording
from backend.recordings.recording_file import RecordingFile
from backend.recordings.timeline import scenario_document
from backend.telemetry.ring import COLUMNS


def write_span(recording: Recording, from_s: float, to_s: float, target: Path) -> None:
    """Write the samples of a span with the scenario at its begin and what happened in it. Raises ValueError if there are none."""
    file: RecordingFile | None = None
    for messages in recording.blocks(from_s, to_s):
        values = values_of(messages)
        first = int(messages["sequence"][0])
        if file is None:
            file = RecordingFile.create(target, recording.head | {"first_sample": str(first)})
            file.append_documents(_documents(recording, float(values[0, 0]), to_s))
        # What is missing stays missing: a chunk is of samples that follow each other.
        for numbers, rows in _consecutive(messages["sequence"].astype(np.int64), values):
            samples = np.zeros((len(rows), COLUMNS))
            samples[:, COLUMNS_KEPT] = rows
            file.append_samples(samples, int(numbers[0]))
    if file is None:
        low, high = recording.span
        raise ValueError(
            f"there are no samples from {from_s:g} to {to_s:g} s; this recording goes from {low:g} to {high:g} s"
        )
    file.finish(reason="a span of a longer one", lost=(recording.ending or {}).get("lost", "0"))


def _documents(recording: Recording, begin_s: float, to_s: float) -> list[Document]:
    scenario = scenario_document(recording, begin_s)
    begun = recording.documents(SCENARIO)
    changes = recording.documents(CHANGES)
    tuning_id = begun[0].get("tuning_id", 1) if begun else 1
    for change in changes:
        if change["at_s"] <= begin_s:
            tuning_id = change.get("tuning_id", tuning_id)
    found = [
        Document(SCENARIO, begin_s, {"n": -1, "at_s": begin_s, "tuning_id": tuning_id, "scenario": scenario or {}})
    ]
    for channel in (CHANGES, EVENTS, COMMANDS):
        told = changes if channel == CHANGES else recording.documents(channel)
        found += [Document(channel, each["at_s"], each) for each in told if begin_s < each["at_s"] <= to_s]
    return found


def _consecutive(numbers: np.ndarray, rows: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    gaps = np.flatnonzero(np.diff(numbers) % 2**32 != 1) + 1
    return list(zip(np.split(numbers, gaps), np.split(rows, gaps), strict=True))
