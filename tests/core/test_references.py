"""References: their derivatives are those of their position, four of them continuous, also through a live change."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from vssea_core.signals.documents import (
    ChirpReference,
    FilteredStepReference,
    JogReference,
    MoveReference,
    MultisineReference,
    PositionComponent,
    RecordedReference,
    Reference,
    SineReference,
    StepReference,
)
from vssea_core.signals.recorded import spline_pieces
from vssea_core.signals.references import (
    REFERENCE_SIZE,
    TRANSITION_RATE,
    TRANSITION_SIZE,
    change_reference,
    decay_transition,
    reference_at,
    reference_row,
    with_transition,
)

SMOOTH: dict[str, Reference] = {
    "sine": SineReference(amplitude=0.5, frequency_hz=0.7, offset=0.2, fade_in_s=0.9),
    "sine without fade-in": SineReference(amplitude=0.5, frequency_hz=0.7, fade_in_s=0.0),
    "single move": MoveReference(origin=-0.3, target=0.6, duration_s=0.8, repeat=False, start_s=0.2),
    "to and fro": MoveReference(origin=0.1, target=0.5, duration_s=0.6, dwell_s=0.3, start_s=0.1),
    "multisine": MultisineReference(
        components=(
            PositionComponent(amplitude=0.3, frequency_hz=0.3, phase=1.0),
            PositionComponent(amplitude=0.1, frequency_hz=1.1),
        ),
        offset=0.1,
        fade_in_s=0.9,
    ),
    "filtered step": FilteredStepReference(origin=-0.1, target=0.3, bandwidth=12.0, repeat=False, start_s=0.2),
    "filtered square": FilteredStepReference(target=0.4, bandwidth=8.0, dwell_s=0.35, start_s=0.1),
    "linear chirp": ChirpReference(
        amplitude=0.2, start_frequency_hz=0.2, end_frequency_hz=1.5, duration_s=2.5, sweep="linear", offset=0.1
    ),
    "logarithmic chirp": ChirpReference(amplitude=0.2, start_frequency_hz=0.3, end_frequency_hz=1.2, duration_s=2.0),
    "falling chirp that stops": ChirpReference(
        amplitude=0.2, start_frequency_hz=1.5, end_frequency_hz=0.2, duration_s=2.0, after="stop", fade_in_s=0.8
    ),
    "jog": JogReference(velocity=-0.4, acceleration=2.0, jerk=30.0, snap=500.0, origin=0.2),
    "jog that stops": JogReference(velocity=0.5, acceleration=2.0, jerk=30.0, snap=500.0, distance=0.6),
    "recorded": RecordedReference(
        times_s=(0.2, 0.6, 1.1, 1.3, 1.8, 2.2, 2.5), positions=(0.1, 0.15, 0.3, 0.35, 0.3, 0.1, 0.1)
    ),
}
smooth = pytest.mark.parametrize("reference", SMOOTH.values(), ids=SMOOTH)
SCALE = np.array([1.0, 5.0, 50.0, 500.0, 5000.0])  # of the derivatives of these references


def at(row: np.ndarray, time: float) -> np.ndarray:
    return np.array(reference_at(row, time))


def slopes(values: Callable[[float], np.ndarray], time: float, h: float = 1e-3) -> np.ndarray:
    """Derivative of `values` (5,) at `time`, with an error of the order h^4."""
    a, b, c, d = (values(time + i * h) for i in (-2, -1, 1, 2))
    return (a - 8.0 * b + 8.0 * c - d) / (12.0 * h)


def joins(reference: Reference) -> np.ndarray:
    """Times at which the fifth derivative jumps, so that differences across them are coarse."""
    match reference.kind:
        case "sine" | "multisine":
            return np.array([0.0, reference.fade_in_s])
        case "chirp":
            ends = np.array([0.9 * reference.duration_s, reference.duration_s])
            return np.concatenate([[0.0, reference.fade_in_s], ends, [reference.duration_s - reference.fade_in_s]])
        case "move":
            starts = reference.start_s + np.arange(8.0) * (reference.duration_s + reference.dwell_s)
            return np.concatenate([starts, starts + reference.duration_s])
        case "jog":
            row = reference_row(reference)
            return np.array([0.0, row[4], row[5], row[5] + row[6]])
        case "recorded":
            return spline_pieces(np.array(reference.times_s), np.array(reference.positions))[0]
    return reference.start_s + np.arange(20.0) * reference.dwell_s


@smooth
@given(time=st.floats(0.01, 4.0))
@settings(deadline=None, max_examples=40)
def test_every_derivative_is_that_of_the_one_below(reference: Reference, time: float) -> None:
    assume(np.abs(joins(reference) - time).min() > 3e-3)
    row = reference_row(reference)
    found = slopes(lambda t: at(row, t), time)[:4]
    assert np.all(np.abs(found - at(row, time)[1:]) < 2e-4 * SCALE[1:])


@pytest.mark.parametrize("name", [name for name in SMOOTH if name != "sine without fade-in"])
def test_four_derivatives_are_continuous_everywhere(name: str) -> None:
    reference = SMOOTH[name]
    row, step = reference_row(reference), 1e-4
    values = np.array([at(row, k * step) for k in range(-100, 30_000)])
    assert np.abs(np.diff(values, axis=0) / SCALE).max() < 0.05
    assert np.abs(at(row, 0.0)[1:]).max() == 0.0, "from rest"


def test_a_move_goes_from_origin_to_target_and_back() -> None:
    row = reference_row(SMOOTH["to and fro"])
    there, back = [at(row, 0.1 + 0.6 + cycle * 0.9)[0] for cycle in (0, 1)]
    assert (at(row, 0.0)[0], there, back) == pytest.approx((0.1, 0.5, 0.1))
    assert at(reference_row(SMOOTH["single move"]), 50.0).tolist() == pytest.approx([0.6, 0, 0, 0, 0])


def test_a_step_jumps_at_its_tick_and_has_no_derivatives() -> None:
    row = reference_row(StepReference(origin=0.1, target=0.4, start_s=0.5, dwell_s=0.25), set_at_s=2.0)
    values = np.array([at(row, k * 1e-3) for k in range(4000)])
    assert np.flatnonzero(np.diff(values[:, 0])).tolist() == list(range(2499, 3999, 250))
    assert set(values[:, 0].tolist()) == {0.1, 0.4}
    assert not values[:, 1:].any()


def test_times_of_a_reference_count_from_when_it_is_set() -> None:
    for reference in SMOOTH.values():
        now, later = reference_row(reference), reference_row(reference, set_at_s=7.0)
        assert len(now) == len(later) >= REFERENCE_SIZE
        assert np.allclose(at(now, 1.3), at(later, 8.3), rtol=1e-9, atol=1e-9)


transitions = st.tuples(
    st.sampled_from(list(SMOOTH.values())), st.sampled_from(list(SMOOTH.values())), st.floats(0.0, 5.0)
)


@given(changes=st.lists(transitions, min_size=1, max_size=3))
@settings(deadline=None, max_examples=40)
def test_a_live_change_is_continuous_through_four_derivatives(
    changes: list[tuple[Reference, Reference, float]],
) -> None:
    """Also when a change follows another before the first has been worked off."""
    left = np.zeros(TRANSITION_SIZE)
    for old, new, now in changes:
        was, becomes = reference_row(old), reference_row(new, set_at_s=now)
        before = np.array(with_transition(reference_at(was, now), left))
        change_reference(was, becomes, now, left)
        after = np.array(with_transition(reference_at(becomes, now), left))
        assert np.allclose(after, before, rtol=1e-9, atol=1e-9 * SCALE.max())
        decay_transition(left, 0.05)


@given(y=st.lists(st.floats(-1.0, 1.0), min_size=5, max_size=5), time=st.floats(0.02, 1.0))
@settings(deadline=None, max_examples=40)
def test_the_transition_has_true_derivatives_and_dies_out(y: list[float], time: float) -> None:
    start = np.array(y) * TRANSITION_RATE ** np.arange(5)
    still = reference_at(reference_row(StepReference(origin=0.0, target=0.0)), 0.0)

    def left(t: float) -> np.ndarray:
        moved = start.copy()
        decay_transition(moved, t)
        return np.array(with_transition(still, moved))

    scale = TRANSITION_RATE ** np.arange(1.0, 5.0)
    assert np.all(np.abs(slopes(left, time)[:4] - left(time)[1:]) < 1e-5 * scale)
    assert np.abs(left(3.0)).max() < 1e-6
    halves = start.copy()
    for _ in range(2):
        decay_transition(halves, time / 2.0)
    whole = start.copy()
    decay_transition(whole, time)
    assert np.allclose(halves, whole, rtol=1e-12, atol=1e-12)


def test_a_change_to_a_raw_step_drops_what_was_left() -> None:
    left = np.ones(TRANSITION_SIZE)
    change_reference(reference_row(SMOOTH["sine"]), reference_row(StepReference()), 1.0, left)
    assert not left.any()
