"""From the ring into files: one recording a run, cut into parts when it is long. No clock and no pipe of its own."""

import os
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from backend.recordings.chunks import Document
from backend.recordings.layout import CHANGES, SCENARIO
from backend.recordings.messages import Answer, Begin, Ended, Hold, Item, Note, Stopped, Wrote
from backend.recordings.reader import Recording
from backend.recordings.recording_file import FinishedRecording, RecordingFile
from backend.recordings.room import Room
from backend.telemetry.ring import EPOCH, PERIOD_S, RingReader, Samples
from vssea_core.channels import INDEX

MOST_SAMPLES = 20_000
CHUNK_SAMPLES = 1000
SHORTEST_RUN_S = 0.25
"""A shorter run that another one has already followed is not kept: a dragged slider of the rig restarts many times a second."""
BEGIN_LIMIT_S = 5.0
"""So long samples wait for the word of what run they belong to; the ring holds a minute."""
SYNC_EVERY_S = 1.0
LATE_S = 1.5
"""So long the recording of a run that is over stays open: an event is told once it has rested."""
Sync = Callable[[int, bool], None]


@dataclass(frozen=True)
class RunOver:
    """The recording of the run before, open until `until_s` for what is told late; `lost` are the samples it lacks."""

    file: RecordingFile
    epoch: int
    lost: int
    until_s: float


class Writing:
    """Writes what the ring holds and what is told. Call `take` with what came, then `turn` with the time."""

    def __init__(
        self,
        ring: RingReader,
        folder: Path,
        part_s: float,
        room: Room,
        tell: Callable[[Answer], None],
        sync: Sync = lambda descriptor, must: None,
    ) -> None:
        self._ring, self._folder, self._part_s, self._room = ring, folder, part_s, room
        self._tell, self._sync = tell, sync
        self._file: RecordingFile | None = None
        self._run: Begin | None = None
        self._over: RunOver | None = None
        self._scenario: dict[str, Any] = {}
        self._part = 1
        self._begins: dict[int, Begin] = {}
        self._notes: list[Note] = []
        self._item = 0
        self._next = 0
        self._lost = 0
        self._held: str | None = None
        self._stopped: str | None = None
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
        try:
            why = self._held or self._room.lacking(now_s, self._stopped is not None)
            if why is None:
                self._write_samples(now_s)
                self._write_notes()
                if self._file is not None:
                    self._stop_is(None)
                if self._over is not None and now_s >= self._over.until_s:
                    self._end_over()
                self._sync_now_and_then(now_s)
            else:
                self._leave(why)
        except OSError as error:
            self._leave(self._room.refused(error, now_s))
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
        if self._file is not None:
            self._end_file(reason)

    def _end_file(self, reason: str) -> None:
        file, self._file = self._file, None
        if file is not None:
            self._finish(file, reason, self._lost)

    def _end_over(self) -> None:
        over, self._over = self._over, None
        if over is not None:
            self._finish(over.file, "another run began", over.lost)

    def _finish(self, file: RecordingFile, reason: str, lost: int) -> None:
        descriptor = os.dup(file.descriptor)
        try:
            file.finish(reason=reason, lost=str(lost))
            self._sync(descriptor, True)
        finally:
            os.close(descriptor)
            file.close()  # also if the disk refused: the library finishes it once there is room
        self._tell(Ended(file.head["id"], str(file.path)))

    def abandon(self) -> None:
        """Leave what is open unfinished, as the end of the process does."""
        if self._file is not None:
            self._file.close()
        if self._over is not None:
            self._over.file.close()

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
                self._end_file(f"goes on in part {self._part + 1}")
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
            self._over, self._file = RunOver(self._file, self._run.epoch, self._lost, now_s + LATE_S), None
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
        files = {self._over.epoch: self._over.file} if self._over is not None else {}
        if self._file is not None:
            files[epoch] = self._file
        for number, file in files.items():
            told = [note.document for note in due if note.epoch == number]
            if told:
                file.append_documents(told)

    # ---- trouble

    def _leave(self, why: str) -> None:
        """Stop recording without waiting for anything; samples pass by until there is room again."""
        with suppress(OSError):
            self._end_over()
        if self._file is not None and not self._file.samples:
            self._file.close()
            self._file.path.unlink(missing_ok=True)
            self._file = None
        with suppress(OSError):
            self._end_file(why)
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
