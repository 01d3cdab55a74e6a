"""Multi-sine, filtered step, chirp, jog and recorded references against their formulas, scipy and their own promises."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError
from scipy import integrate, signal
from scipy.interpolate import BSpline

from vssea_core.signals.documents import (
    ChirpReference,
    FilteredStepReference,
    JogReference,
    MultisineReference,
    PositionComponent,
    RecordedReference,
    Reference,
    SineReference,
    StepReference,
)
from vssea_core.signals.recorded import spline_pieces
from vssea_core.signals.references import (
    TRANSITION_SIZE,
    change_reference,
    decay_transition,
    reference_at,
    reference_row,
    with_transition,
)


def course(reference: Reference, times: np.ndarray) -> np.ndarray:
    """The reference and four derivatives at `times` (n,); shape (n, 5)."""
    row = reference_row(reference)
    return np.array([reference_at(row, t) for t in times])


Formula = Callable[[np.ndarray], np.ndarray]


def exact(formula: Formula, times: np.ndarray) -> np.ndarray:
    """Value and four derivatives of an analytic formula, by Cauchy's integral on a circle about each time; (n, 5)."""
    turns = np.exp(2j * math.pi * np.arange(64) / 64)
    radius = 0.05
    values = formula(times[:, None] + radius * turns)
    return np.array([np.mean(values * turns**-i, axis=1).real * math.factorial(i) / radius**i for i in range(5)]).T


def smooth(x: np.ndarray) -> np.ndarray:
    return 126 * x**5 - 420 * x**6 + 540 * x**7 - 315 * x**8 + 70 * x**9


def test_a_multisine_is_its_formula_with_every_derivative() -> None:
    parts = (PositionComponent(amplitude=0.3, frequency_hz=0.3, phase=1.0), PositionComponent(frequency_hz=2.5))
    reference = MultisineReference(components=parts, offset=0.2, fade_in_s=2.0)

    def sines(t: np.ndarray) -> np.ndarray:
        return 0.2 + sum(p.amplitude * np.sin(2 * math.pi * p.frequency_hz * t + p.phase) for p in parts)

    times, late = np.array([0.3, 1.1, 1.9]), np.array([2.3, 7.7])
    scale = (2.0 * math.pi * 2.5) ** np.arange(5.0)
    faded = exact(lambda t: smooth(t / 2.0) * sines(t), times)
    assert np.allclose(course(reference, times) / scale, faded / scale, atol=1e-11)
    assert np.allclose(course(reference, late) / scale, exact(sines, late) / scale, atol=1e-11)


def test_no_components_are_the_offset() -> None:
    rest = course(MultisineReference(components=(), offset=0.3, fade_in_s=0.0), np.array([0.0, 5.0]))
    assert rest.tolist() == [[0.3, 0, 0, 0, 0]] * 2


def test_a_filtered_step_is_the_answer_of_five_real_poles() -> None:
    w, times = 12.0, np.linspace(0.0, 2.0, 401)
    reference = FilteredStepReference(origin=0.1, target=0.6, bandwidth=w, repeat=False, start_s=0.0)
    denominator = np.poly([-w] * 5)
    for order in range(5):
        _, answer = signal.step(([w**5] + [0.0] * order, denominator), T=times)
        expected = 0.5 * answer + (0.1 if order == 0 else 0.0)
        assert np.allclose(course(reference, times)[:, order], expected, atol=1e-6 * w**order), order


@given(bandwidth=st.floats(3.0, 40.0), dwell=st.floats(0.35, 1.0), time=st.floats(0.0, 5.0))
@settings(deadline=None, max_examples=40)
def test_a_filtered_square_is_the_sum_of_its_edges(bandwidth: float, dwell: float, time: float) -> None:
    square = FilteredStepReference(origin=-0.2, target=0.3, bandwidth=bandwidth, dwell_s=dwell, start_s=0.4)
    single = reference_row(
        FilteredStepReference(origin=0.0, target=0.5, bandwidth=bandwidth, repeat=False, start_s=0.4)
    )
    edges = [(-1) ** n * np.array(reference_at(single, time - n * dwell)) for n in range(20) if time > n * dwell]
    expected = np.sum([np.zeros(5), *edges], axis=0) + np.array([-0.2, 0, 0, 0, 0])
    scale = bandwidth ** np.arange(5.0)
    assert np.allclose(course(square, np.array([time]))[0] / scale, expected / scale, atol=1e-9)


@pytest.mark.parametrize("sweep", ["linear", "logarithmic"])
def test_a_chirp_is_its_formula_with_every_derivative(sweep: str) -> None:
    reference = ChirpReference(
        amplitude=0.1, start_frequency_hz=0.2, end_frequency_hz=3.0, duration_s=10.0, sweep=sweep, fade_in_s=2.0
    )

    def sine(t: np.ndarray) -> np.ndarray:
        growth = math.log(15.0) / 10.0
        cycles = 0.2 * t + 0.14 * t**2 if sweep == "linear" else 0.2 * (np.exp(growth * t) - 1.0) / growth
        return 0.1 * np.sin(2.0 * math.pi * cycles)

    scale = (2.0 * math.pi * 3.0) ** np.arange(5.0)
    early, late = np.array([0.4, 1.7]), np.array([2.5, 6.1, 8.9])
    faded = exact(lambda t: smooth(t / 2.0) * sine(t), early)
    assert np.allclose(course(reference, early) / scale, faded / scale, atol=1e-11)
    assert np.allclose(course(reference, late) / scale, exact(sine, late) / scale, atol=1e-11)


@pytest.mark.parametrize("sweep", ["linear", "logarithmic"])
def test_a_chirp_ends_at_its_frequency_and_holds_it(sweep: str) -> None:
    reference = ChirpReference(
        amplitude=0.1, start_frequency_hz=0.2, end_frequency_hz=2.0, duration_s=8.0, sweep=sweep, offset=0.3
    )
    held = course(reference, np.linspace(8.0, 12.0, 500))
    w = 2.0 * math.pi * 2.0
    assert np.allclose(held[:, 2], -(w**2) * (held[:, 0] - 0.3), atol=1e-10), "a sine of the end frequency"
    stopping = reference.model_copy(update={"after": "stop"})
    assert course(stopping, np.array([8.0, 20.0])).tolist() == [[0.3, 0, 0, 0, 0]] * 2


jogs = st.builds(
    JogReference,
    velocity=st.floats(-3.0, 3.0),
    acceleration=st.floats(0.5, 20.0),
    jerk=st.floats(5.0, 500.0),
    snap=st.floats(50.0, 2e4),
    origin=st.floats(-1.0, 1.0),
)


@given(jog=jogs)
@settings(deadline=None, max_examples=40)
def test_a_jog_reaches_its_velocity_within_every_limit_and_meets_one(jog: JogReference) -> None:
    ramp = reference_row(jog)[4]
    values = course(jog, np.linspace(0.0, 1.2 * ramp, 3001))
    shares = [np.abs(values[:, i]).max() / limit for i, limit in ((2, jog.acceleration), (3, jog.jerk), (4, jog.snap))]
    assert max(shares) <= 1.0 + 1e-9
    if abs(jog.velocity) > 0.01:
        assert max(shares) > 0.999
        assert values[-1, 1] == pytest.approx(jog.velocity)
    position = integrate.cumulative_simpson(values[:, 1], dx=1.2 * ramp / 3000, initial=0.0)
    assert np.allclose(values[:, 0], jog.origin + position, atol=1e-9)


@given(jog=jogs, distance=st.floats(1e-3, 10.0))
@settings(deadline=None, max_examples=60)
def test_a_jog_over_a_distance_comes_to_rest_there(jog: JogReference, distance: float) -> None:
    velocity = jog.velocity if abs(jog.velocity) > 1e-9 else 1.0
    ending = jog.model_copy(update={"distance": distance, "velocity": velocity})
    row = reference_row(ending)
    end = np.array(reference_at(row, row[5] + row[6] + 1.0))
    assert end[0] == pytest.approx(ending.origin + math.copysign(distance, ending.velocity), abs=1e-9)
    assert np.allclose(end[1:], 0.0, atol=1e-12)


def test_a_jog_slows_down_after_its_duration() -> None:
    jog = JogReference(velocity=0.5, duration_s=2.0)
    row = reference_row(jog)
    assert row[5] == 2.0
    values = course(jog, np.array([1.99, 2.0 + row[6]]))
    assert values[:, 1].tolist() == pytest.approx([0.5, 0.0], abs=1e-12)


def test_a_jog_set_live_goes_on_from_the_present_position_and_velocity() -> None:
    """Without the bump of a transition that would lead back to an origin; a second jog follows the first alike."""
    sine, left = reference_row(SineReference(amplitude=0.5, frequency_hz=0.5, fade_in_s=0.0)), np.zeros(TRANSITION_SIZE)
    first = reference_row(JogReference(velocity=0.5), set_at_s=2.1)
    change_reference(sine, first, 2.1, left)
    present = np.array(reference_at(sine, 2.1))
    assert first[1:3].tolist() == pytest.approx(present[:2].tolist())
    assert np.allclose(np.array(with_transition(reference_at(first, 2.1), left)), present, atol=1e-9)
    decay_transition(left, 0.05)
    before = np.array(with_transition(reference_at(first, 2.15), left))
    second = reference_row(JogReference(velocity=-1.0, distance=0.4), set_at_s=2.15)
    change_reference(first, second, 2.15, left)
    assert np.allclose(np.array(with_transition(reference_at(second, 2.15), left)), before, atol=1e-9)
    assert reference_at(second, 20.0).r == pytest.approx(before[0] - 0.4)


def test_a_jog_of_no_velocity_brings_a_moving_reference_to_rest() -> None:
    left = np.zeros(TRANSITION_SIZE)
    moving, still = reference_row(JogReference(velocity=1.0)), reference_row(JogReference(velocity=0.0), set_at_s=5.0)
    change_reference(moving, still, 5.0, left)
    assert np.allclose(np.array(reference_at(still, 20.0))[1:], 0.0)
    assert reference_at(still, 20.0).r > reference_at(moving, 5.0).r


courses = st.lists(st.tuples(st.floats(0.02, 0.5), st.floats(-1.0, 1.0)), min_size=2, max_size=40)


@given(samples=courses)
@settings(deadline=None, max_examples=40)
def test_a_recorded_course_goes_through_its_samples_at_rest_at_both_ends(samples: list[tuple[float, float]]) -> None:
    gaps, positions = zip(*samples, strict=True)
    times = np.cumsum(gaps)
    reference = RecordedReference(times_s=tuple(times.tolist()), positions=positions)
    values = course(reference, times)
    assert np.allclose(values[:, 0], positions, atol=1e-7)
    inside = course(reference, np.array([times[0] + 1e-9, times[-1] - 1e-9]))
    scale = np.abs(course(reference, np.linspace(times[0], times[-1], 500))).max(axis=0) + 1e-9
    assert np.all(np.abs(inside[:, 1:]) < 1e-4 * scale[1:])
    assert not course(reference, np.array([times[0] - 0.1, times[-1] + 0.1]))[:, 1:].any()


@given(samples=courses)
@settings(deadline=None, max_examples=40)
def test_a_recorded_course_is_the_spline_that_scipy_finds(samples: list[tuple[float, float]]) -> None:
    """The unique spline of degree 5 on these knots with the samples and rest to the fourth derivative at both ends."""
    gaps, positions = zip(*samples, strict=True)
    times = np.cumsum(gaps)
    starts, _ = spline_pieces(times, np.array(positions))
    knots = np.concatenate([[times[0]] * 6, starts[1:], [times[-1]] * 6])
    n = len(knots) - 6
    splines = BSpline(knots, np.eye(n), 5)
    rows = [splines(times)] + [splines.derivative(i)(times[[0, -1]]) for i in range(1, 5)]
    right = np.concatenate([positions, np.zeros(8)])
    matrix = np.vstack(rows)
    size = np.abs(matrix).max(axis=1)
    coefficients = np.linalg.solve(matrix / size[:, None], right / size)
    spline = BSpline(knots, coefficients, 5)
    reference = RecordedReference(times_s=tuple(times.tolist()), positions=positions)
    at = np.linspace(times[0], times[-1], 200)[1:-1]
    found = course(reference, at)
    for order in range(4):
        expected = spline.derivative(order)(at) if order else spline(at)
        assert np.allclose(found[:, order], expected, atol=1e-6 * (1.0 + np.abs(expected).max())), order


def test_two_thousand_samples_of_a_sine_are_followed_with_every_derivative() -> None:
    times = np.arange(2000) * 0.01
    w = 2.0 * math.pi * 0.3
    reference = RecordedReference(times_s=tuple(times.tolist()), positions=tuple((0.5 * np.sin(w * times)).tolist()))
    at = np.linspace(1.0, 19.0, 777)
    found = course(reference, at)
    for order, tolerance in enumerate((1e-10, 1e-8, 1e-6, 1e-4, 2e-2)):
        expected = 0.5 * w**order * np.sin(w * at + order * math.pi / 2.0)
        assert np.abs(found[:, order] - expected).max() < tolerance, order


@pytest.mark.parametrize(
    ("times", "positions", "sentence"),
    [
        ((0.0, 1.0), (0.0, 1.0, 2.0), "times_s has 2 values and positions 3"),
        ((0.0,), (0.0,), "at least 2 samples"),
        ((0.0, 1.0, 1.0), (0.0, 1.0, 2.0), "sort or thin them out"),
    ],
)
def test_samples_that_are_no_course_are_refused(times: tuple, positions: tuple, sentence: str) -> None:
    with pytest.raises(ValidationError, match=sentence):
        RecordedReference(times_s=times, positions=positions)


def test_references_that_make_no_sense_are_refused() -> None:
    with pytest.raises(ValidationError, match="lengthen the dwell or raise the bandwidth"):
        FilteredStepReference(bandwidth=2.0, dwell_s=0.1)
    with pytest.raises(ValidationError, match="fading in and out do not fit"):
        ChirpReference(duration_s=1.0, after="stop", fade_in_s=1.0)


def test_a_raw_step_after_a_jog_leaves_no_transition() -> None:
    left = np.ones(TRANSITION_SIZE)
    change_reference(reference_row(JogReference()), reference_row(StepReference()), 1.0, left)
    assert not left.any()
