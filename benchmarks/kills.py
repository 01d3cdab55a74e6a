"""SIGKILLs of the recording process at random moments, all channels at 1 kHz: unreadable files, longest tail lost."""

import os
import random
import signal
import tempfile
import time
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path

import numpy as np
from mcap.reader import make_reader
from mcap.records import Message
from mcap.stream_reader import StreamReader

from backend.processes import CONTEXT, started
from backend.recordings.chunks import Document
from backend.recordings.folder import recover
from backend.recordings.layout import COLUMNS_KEPT, EVENTS, FIELDS, TELEMETRY
from backend.recordings.messages import Begin, Note
from backend.recordings.reader import Recording
from backend.telemetry.ring import COLUMNS, EPOCH, PERIOD_S, WIDTH, Ring, RingWriter, Samples
from vssea_core.scenarios import REALISTIC
from vssea_core.simulation.run import simulate

KILLS = 200
AT_ONCE = 4
PERIOD = 1e-3
NAMES = [each.name for each in FIELDS]


def ring_samples(count: int) -> Samples:
    """Return samples as the control process writes them: a run of `realistic` with the loop's timing beside it."""
    rows = simulate(REALISTIC.model_copy(update={"duration_s": count * PERIOD})).rows
    made = np.zeros((len(rows), COLUMNS))
    made[:, :WIDTH], made[:, EPOCH], made[:, PERIOD_S] = rows, 1, PERIOD
    made[:, PERIOD_S + 1 :] = np.random.default_rng(0).gamma(2.0, 30.0, (len(rows), COLUMNS - PERIOD_S - 1))
    return made


@dataclass
class Trial:
    """One writer process, its ring, and when it is to die."""

    folder: Path
    source: Samples
    ring: Ring = field(default_factory=Ring)
    written: int = 0
    begun_s: float | None = None
    lives_s: float = 0.0

    def start(self, chance: random.Random) -> None:
        """Start the writer, and tell it of a run."""
        self._writer = RingWriter(self.ring.name)
        self.lives_s = chance.uniform(0.3, 2.5)
        self.pipe: Connection
        self.pipe, theirs = CONTEXT.Pipe()
        arguments = (self.ring.name, str(self.folder), 3600.0, 0, (None, None, 0, 0), theirs)
        self.process: BaseProcess = started("vssea recorder", "backend.recordings.writer:run_writer", *arguments)
        theirs.close()
        self.pipe.send(
            Begin(1, 1, {"id": "run", "begin_ns": str(time.time_ns()), "origin": "live"}, {"name": "realistic"}, 1)
        )
        self._notes = 1

    @property
    def path(self) -> Path:
        """The recording."""
        return self.folder / "run.mcap"

    def feed(self, now_s: float, since_s: float) -> bool:
        """Write the samples that are due, and a note; kill the writer when it is its time. Return whether it still lives."""
        if self.begun_s is not None and now_s - self.begun_s >= self.lives_s and self.process.pid is not None:
            os.kill(self.process.pid, signal.SIGKILL)
            self.process.join()
            return False
        while self.pipe.poll():
            self.pipe.recv()
        due = min(len(self.source), int((now_s - since_s) / PERIOD))
        while self.written < due:
            _, room = self._writer.room(due - self.written)
            room[:] = self.source[self.written : self.written + len(room)]
            self._writer.announce(len(room))
            self.written += len(room)
        self._notes += 1
        self.pipe.send(Note(self._notes, 1, Document(EVENTS, now_s - since_s, {"n": self._notes, "message": "tick"})))
        if self.begun_s is None and self.path.exists():
            self.begun_s = now_s
        return True

    def close(self) -> None:
        """Remove ring and pipe."""
        self.pipe.close()
        del self._writer.samples, self._writer.header
        self.ring.close()


def whole_samples(path: Path) -> int:
    """Return how many samples the public reader finds before it meets the torn end."""
    count = 0
    with path.open("rb") as file:
        try:
            for record in StreamReader(file).records:
                count += isinstance(record, Message) and record.channel_id == TELEMETRY
        except Exception:  # noqa: BLE001 - whatever a torn record makes of the reader
            return count
    return count


def judge(trial: Trial) -> tuple[bool, float]:
    """Return whether the file is readable, before and after it is finished, to the bit, and the tail lost [s]."""
    whole = whole_samples(trial.path)
    recover(trial.path)
    read = Recording(trial.path).read(NAMES).rows
    with trial.path.open("rb") as file:
        summary = make_reader(file).get_summary()
    counted = summary.statistics.channel_message_counts[TELEMETRY] if summary and summary.statistics else 0
    same = read.tobytes() == trial.source[: len(read), COLUMNS_KEPT].tobytes()
    return whole > 0 and len(read) == whole == counted and same, (trial.written - len(read)) * PERIOD


def main(kills: int = KILLS) -> None:
    """Print what the kills cost."""
    chance = random.Random(4)
    source = ring_samples(30_000)
    unreadable, tails = 0, []
    for batch in range(0, kills, AT_ONCE):
        with tempfile.TemporaryDirectory() as folder:
            trials = [Trial(Path(folder) / str(n), source) for n in range(min(AT_ONCE, kills - batch))]
            for trial in trials:
                trial.start(chance)
            since_s, alive = time.monotonic(), list(trials)
            while alive:
                alive = [trial for trial in alive if trial.feed(time.monotonic(), since_s)]
                time.sleep(0.005)
            for trial in trials:
                is_readable, tail_s = judge(trial)
                unreadable += not is_readable
                tails.append(tail_s)
                trial.close()
    worst, median = max(tails), float(np.median(tails))
    print(f"{len(tails)} SIGKILLs of the recording process, {len(FIELDS)} numbers a sample at 1 kHz")
    print(f"  unreadable files {unreadable}, tail lost: median {1e3 * median:.0f} ms, longest {1e3 * worst:.0f} ms")


if __name__ == "__main__":
    main()
