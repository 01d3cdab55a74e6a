"""What the recordings' workers can do: paths in; bytes, dictionaries or paths out. The web process never imports this module.

What needs a library that is slow to import brings it in at its first use, so that a recording opens at once.
"""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from backend.recordings.details import details, row_at
from backend.recordings.difference import difference
from backend.recordings.folder import recover as finish_open
from backend.recordings.reader import Recording
from backend.recordings.recorded_reference import recorded_reference
from backend.recordings.replayed_scenario import Replayed, replayed_scenario
from backend.recordings.samples import samples_answer
from backend.recordings.simulated import keep_simulation
from backend.recordings.summary import summary
from vssea_core.scenario import Scenario

if TYPE_CHECKING:
    from backend.compute.worker import Progress

__all__ = [
    "LONG",
    "describe",
    "differ",
    "export",
    "import_csv",
    "keep_simulated",
    "plan_replay",
    "pose_at",
    "preview_csv",
    "recover",
    "reference_of",
    "report_of",
    "samples_of",
    "spectrum_of",
    "summarise",
]

LONG = frozenset({"export"})
"""Jobs that tell their progress and can be cancelled; see compute.worker."""
Document = dict[str, Any]
OPENED = 8


@lru_cache(OPENED)
def _opened(path: str, inode: int, size: int, changed_ns: int) -> Recording:
    return Recording(Path(path))


def opened(path: str) -> Recording:
    """Return the recording at a path; its records are looked through again only if the file has changed.

    Raises ValueError if it is none, or no more.
    """
    try:
        status = Path(path).stat()
        return _opened(path, status.st_ino, status.st_size, status.st_mtime_ns)
    except OSError as error:
        why = error.strerror or str(error)
        raise ValueError(
            f"the recording {Path(path).stem} cannot be read: {why}; GET /api/recordings lists them"
        ) from error


@contextmanager
def room_needed() -> Iterator[None]:
    """Turn what a disk refuses into a sentence."""
    try:
        yield
    except OSError as error:
        raise ValueError(
            f"it cannot be written: {error.strerror or error}; make room on the disk and try again"
        ) from error


def summarise(path: str, cache: str | None) -> Document:
    """Return facts, metrics and picture, and keep the overview in the folder `cache`."""
    return summary(opened(path), Path(cache) if cache else None)


def recover(path: str) -> bool:
    """Finish a recording that its writer could not; return whether there was anything to do."""
    return finish_open(Path(path))


def describe(path: str, entry: Document) -> bytes:
    """Return everything but the samples as JSON, with what the list says of the recording."""
    found = details(opened(path))
    said = {name: value for name, value in entry.items() if value is not None and name not in ("events", "scenario")}
    return json.dumps(entry | found | said, ensure_ascii=False).encode()


def samples_of(path: str, channels: list[str], from_s: float, to_s: float, points: int, cache: str) -> bytes:
    """Return the binary answer with samples of a span."""
    return samples_answer(opened(path), channels, from_s, to_s, points, Path(cache))


def export(
    path: str, form: str, channels: list[str] | None, from_s: float, to_s: float, folder: str, progress: "Progress"
) -> tuple[str, str]:
    """Return media type and path of a new file in `folder`."""
    from backend.recordings import exports

    recording = opened(path)
    with room_needed():
        return exports.export(recording, form, channels, from_s, to_s, folder, progress)


def preview_csv(path: str, columns: Document | None, sample_rate_hz: float | None) -> Document:
    """Return what an import would read."""
    from backend.recordings.csv_import import csv_preview

    return csv_preview(Path(path), columns, sample_rate_hz)


def import_csv(
    path: str, target: str, head: dict[str, str], columns: Document | None, sample_rate_hz: float | None
) -> str:
    """Write a rig's own log as a recording; return where."""
    from backend.recordings.csv_import import csv_import

    with room_needed():
        return str(csv_import(Path(path), Path(target), head, columns, sample_rate_hz))


def plan_replay(path: str, to_s: float | None) -> tuple[Scenario, int]:
    """Return the scenario that gives a recording again, and the tuning's id at its begin."""
    replayed = replayed_scenario(opened(path), to_s)
    return replayed.scenario, replayed.tuning_id


def keep_simulated(path: str, scenario: Scenario, tuning_id: int, rows: str, target: str) -> bytes:
    """Write the rows of a simulation as a recording; return its id and the residual as JSON."""
    replayed = Replayed(scenario, tuning_id)
    recording, simulated = opened(path), np.load(rows)
    with room_needed():
        found = keep_simulation(recording, replayed, simulated, Path(target))
    return json.dumps({"kind": "simulate_recording", "recording": Path(target).stem, **found}).encode()


def spectrum_of(path: str, channels: list[str], from_s: float, to_s: float) -> bytes:
    """Return spectral densities as JSON."""
    from backend.recordings.spectrum import spectrum

    return json.dumps(spectrum(opened(path), channels, from_s, to_s), allow_nan=False).encode()


def differ(path: str, at_s: float | None, against: str | Scenario) -> Document:
    """Return what changes from a recording's scenario to another's, a recording's path or a scenario."""
    other = against if isinstance(against, Scenario) else opened(against)
    return difference(opened(path), at_s, other)


def reference_of(path: str, channel: str, from_s: float, to_s: float) -> Document:
    """Return a course of a recording as a reference document."""
    return recorded_reference(opened(path), channel, from_s, to_s)


def report_of(path: str, folder: str, cache: str) -> str:
    """Return the path of the report, one HTML page, in `folder`."""
    from backend.recordings.report import report

    recording = opened(path)
    with room_needed():
        return report(recording, Path(folder), Path(cache))


def pose_at(path: str, time_s: float) -> list[float]:
    """Return the sample nearest to a time."""
    return row_at(opened(path), time_s)
