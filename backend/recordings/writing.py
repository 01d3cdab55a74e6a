"""From the ring into files: one recording a run, cut into parts when it is long. No clock and no pipe of its own."""

import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import suppress
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from backend.recordings.chunks import Document
from backend.recordings.layout import CHANGES, SCENARIO
from backend.recordings.messages import Answer, Begin, Ended, Hold, Item, Note, Stopped, Wrote
from backend.recordings.reader import Recording
from backend.recordings.recording_file import FinishedRecording, RecordingFile
from backend.telemetry.ring import EPOCH, PERIOD_S, RingReader, Samples
from vssea_core.channels import INDEX

MOST_SAMPLES = 20_000
CHUNK_SAMPLES = 1000
SHORTEST_RUN_S = 0.25
"""A shorter run that another one has already followed is not kept: a dragged slider of the rig restarts many times a second."""
BEGIN_LIMIT_S = 5.0
"""So long samples wait for the word of what run they belong to; the ring holds a minute."""
SYNC_EVERY_S = 1.0
RETRY_S = 10.0
LEAST_ROOM = 20_000_000
"""A recording that a disk has stopped is begun again after so long at the earliest, and with so many bytes to begin in."""
LATE_S = 1.5
"""So long the recording of a run that is over stays open: an event is told once it has rested."""
Free = Callable[[Path], int]
Sync = Callable[[int, bool], None]


def free_bytes(folder: Path) -> int:
    """Return the bytes that the disk of a folder has left."""
    return shutil.disk_usage(folder).free


class Writing:
    """Writes what the ring holds and what is told. Call `take` with what came, then `turn` with the time."""

    def __init__(
        self,
        ring: RingReader,
        folder: Path,
        part_s: float,
        keep_free: int,
        tell: Callable[[Answer], None],
        free: Free = free_bytes,
        sync: Sync = lambda descriptor, must: None,
    ) -> None:
        self._ring, self._folder, self._part_s, self._keep_free = ring, folder, part_s, keep_free
        self._tell, self._free, self._sync = tell, free, sync
        self._file: RecordingFile | None = None
        self._run: Begin | None = None
        self._over: tuple[RecordingFile, int, float] | None = None  # of the run before: its file, epoch, open until
        self._now_s = 0.0
        self._scenario: dict[str, Any] = {}
        self._part = 1
        self._begins: dict[int, Begin] = {}
        self._notes: list[Note] = []
        self._item = 0
        self._next = 0
        self._lost = 0
        self._held: str | None = None
        self._stopped: str | None = None
        self._retry_at = -np.inf
        self._waiting_since: float | None = None
        self._synced_at = 0.0

    def resume(self, run: Begin | None, path: Path | None, sample: int, item: int) -> None:
        """Go on where a writer ended: with the recording at `path` of `run`, else from a sample number."""
        self._next, self._item = sample, item
        if path is None or run is None:
            return
        try:
            with suppress(FinishedRecording):
                self._file = RecordingFile.reopen(path)
            found = Recording(path)
        except (OSError, ValueError):
            return
        self._run, self._part = run, int(found.head["part"])
        self._scenario, self._begins[run.epoch] = _scenario_after(found), run
        self._next = max(sample, found.last_number + 1)

    def take(self, item: Item) -> None:
        """Take one item; one that was taken before is left."""
        if item.number <= self._item:
            return
        self._item = item.number
        if isinstance(item, Begin):
            self._begins[item.epoch] = item
        elif isinstance(item, Hold):
            self._held = item.sentence
        else:
            self._notes.append(item)

    def turn(self, now_s: float) -> None:
        """Write all that is new. A disk that refuses stops the recording, and a later turn goes on when it can."""
        self._now_s = now_s
        try:
            why = self._held or self._lacking_room() or (self._stopped if now_s < self._retry_at else None)
            if why is None:
                self._write_samples(now_s)
                self._write_notes()
                if self._file is not None:
                    self._stop_is(None)
                if self._over is not None and now_s >= self._over[2]:
                    self._end_over()
                self._sync_now_and_then(now_s)
            else:
                self._leave(why)
        except OSError as error:
            self._retry_at = now_s + RETRY_S
            self._leave(f"{self._folder} cannot be written: {error.strerror or error}")
        self._tell(self._state())

    def _state(self) -> Wrote:
        waiting = [note.number for note in self._notes]
        waiting += [
            begin.number for epoch, begin in self._begins.items() if self._run is None or epoch > self._run.epoch
        ]
        done = min(waiting, default=self._item + 1) - 1
        file = self._file
        if file is None:
            return Wrote(done, self._next, None, None, 0, 0, self._lost)
        return Wrote(done, self._next, file.head["id"], str(file.path), file.size, file.samples, self._lost)

    def _sync_now_and_then(self, now_s: float) -> None:
        if now_s - self._synced_at >= SYNC_EVERY_S and self._file is not None:
            self._synced_at = now_s
            self._sync(self._file.descriptor, False)

    def end(self, reason: str) -> None:
        """Finish what is open."""
        self._end_over()
        file, self._file = self._file, None
        if file is not None:
            self._finish(file, reason)

    def _finish(self, file: RecordingFile, reason: str) -> None:
        descriptor = os.dup(file.descriptor)
        try:
            file.finish(reason=reason, lost=str(self._lost))
            self._sync(descriptor, True)
        finally:
            os.close(descriptor)
        self._tell(Ended(file.head["id"], str(file.path)))

    def _end_over(self) -> None:
        over, self._over = self._over, None
        if over is not None:
            self._finish(over[0], "another run began")

    def abandon(self) -> None:
        """Leave the present recording unfinished, as the end of the process does."""
        for file in (self._file, self._over and self._over[0]):
            if file is not None:
                file.close()

    # ---- samples

    def _write_samples(self, now_s: float) -> None:
        piece = self._ring.since(self._next, MOST_SAMPLES)
        self._lost += piece.lost
        self._next = piece.first
        segments = list(_of_one_epoch(piece.samples))
        for place, samples in enumerate(segments):
            epoch = int(samples[0, EPOCH])
            if self._run is None or self._file is None or self._run.epoch != epoch:
                is_passed = place + 1 < len(segments) and len(samples) * samples[0, PERIOD_S] < SHORTEST_RUN_S
                if not is_passed and not self._open(epoch, samples, now_s):
                    return
                if is_passed:
                    self._next += len(samples)
                    continue
            self._append(samples)

    def _append(self, samples: Samples) -> None:
        times, start = samples[:, INDEX["time"]], 0
        while start < len(samples) and self._run is not None and self._file is not None:
            if times[start] >= self._part * self._part_s:
                self._finish(self._file, f"goes on in part {self._part + 1}")
                self._create(self._run, samples[start:], int(times[start] // self._part_s) + 1)
                continue
            border = int(np.searchsorted(times, self._part * self._part_s))
            chunk = samples[start : min(start + CHUNK_SAMPLES, border)]
            self._file.append_samples(chunk, self._next)
            self._next += len(chunk)
            start += len(chunk)

    def _open(self, epoch: int, samples: Samples, now_s: float) -> bool:
        """Begin the recording of a run; return whether what is needed for it is known."""
        begin = self._begins.get(epoch)
        if begin is None:
            self._waiting_since = now_s if self._waiting_since is None else self._waiting_since
            if now_s - self._waiting_since < BEGIN_LIMIT_S:
                return False
            begin = Begin(
                0, epoch, {"id": f"unnamed-run-{epoch}-{self._next}", "begin_ns": "0", "origin": "live"}, {}, 0
            )
        self._waiting_since = None
        self._write_notes()
        self._end_over()
        if self._file is not None and self._run is not None:
            self._over, self._file = (self._file, self._run.epoch, self._now_s + LATE_S), None
        self._begins = {number: kept for number, kept in self._begins.items() if number >= epoch}
        if self._run is None or self._run.epoch != epoch:
            self._scenario, self._lost = dict(begin.scenario), 0
        self._create(begin, samples, int(samples[0, INDEX["time"]] // self._part_s) + 1)
        return True

    def _create(self, run: Begin, samples: Samples, part: int) -> None:
        name = self._free_name(run.head["id"], part)
        more = {
            "id": name, "part": str(part), "epoch": str(run.epoch), "first_sample": str(self._next),
            "sample_time_s": repr(float(samples[0, PERIOD_S])),
        }  # fmt: skip
        self._run, self._part = run, part
        self._file = RecordingFile.create(self._folder / f"{name}.mcap", run.head | more)
        at_s = float(samples[0, INDEX["time"]])
        content = {"n": -part, "at_s": at_s, "tuning_id": run.tuning_id, "scenario": self._scenario}
        self._file.append_documents([Document(SCENARIO, at_s, content)])

    def _free_name(self, name: str, part: int) -> str:
        while (self._folder / f"{_part_name(name, part)}.mcap").exists():
            part += 1
        return _part_name(name, part)

    # ---- what was told

    def _write_notes(self) -> None:
        """Write what belongs to the present run or the one before; what belongs to a later one waits for its samples."""
        epoch = self._run.epoch if self._run is not None else 0
        due = [note for note in self._notes if note.epoch <= epoch]
        self._notes = [note for note in self._notes if note.epoch > epoch]
        for note in due:
            content = note.document.content
            if note.document.channel == CHANGES and note.epoch == epoch:
                self._scenario[content["part"]] = content["document"]
        for file, number in ((self._file, epoch), self._over[:2] if self._over is not None else (None, 0)):
            told = [note.document for note in due if note.epoch == number]
            if told and file is not None:
                file.append_documents(told)

    # ---- trouble

    def _lacking_room(self) -> str | None:
        free = self._free(self._folder)
        needed = max(1.1 * self._keep_free, LEAST_ROOM) if self._stopped else self._keep_free
        if free >= needed:
            return None
        return (
            f"{self._folder} has {free / 1e9:.2f} GB left and {self._keep_free / 1e9:.2f} GB are kept free; "
            "delete recordings, or lower VSSEA_RECORDINGS_KEEP_FREE_GB"
        )

    def _leave(self, why: str) -> None:
        """Stop recording without waiting for anything; samples pass by until there is room again."""
        files = [self._file, self._over and self._over[0]]
        self._over = None
        for file in files:
            if file is None:
                continue
            if not file.samples:
                file.close()
                file.path.unlink(missing_ok=True)
                continue
            try:
                self._finish(file, why)
            except OSError:
                file.close()  # unfinished: the next start finishes it
        self._file = None
        self._write_notes()  # what they change holds when the recording goes on
        self._next = self._ring.written
        self._stop_is(why)

    def _stop_is(self, why: str | None) -> None:
        if (why is None) != (self._stopped is None):
            self._tell(Stopped(why or ""))
        self._stopped = why


def _part_name(name: str, part: int) -> str:
    return name if part == 1 else f"{name}-{part}"


def _of_one_epoch(samples: Samples) -> Iterator[Samples]:
    borders = [0, *(np.flatnonzero(np.diff(samples[:, EPOCH])) + 1).tolist(), len(samples)]
    for begin, end in pairwise(borders):
        if end > begin:
            yield samples[begin:end]


def _scenario_after(recording: Recording) -> dict[str, Any]:
    """Return the scenario as the last change that was written left it."""
    begun = recording.documents(SCENARIO)
    scenario: dict[str, Any] = dict(begun[-1]["scenario"]) if begun else {}
    for change in recording.documents(CHANGES):
        scenario[change["part"]] = change["document"]
    return scenario
