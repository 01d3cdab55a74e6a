"""A run with live changes, recorded: the closed loop advanced as the control process does it, written as the writer does it."""

import itertools
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from backend.recordings.chunks import Document
from backend.recordings.layout import CHANGES, COMMANDS, EVENTS, SCENARIO
from backend.recordings.reader import Recording
from backend.recordings.recording_file import RecordingFile
from backend.session.changes import Changes, with_changes
from backend.telemetry.ring import COLUMNS, WIDTH, Samples
from vssea_core.scenario import Scenario
from vssea_core.simulation.closed_loop import ClosedLoop
from vssea_core.simulation.run import prepare_scenario

Change = tuple[int, str, dict[str, Any]]
"""Sample number, part of the scenario, changes by path."""
HEAD = {
    "id": "2026-01-01T12-00-00-000Z", "format": "1", "begun_at": "2026-01-01T12:00:00.000Z", "begin_ns": "1767268800000000000",
    "origin": "live", "scenario": "nominal", "first_sample": "0", "part": "1",
}  # fmt: skip


def recorded(
    path: Path,
    scenario: Scenario,
    samples: int,
    changes: Sequence[Change] = (),
    events: Sequence[dict[str, Any]] = (),
    commands: Sequence[dict[str, Any]] = (),
    tuning_id: int = 7,
    pieces: Sequence[int] = (1, 3, 250, 17),
) -> Recording:
    """Record `samples` samples of a live run; it advances by `pieces` of samples in turn."""
    loop = ClosedLoop(scenario, prepare_scenario(scenario), tuning_id)
    file = RecordingFile.create(path, HEAD | {"sample_time_s": repr(loop.period_s)})
    begun = {"n": -1, "at_s": 0.0, "tuning_id": tuning_id, "scenario": scenario.model_dump(mode="json")}
    file.append_documents([Document(SCENARIO, 0.0, begun)])
    now, done, sizes, told = scenario, 0, itertools.cycle(pieces), []
    for number, (at, part, asked) in enumerate([*changes, (samples, "", {})], 1):
        while done < at:
            rows = np.empty((min(next(sizes), at - done), WIDTH))
            loop.advance(rows)
            file.append_samples(as_samples(rows, loop.period_s), done)
            done += len(rows)
        if not part:
            break
        now = with_changes(now, part, Changes(changes=asked))
        if part == "tuning":
            tuning_id += 1
            loop.install(now.tuning, prepare_scenario(now).prepared, tuning_id)
        else:
            way = {"stiffness_reference": "stiffness"}.get(part, part)
            getattr(loop, f"set_{way}")(getattr(now, part))
        document = getattr(now, part).model_dump(mode="json")
        content = {"n": number, "at_s": loop.time_s, "epoch": 1, "by": "page 1", "part": part, "tuning_id": tuning_id,
                   "words": [f"{part} changed"], "changes": asked, "document": document}  # fmt: skip
        told.append(Document(CHANGES, loop.time_s, content))
    told += [Document(EVENTS, event["at_s"], {"n": 1000 + n, **event}) for n, event in enumerate(events)]
    told += [Document(COMMANDS, command["at_s"], {"n": 2000 + n, **command}) for n, command in enumerate(commands)]
    if told:
        file.append_documents(told)
    file.finish(reason="another run began", lost="0")
    return Recording(path)


def as_samples(rows: np.ndarray, period_s: float) -> Samples:
    """Return rows (n, channels) as a ring holds them."""
    samples = np.zeros((len(rows), COLUMNS))
    samples[:, :WIDTH] = rows
    samples[:, WIDTH], samples[:, WIDTH + 1] = 1.0, period_s
    samples[:, WIDTH + 2], samples[:, WIDTH + 3] = 3.5, 1.25
    return samples


def with_gaps(path: Path, pieces: Sequence[tuple[int, np.ndarray]], period_s: float = 1e-3) -> Recording:
    """Record pieces of rows (n, channels), each with the number of its first sample."""
    file = RecordingFile.create(path, HEAD | {"sample_time_s": repr(period_s)})
    for first, rows in pieces:
        for start in range(0, len(rows), 250):
            file.append_samples(as_samples(rows[start : start + 250], period_s), first + start)
    file.finish(reason="another run began", lost="0")
    return Recording(path)


def noise_rows(count: int, first: int = 0, seed: int = 1, period_s: float = 1e-3) -> np.ndarray:
    """Return rows (count, channels) of noise with times and plausible limits."""
    rows = np.random.default_rng([seed, first]).standard_normal((count, WIDTH))
    rows[:, 0] = period_s * np.arange(first, first + count)
    rows[:, 27] = np.random.default_rng([seed, first, 1]).integers(0, 16, count)
    return rows
