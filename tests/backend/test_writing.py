from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from backend.recordings.chunks import Document
from backend.recordings.layout import CHANGES, COLUMNS_KEPT, EVENTS, FIELDS, SCENARIO
from backend.recordings.messages import Answer, Begin, Ended, Hold, Note, Stopped, Wrote
from backend.recordings.reader import Recording
from backend.recordings.recording_file import RecordingFile
from backend.recordings.room import Room
from backend.recordings.writing import Writing
from backend.telemetry.ring import CAPACITY, MARGIN, RingReader
from tests.backend.recorded import Source, samples

NAMES = [field.name for field in FIELDS]
PLENTY = 10**12


class Bench:
    """A ring, a folder, and what the writing said; the clock is a number."""

    def __init__(self, folder: Path, part_s: float = 3600.0) -> None:
        self.folder, self.part_s = folder, part_s
        self.source = Source()
        self.free = PLENTY
        self.answers: list[Answer] = []
        self.now = 0.0
        self.number = 0
        self.writing = self.another()

    def another(self) -> Writing:
        room = Room(self.folder, 1000, lambda _: self.free)
        return Writing(RingReader(self.source.ring.name), self.folder, self.part_s, room, self.answers.append)

    def begin(self, epoch: int = 1, name: str = "run") -> Begin:
        self.number += 1
        head = {"id": f"{name}{epoch}", "begin_ns": "1700000000000000000", "origin": "live"}
        item = Begin(self.number, epoch, head, {"name": "nominal", "tuning": {"g": 1}}, 1)
        self.writing.take(item)
        return item

    def note(self, channel: int = EVENTS, epoch: int = 1, at_s: float = 0.0, **content: Any) -> None:
        self.number += 1
        self.writing.take(Note(self.number, epoch, Document(channel, at_s, {"n": self.number, "at_s": at_s} | content)))

    def turn(self, seconds: float = 0.25) -> None:
        self.now += seconds
        self.writing.turn(self.now)

    def files(self) -> list[str]:
        return sorted(path.stem for path in self.folder.glob("*.mcap"))

    def read(self, name: str) -> Recording:
        return Recording(self.folder / f"{name}.mcap")

    def close(self) -> None:
        self.writing.abandon()
        self.source.close()

    @property
    def wrote(self) -> Wrote:
        return [answer for answer in self.answers if isinstance(answer, Wrote)][-1]

    def said(self, kind: type) -> list[Any]:
        return [answer for answer in self.answers if isinstance(answer, kind)]


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    made = Bench(tmp_path)
    yield made
    made.close()


def test_everything_in_the_ring_is_on_disk_after_a_turn(bench: Bench) -> None:
    bench.begin()
    bench.source.put(samples(700))
    bench.turn()
    bench.source.put(samples(800, start=700))
    bench.turn()
    read = bench.read("run1")
    assert not read.is_finished
    assert read.read(NAMES).rows.tobytes() == samples(1500)[:, COLUMNS_KEPT].tobytes()
    assert bench.wrote.sample == 1500


def test_each_run_is_a_recording_of_its_own(bench: Bench) -> None:
    bench.begin(1)
    bench.source.put(samples(400, epoch=1))
    bench.begin(2)
    bench.source.put(samples(600, epoch=2))
    bench.turn()
    bench.writing.end("done")
    assert bench.files() == ["run1", "run2"]
    assert [ended.recording for ended in bench.said(Ended)] == ["run1", "run2"]
    assert bench.read("run1").samples == 400
    assert bench.read("run2").head["first_sample"] == "400"


def test_runs_that_another_followed_at_once_are_not_kept(bench: Bench) -> None:
    for epoch in range(1, 20):
        bench.begin(epoch)
        bench.source.put(samples(30, epoch=epoch))
    bench.turn()
    assert bench.files() == ["run19"]


def test_a_short_run_that_nothing_followed_is_kept(bench: Bench) -> None:
    bench.begin()
    bench.source.put(samples(30))
    bench.turn()
    assert bench.read("run1").samples == 30


def test_samples_wait_for_the_word_of_their_run_then_go_without(bench: Bench) -> None:
    bench.source.put(samples(100))
    bench.turn()
    assert bench.files() == []
    bench.begin()
    bench.turn()
    assert bench.read("run1").samples == 100
    bench.source.put(samples(100, epoch=2))
    for _ in range(25):
        bench.turn()
    assert bench.files()[1].startswith("unnamed-run-2")


def test_a_long_run_is_cut_into_parts_that_join_without_a_gap(tmp_path: Path) -> None:
    bench = Bench(tmp_path, part_s=1.0)
    bench.begin()
    bench.note(CHANGES, at_s=0.5, part="tuning", document={"g": 2})
    bench.source.put(samples(900))
    bench.turn()
    bench.source.put(samples(1600, start=900))
    bench.turn()
    bench.writing.end("done")
    assert bench.files() == ["run1", "run1-2", "run1-3"]
    second = bench.read("run1-2")
    assert second.head["part"] == "2"
    assert second.span == (1.0, pytest.approx(1.999))
    assert second.documents(SCENARIO)[0]["scenario"]["tuning"] == {"g": 2}
    parts = [bench.read(name) for name in bench.files()]
    assert sum(part.samples for part in parts) == 2500
    assert [part.last_number for part in parts] == [999, 1999, 2499]
    bench.close()


def test_notes_are_in_the_recording_of_their_run(bench: Bench) -> None:
    bench.begin(1)
    bench.source.put(samples(300, epoch=1))
    bench.note(epoch=1, at_s=0.1, message="first")
    bench.begin(2)
    bench.note(epoch=2, at_s=0.0, message="second")
    bench.turn()
    assert [note["message"] for note in bench.read("run1").documents(EVENTS)] == ["first"]
    assert bench.wrote.item < bench.number  # what waits for its samples is not done
    bench.source.put(samples(300, epoch=2))
    bench.turn()
    assert [note["message"] for note in bench.read("run2").documents(EVENTS)] == ["second"]
    assert bench.wrote.item == bench.number


def test_an_event_told_after_its_run_is_in_the_recording_of_that_run(bench: Bench) -> None:
    for epoch in (1, 2):
        bench.begin(epoch)
        bench.source.put(samples(300, epoch=epoch))
    bench.turn()
    bench.note(epoch=1, message="late")
    bench.turn(1.0)
    bench.turn(1.0)
    assert bench.read("run1").is_finished
    bench.note(epoch=1, message="far too late")
    bench.turn()
    assert [note["message"] for note in bench.read("run1").documents(EVENTS)] == ["late"]
    assert bench.read("run2").documents(EVENTS) == []
    assert bench.wrote.item == bench.number


def test_a_killed_writer_is_followed_without_loss_or_repetition(bench: Bench) -> None:
    run = bench.begin()
    bench.note(message="before")
    bench.source.put(samples(500))
    bench.turn()
    known = bench.wrote
    bench.note(message="written, but nobody heard of it")
    told_again = Note(
        bench.number,
        1,
        Document(EVENTS, 0.0, {"n": bench.number, "at_s": 0.0, "message": "written, but nobody heard of it"}),
    )
    bench.source.put(samples(300, start=500))
    bench.turn()
    bench.writing.abandon()  # as a SIGKILL does
    path = Path(known.path or "")
    path.write_bytes(path.read_bytes()[:-7])
    bench.writing = bench.another()
    bench.writing.resume(run, path, known.sample, known.item)
    bench.writing.take(told_again)
    bench.source.put(samples(200, start=800))
    bench.turn()
    bench.writing.end("done")
    read = bench.read("run1")
    assert read.read(NAMES).rows.tobytes() == samples(1000)[:, COLUMNS_KEPT].tobytes()
    assert len(read.read(["time"]).gaps()) == 0
    assert [note["message"] for note in read.documents(EVENTS)] == ["before", "written, but nobody heard of it"]


def test_what_the_ring_no_longer_holds_is_counted_as_lost(bench: Bench) -> None:
    bench.begin()
    bench.source.put(samples(100))
    bench.turn()
    many = CAPACITY + 500
    bench.source.put(samples(many, start=100))
    for _ in range(8):
        bench.turn()
    assert bench.wrote.lost == many - (CAPACITY - MARGIN)
    assert len(bench.read("run1").read(["time"]).gaps()) == 1


def test_a_disk_nearly_full_stops_the_recording_and_room_lets_it_go_on(bench: Bench) -> None:
    bench.begin()
    bench.source.put(samples(500))
    bench.turn()
    bench.free = 999
    bench.source.put(samples(500, start=500))
    bench.turn()
    assert "are kept free" in bench.said(Stopped)[-1].sentence
    assert bench.read("run1").is_finished
    bench.note(CHANGES, at_s=0.7, part="tuning", document={"g": 3})
    bench.turn()
    bench.free = 1050
    bench.turn()
    assert len(bench.said(Stopped)) == 1  # a little room is not enough to begin again
    bench.free = PLENTY
    bench.source.put(samples(500, start=1000))
    bench.turn()
    assert bench.said(Stopped)[-1].sentence == ""
    again = bench.read("run1-2")
    assert again.samples == 500
    assert again.documents(SCENARIO)[0]["scenario"]["tuning"] == {"g": 3}


def test_a_disk_that_refuses_stops_the_recording_not_the_writer(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    bench.begin()
    bench.source.put(samples(500))
    bench.turn()

    def refuse(*_: object) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr("backend.recordings.recording_file._write", refuse)
        bench.source.put(samples(500, start=500))
        for _ in range(100):
            bench.turn()
        assert [stopped.sentence for stopped in bench.said(Stopped)] == [  # told once, however often it is tried
            f"{bench.folder} cannot be written: No space left on device"
        ]
        assert bench.files() == ["run1"]
    assert bench.read("run1").samples == 500
    bench.turn(10.0)
    bench.source.put(samples(500, start=1000))
    bench.turn()
    assert bench.said(Stopped)[-1].sentence == ""
    assert bench.read("run1-2").samples == 500


def test_a_disk_that_refuses_between_two_parts_ends_the_first_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench = Bench(tmp_path, part_s=1.0)
    bench.begin()
    bench.source.put(samples(900))
    bench.turn()

    def refuse(*_: object) -> RecordingFile:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr(RecordingFile, "create", refuse)
        bench.source.put(samples(600, start=900))
        bench.turn()
        bench.turn()
    assert bench.files() == ["run1"]
    assert bench.read("run1").is_finished
    assert bench.read("run1").samples == 1000
    bench.close()


def test_what_a_run_lost_is_told_in_its_own_recording(bench: Bench) -> None:
    bench.begin(1)
    bench.source.put(samples(500, epoch=1))
    bench.turn()
    bench.source.put(samples(CAPACITY, start=500, epoch=1))
    for _ in range(5):
        bench.turn()
    lost = bench.wrote.lost
    bench.begin(2)
    bench.source.put(samples(500, epoch=2))
    bench.turn()
    bench.turn(10.0)
    assert lost > 0
    assert (bench.read("run1").ending or {})["lost"] == str(lost)
    assert bench.wrote.lost == 0


def test_a_hold_stops_and_its_end_goes_on(bench: Bench) -> None:
    bench.begin()
    bench.source.put(samples(500))
    bench.turn()
    bench.number += 1
    bench.writing.take(Hold(bench.number, "the quota is full"))
    bench.turn()
    assert bench.said(Stopped)[-1].sentence == "the quota is full"
    bench.number += 1
    bench.writing.take(Hold(bench.number, None))
    bench.source.put(samples(500, start=500))
    bench.turn()
    assert bench.files() == ["run1", "run1-2"]
