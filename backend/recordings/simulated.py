"""The same scenario simulated, kept as a recording of its own, and what is left between the two."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from backend.recordings.chunks import Document
from backend.recordings.layout import CHANGES, SCENARIO
from backend.recordings.reader import Recording
from backend.recordings.recording_file import RecordingFile
from backend.recordings.replayed_scenario import Replayed
from backend.recordings.timeline import name_of, scenario_document
from backend.recordings.whole_file import whole_file
from backend.telemetry.ring import COLUMNS, EPOCH, PERIOD_S, WIDTH
from vssea_core.channels import CHANNELS, INDEX

CHUNK = 1000
Rows = NDArray[np.float64]


def simulated_id(recording: Recording) -> str:
    """Return the id of the recording of the simulation."""
    return f"{recording.head.get('id', recording.path.stem)}-simulated"


def keep_simulation(recording: Recording, replayed: Replayed, rows: Rows, target: Path) -> dict[str, Any]:
    """Write rows (n, channels) of the simulation as the recording `target`; return the residual against `recording`."""
    period_s = replayed.scenario.timing.sample_time_s
    head = {
        **recording.head, "id": simulated_id(recording), "name": f"{name_of(recording)}, simulated", "origin": "simulation",
        "of": recording.head.get("id", recording.path.stem), "part": "1", "first_sample": "0", "sample_time_s": repr(period_s),
    }  # fmt: skip
    with whole_file(target, head, "simulated") as file:
        _write(file, recording, replayed, rows)
    return residual(recording, rows, period_s)


def _write(file: RecordingFile, recording: Recording, replayed: Replayed, rows: Rows) -> None:
    end_s, period_s = float(rows[-1, INDEX["time"]]), replayed.scenario.timing.sample_time_s
    content = {"n": -1, "at_s": 0.0, "tuning_id": replayed.tuning_id, "scenario": scenario_document(recording)}
    changes = [change for change in recording.documents(CHANGES) if change["at_s"] <= end_s]
    file.append_documents(
        [Document(SCENARIO, 0.0, content), *(Document(CHANGES, change["at_s"], change) for change in changes)]
    )
    for first in range(0, len(rows), CHUNK):
        part = rows[first : first + CHUNK]
        samples = np.zeros((len(part), COLUMNS))
        samples[:, :WIDTH], samples[:, EPOCH], samples[:, PERIOD_S] = part, 1.0, period_s
        file.append_samples(samples, first)


def residual(recording: Recording, rows: Rows, period_s: float) -> dict[str, Any]:
    """Return root mean square and peak of recorded - simulated for each channel, and when they first differ [s]."""
    names = [channel.name for channel in CHANNELS]
    end_s = float(rows[-1, INDEX["time"]]) + 0.5 * period_s
    recorded = recording.read(names, to_s=end_s).rows
    places = np.rint(recorded[:, INDEX["time"]] / period_s).astype(np.intp)
    recorded, simulated = recorded[places < len(rows)], rows[places[places < len(rows)]]
    differs = (recorded != simulated) & ~(np.isnan(recorded) & np.isnan(simulated))
    with np.errstate(invalid="ignore"):
        left = np.where(differs, recorded - simulated, 0.0)
    first = np.flatnonzero(differs.any(axis=1))
    found = {}
    for column, channel in enumerate(CHANNELS):
        if channel.name == "time":
            continue
        values = left[:, column]
        finite = bool(np.isfinite(values).all())
        found[channel.name] = {
            "rms": float(np.sqrt(np.mean(values * values))) if finite else None,
            "peak": float(np.max(np.abs(values))) if finite else None,
            "unit": channel.unit,
        }
    return {
        "residual": found, "samples": len(recorded),
        "first_difference_s": float(recorded[first[0], INDEX["time"]]) if len(first) else None,
    }  # fmt: skip
