"""Laws of the telemetry ring: what was written is read, what was lost is counted, and nothing is mixed."""

from collections.abc import Callable, Iterator

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from backend.telemetry.ring import CAPACITY, COLUMNS, MARGIN, Ring, RingReader, RingWriter
from backend.telemetry.stop_flag import StopFlag


class Ends:
    """Both ends of one ring; every value of a sample is its sequence number."""

    def __init__(self) -> None:
        self.ring = Ring()
        self.writer, self.reader = RingWriter(self.ring.name), RingReader(self.ring.name)

    def write(self, count: int) -> None:
        while count:
            _, rows = self.writer.room(count)
            rows[:] = self.writer.written + np.arange(len(rows))[:, np.newaxis]
            self.writer.announce(len(rows))
            count -= len(rows)

    def close(self) -> None:
        self.reader.close()
        del self.writer.header, self.writer.samples
        self.writer._memory.close()
        self.ring.close()


@pytest.fixture
def ends() -> Iterator[Ends]:
    opened = Ends()
    yield opened
    opened.close()


def consecutive(samples: np.ndarray, first: int) -> bool:
    expected = np.arange(first, first + len(samples))[:, np.newaxis]
    return samples.shape[1] == COLUMNS and bool((samples == expected).all())


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(st.integers(0, 5000), min_size=1, max_size=20))
def test_nothing_is_lost_when_it_is_read_in_time(ends: Ends, amounts: list[int]) -> None:
    due = ends.reader.written
    for amount in amounts:
        ends.write(amount)
        piece = ends.reader.since(due)
        assert (piece.first, len(piece.samples), piece.lost) == (due, amount, 0)
        assert consecutive(piece.samples, due)
        due += amount
    assert ends.reader.written == due


@settings(max_examples=20, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.integers(0, 2 * CAPACITY), st.integers(0, 2 * CAPACITY))
def test_what_was_overwritten_is_counted_exactly(ends: Ends, before: int, after: int) -> None:
    ends.write(before)
    due = ends.reader.written
    ends.write(after)
    piece = ends.reader.since(due)
    assert piece.lost + len(piece.samples) == after
    assert piece.first == due + piece.lost
    assert consecutive(piece.samples, piece.first)
    assert (piece.lost > 0) == (after > CAPACITY - MARGIN)


def test_a_piece_is_no_longer_than_asked(ends: Ends) -> None:
    ends.write(5000)
    piece = ends.reader.since(100, 50)
    assert (piece.first, len(piece.samples), piece.lost) == (100, 50, 0)


class Overtaken(RingReader):
    """A reader that the writer catches up with between its look at the count and its copy."""

    meanwhile: Callable[[], None] | None = None

    @property
    def written(self) -> int:
        count = super().written
        race, self.meanwhile = self.meanwhile, None
        if race is not None:
            race()
        return count


@pytest.mark.parametrize("announced", [0, 1, 63, 2 * MARGIN, CAPACITY // 2, 2 * CAPACITY])
def test_a_piece_never_holds_what_the_writer_is_just_overwriting(ends: Ends, announced: int) -> None:
    ends.write(CAPACITY + 12_345)
    reader = Overtaken(ends.ring.name)

    def overtake() -> None:
        ends.write(announced)
        ends.writer.room(CAPACITY)[1][:] = -1.0  # being filled, not announced

    reader.meanwhile = overtake
    piece = reader.since(0)
    assert consecutive(piece.samples, piece.first)
    assert piece.first == piece.lost
    reader.close()


def test_the_latest_sample_is_the_last_announced(ends: Ends) -> None:
    assert ends.reader.latest() is None
    for amount in (1, 7, CAPACITY - 8, 3):  # the last two end at, and pass, the end of the segment
        ends.write(amount)
        newest = ends.reader.latest()
        assert newest is not None
        assert newest[0] == ends.reader.written - 1


def test_the_last_samples_are_those_before_the_count(ends: Ends) -> None:
    ends.write(CAPACITY + 500)
    piece = ends.reader.last(1000)
    assert (piece.first, len(piece.samples)) == (CAPACITY - 500, 1000)
    assert consecutive(piece.samples, piece.first)


def test_a_reader_ahead_of_the_writer_gets_nothing_and_lost_nothing(ends: Ends) -> None:
    ends.write(10)
    piece = ends.reader.since(10)
    assert (len(piece.samples), piece.lost) == (0, 0)


def test_every_stop_is_seen_by_whoever_opened_the_flag() -> None:
    owner = StopFlag()
    other = StopFlag(owner.name)
    for count in range(3):
        assert owner.count == other.count == count
        other.raise_()
    other.close()
    owner.close()
