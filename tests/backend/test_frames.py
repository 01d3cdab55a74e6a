"""Telemetry frames decode as docs/protocol.md says; its decoder knows that page only."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from backend.telemetry.frames import frames
from backend.telemetry.ring import COLUMNS, EPOCH, PERIOD_S, WIDTH, Piece
from tests.backend.frame_decoder import decoded
from vssea_core.channels import CHANNELS


def piece_of(runs: list[tuple[int, float]], first: int = 0) -> Piece:
    """Runs of (samples, sample time), one epoch each, with recognisable values."""
    parts = []
    for epoch, (count, period) in enumerate(runs, start=1):
        part = np.random.default_rng(epoch).standard_normal((count, COLUMNS))
        part[:, 0] = np.arange(count) * period
        part[:, EPOCH], part[:, PERIOD_S] = epoch, period
        parts.append(part)
    return Piece(first, np.concatenate(parts) if parts else np.empty((0, COLUMNS)))


def test_every_field_of_the_header_reads_back() -> None:
    piece = piece_of([(7, 0.001)], first=2**40)
    (frame,) = (decoded(frame) for frame in frames(piece))
    assert frame[:-1] == (b"VSSE", 1, 0, len(CHANNELS), 7, 1, 0, 2**40, 0.0, 0.001)
    assert np.array_equal(frame.values, piece.samples[:, :WIDTH].T.astype(np.float32))


def test_history_is_marked() -> None:
    assert [decoded(frame).flags for frame in frames(piece_of([(2, 0.001)]), history=True)] == [1]


def test_the_time_of_the_first_sample_keeps_its_milliseconds_after_a_day() -> None:
    piece = piece_of([(3, 0.001)])
    piece.samples[:, 0] += 86_400.001
    (frame,) = frames(piece)
    assert decoded(frame).t0 == 86_400.001


def test_no_samples_make_no_frame() -> None:
    assert list(frames(piece_of([]))) == []


@given(st.lists(st.tuples(st.integers(1, 2500), st.sampled_from([1e-4, 1e-3, 2e-3])), min_size=1, max_size=4))
def test_frames_carry_every_sample_once_in_order_and_none_spans_two_epochs(runs: list[tuple[int, float]]) -> None:
    piece = piece_of(runs, first=100)
    found = [decoded(frame) for frame in frames(piece)]
    due = 100
    for frame in found:
        assert frame.sequence == due
        due += frame.samples
        assert 1 <= frame.samples <= 1000
        epochs = piece.samples[frame.sequence - 100 : due - 100, EPOCH]
        assert (epochs == frame.epoch).all()
        assert frame.dt == runs[frame.epoch - 1][1]
        assert frame.t0 == piece.samples[frame.sequence - 100, 0]
    assert due == 100 + len(piece.samples)
    assert np.array_equal(np.concatenate([f.values for f in found], axis=1), piece.samples[:, :WIDTH].T.astype("f4"))
