"""One hour at 1 kHz as a recording: its size, and the time to write, open, draw and export it, beside the public mcap reader."""

import resource
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from mcap.reader import make_reader
from rich.console import Console
from rich.table import Table

from backend.recordings.exports import export
from backend.recordings.reader import Recording
from backend.recordings.recording_file import RecordingFile
from backend.recordings.samples import samples_answer
from backend.recordings.summary import summary
from backend.telemetry.ring import COLUMNS, EPOCH, PERIOD_S, WIDTH
from vssea_core.channels import CHANNELS, INDEX
from vssea_core.scenarios import REALISTIC
from vssea_core.simulation.run import simulate

SECONDS, PERIOD = 3600, 1e-3
CHUNK = 250
"""Samples the writer finds at a turn: four turns a second."""
NINE = [
    "reference",
    "link_position",
    "motor_position",
    "error",
    "motor_torque",
    "link_disturbance",
    "stiffness",
    "deflection",
    "limits",
]


def write_hour(path: Path, seconds: int = SECONDS) -> None:
    """Write a recording of a repeated simulated run, its measured channels with noise, so that it packs as a real one does."""
    rows = simulate(REALISTIC).rows
    random = np.random.default_rng(1)
    head = {
        "id": path.stem,
        "format": "1",
        "begin_ns": "0",
        "origin": "live",
        "first_sample": "0",
        "sample_time_s": repr(PERIOD),
    }
    file = RecordingFile.create(path, head)
    noisy = [
        column for column, channel in enumerate(CHANNELS) if channel.unit and channel.name not in ("time", "reference")
    ]
    samples = np.zeros((CHUNK, COLUMNS))
    samples[:, EPOCH], samples[:, PERIOD_S] = 1, PERIOD
    for first in range(0, round(seconds / PERIOD), CHUNK):
        numbers = first + np.arange(CHUNK)
        samples[:, :WIDTH] = rows[numbers % len(rows)]
        samples[:, noisy] *= 1.0 + 1e-4 * random.standard_normal((CHUNK, len(noisy)))
        samples[:, INDEX["time"]] = numbers * PERIOD
        file.append_samples(samples, first)
    file.finish(reason="complete", lost="0")


def main() -> None:
    """Print size, memory and times."""
    table = Table("what", "time", title=f"a recording of {SECONDS / 3600:g} h at {1 / PERIOD:g} Hz")
    console = Console(width=120)

    def timed(words: str, work: Callable[[], object]) -> None:
        begun = time.perf_counter()
        work()
        table.add_row(words, f"{time.perf_counter() - begun:.2f} s")

    with tempfile.TemporaryDirectory(prefix="vssea-hour-") as name:
        folder = Path(name)
        path, cache = folder / "hour.mcap", folder / "cache"
        timed("write it", lambda: write_hour(path))
        size = path.stat().st_size
        memory = _memory_mb()
        timed("find the way in it", lambda: Recording(path))
        recording = Recording(path)
        timed("first: summary and overview, in one pass", lambda: summary(recording, cache))
        for words in ("draw the whole hour", "draw the whole hour again"):
            timed(
                f"{words}: 1500 points, {len(NINE)} channels",
                lambda: samples_answer(recording, NINE, points=1500, cache=cache),
            )
        timed("draw ten minutes of it", lambda: samples_answer(recording, NINE, 900.0, 1500.0, 1500, cache))
        timed("draw one minute of it", lambda: samples_answer(recording, NINE, 900.0, 960.0, 1500, cache))
        timed("draw 10 s of it", lambda: samples_answer(recording, NINE, 1800.0, 1810.0, 1500, cache))
        timed("public mcap reader, all messages, not decoded", lambda: _public(path))
        grown = _memory_mb() - memory
        for form in ("parquet", "csv"):
            timed(f"export as {form}", lambda form=form: export(recording, form, None, -np.inf, np.inf, str(folder)))
    console.print(table)
    console.print(
        f"{size / 1e6:.0f} MB on disk, {size / (SECONDS / PERIOD):.0f} bytes a sample; reading took {grown:.0f} MB more memory"
    )


def _public(path: Path) -> int:
    with path.open("rb") as file:
        return sum(1 for _ in make_reader(file).iter_messages(topics=["/telemetry"]))


def _memory_mb() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


if __name__ == "__main__":
    main()
