"""Disturbance terms: their value at the integrator's instants, their sum, and start and end on whole ticks."""

import math
from functools import partial

import numba
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from vssea_core.signals.disturbance_rates import load_and_rates
from vssea_core.signals.disturbances import (
    INSTANTS,
    all_loads_of_step,
    disturbance_rows,
    load_at,
    loads_of_step,
    noise_stream,
)
from vssea_core.signals.documents import (
    ChirpDisturbance,
    ConstantDisturbance,
    ContactDisturbance,
    Disturbance,
    LinkDisturbance,
    MultisineDisturbance,
    NoiseDisturbance,
    PendulumDisturbance,
    PulseDisturbance,
    SineDisturbance,
    TorqueComponent,
)
from vssea_core.signals.smooth_noise import SPACING_BANDWIDTH, noise_at

T = 1e-3
terms = st.one_of(
    st.builds(ConstantDisturbance, torque=st.floats(-200.0, 200.0)),
    st.builds(
        SineDisturbance,
        amplitude=st.floats(0.0, 200.0),
        frequency_hz=st.floats(0.0, 200.0),
        phase=st.floats(-6.3, 6.3),
    ),
)
components = st.builds(TorqueComponent, frequency_hz=st.floats(0.0, 20.0), phase=st.floats(-6.3, 6.3))
frequencies = st.floats(0.01, 20.0)
rare_terms = st.one_of(
    terms,
    st.builds(MultisineDisturbance, components=st.lists(components, max_size=8).map(tuple)),
    st.builds(
        ChirpDisturbance,
        start_frequency_hz=frequencies,
        end_frequency_hz=frequencies,
        duration_s=st.floats(0.1, 30.0),
        sweep=st.sampled_from(["linear", "logarithmic"]),
        start_s=st.floats(0.0, 5.0),
    ),
    st.builds(NoiseDisturbance, rms=st.floats(0.0, 10.0), bandwidth_hz=st.floats(0.01, 100.0)),
    st.builds(
        PulseDisturbance, width_s=st.floats(0.005, 0.5), period_s=st.floats(0.6, 3.0), repeat=st.booleans(),
        start_s=st.floats(0.0, 2.0),
    ),
)  # fmt: skip
SEED = 11


@numba.njit
def six_loads(rows, tick, time, h, whole):  # type: ignore[no-untyped-def]
    return loads_of_step(rows, tick, time, h, whole)


def value(term: Disturbance, time: float, tick: float = 0.0, number: int = 0) -> float:
    """The term's formula, with t the scenario's time; `tick` is the time of the last tick."""
    if tick + 1e-9 < term.start_s:
        return 0.0
    since = time - term.start_s
    match term.kind:
        case "constant":
            return term.torque
        case "sine":
            return term.amplitude * math.sin(2.0 * math.pi * term.frequency_hz * time + term.phase)
        case "multisine":
            turn = 2.0 * math.pi * time
            return sum(p.amplitude * math.sin(turn * p.frequency_hz + p.phase) for p in term.components)
        case "chirp":
            return term.amplitude * math.sin(2.0 * math.pi * cycles(term, since))
        case "noise":
            return term.rms * noise_at(term.bandwidth_hz / SPACING_BANDWIDTH, SEED, noise_stream("link", number), time)
    phase = tick + 1e-9 - term.start_s
    return term.torque if (phase % term.period_s if term.repeat else phase) < term.width_s else 0.0


def cycles(term: ChirpDisturbance, since: float) -> float:
    """Turns of a swept sine: the integral of its frequency."""
    low, high, duration = term.start_frequency_hz, term.end_frequency_hz, term.duration_s
    swept = min(since, duration)
    if term.sweep == "linear" or high == low:
        turned = low * swept + (high - low) * swept**2 / (2.0 * duration)
    else:
        ratio = math.log(high / low)
        turned = low * duration / ratio * (math.exp(ratio * swept / duration) - 1.0)
    return turned + high * (since - swept)


@given(chosen=st.lists(terms, max_size=5), tick=st.integers(0, 100_000))
@settings(deadline=None, max_examples=60)
def test_the_loads_of_a_period_are_those_of_the_formula_at_the_six_instants(
    chosen: list[Disturbance], tick: int
) -> None:
    rows, time = disturbance_rows(chosen, T), tick * T
    expected = [sum(value(term, time + share * T) for term in chosen) for share in INSTANTS]
    assert np.allclose(six_loads(rows, time, time, T, True), expected, rtol=1e-10, atol=1e-8)


@given(chosen=st.lists(terms, max_size=5), tick=st.integers(0, 100_000), substep=st.integers(0, 2))
@settings(deadline=None, max_examples=40)
def test_the_loads_of_a_substep_are_those_of_the_formula(chosen: list[Disturbance], tick: int, substep: int) -> None:
    rows, h = disturbance_rows(chosen, T), T / 3.0
    start = tick * T + substep * h
    expected = [sum(value(term, start + share * h) for term in chosen) for share in INSTANTS]
    assert np.allclose(six_loads(rows, tick * T, start, h, False), expected, rtol=1e-10, atol=1e-8)


@given(
    start=st.integers(0, 5000),
    length=st.integers(1, 300),
    early=st.sampled_from([0.0, 0.0, 0.001, 0.5, 0.9]),
    period=st.sampled_from([1e-3, 7e-4, 2e-3]),
)
@example(start=17, length=8, early=0.0, period=7e-4)  # 17 T and 25 T fall a hair short of 0.0119 and 0.0175
@settings(deadline=None, max_examples=60)
def test_a_term_acts_from_the_first_tick_at_or_after_its_start_to_the_first_at_or_after_its_end(
    start: int, length: int, early: float, period: float
) -> None:
    """Times between two ticks snap to the later one, so a whole period is either loaded or not."""
    decimal = partial(round, ndigits=9)  # as a person writes it, which is not k T in floating point
    times = {
        "start_s": decimal(max(0.0, (start - early) * period)),
        "end_s": decimal((start + length - early) * period),
    }
    rows = disturbance_rows([ConstantDisturbance(torque=2.0, **times)], period)
    loaded = [load_at(rows, k * period) for k in range(start + length + 3)]
    assert np.flatnonzero(loaded).tolist() == list(range(start, start + length))


def test_a_term_that_ends_within_a_period_loads_all_of_it() -> None:
    rows = disturbance_rows([ConstantDisturbance(torque=2.0, start_s=0.0, end_s=0.0105)], T)
    assert set(six_loads(rows, 0.010, 0.010, T, True)) == {2.0}
    assert set(six_loads(rows, 0.011, 0.011, T, True)) == {0.0}


def test_no_terms_are_no_load() -> None:
    assert load_at(disturbance_rows([], T), 1.0) == 0.0


@numba.njit
def any_six_loads(rows, tick, time, h, whole):  # type: ignore[no-untyped-def]
    return all_loads_of_step(rows, tick, time, h, whole)


@given(chosen=st.lists(rare_terms, max_size=5), tick=st.integers(0, 20_000), parts=st.sampled_from([1, 3]))
@settings(deadline=None, max_examples=100)
def test_the_loads_of_every_kind_are_those_of_their_formulas(chosen: list[Disturbance], tick: int, parts: int) -> None:
    rows, time, h = disturbance_rows(chosen, T, SEED), tick * T, T / parts
    start = time + (parts - 1) * h
    expected = [
        sum(value(term, start + share * h, time, number) for number, term in enumerate(chosen)) for share in INSTANTS
    ]
    assert np.allclose(any_six_loads(rows, time, start, h, parts == 1), expected, rtol=1e-9, atol=1e-7)
    at_tick = sum(value(term, time, time, number) for number, term in enumerate(chosen))
    assert load_at(rows, time) == pytest.approx(at_tick, rel=1e-9, abs=1e-7)


def test_every_noise_is_its_own_whatever_its_inertia_place_and_seed() -> None:
    noise = NoiseDisturbance(bandwidth_hz=20.0)
    kinds = {("link", 0, 1), ("link", 1, 1), ("motor", 0, 1), ("stiffness_motor", 0, 1), ("link", 0, 2)}
    courses = []
    for on, place, seed in kinds:
        rows = disturbance_rows([noise] * (place + 1), T, seed, on)[place:]
        courses.append([load_at(rows, k * 0.05) for k in range(4000)])
    correlation = np.corrcoef(np.array(courses)) - np.eye(len(kinds))
    assert np.abs(correlation).max() < 0.08
    assert np.allclose(np.std(courses, axis=1), 1.0, rtol=0.06)


def test_pulses_begin_and_end_on_whole_ticks_and_repeat() -> None:
    rows = disturbance_rows([PulseDisturbance(torque=2.0, width_s=0.01, period_s=0.05, start_s=0.1)], T)
    on = np.flatnonzero([load_at(rows, k * T) for k in range(300)])
    assert on.tolist() == [start + k for start in (100, 150, 200, 250) for k in range(10)]


smooth_terms: dict[str, LinkDisturbance] = {
    "constant": ConstantDisturbance(torque=2.0),
    "sine": SineDisturbance(phase=0.3),
    "multisine": MultisineDisturbance(components=(TorqueComponent(), TorqueComponent(frequency_hz=2.3, phase=1.0))),
    "linear chirp": ChirpDisturbance(start_frequency_hz=3.0, end_frequency_hz=0.5, duration_s=1.5, sweep="linear"),
    "logarithmic chirp": ChirpDisturbance(start_frequency_hz=0.5, end_frequency_hz=3.0, duration_s=1.5),
    "noise": NoiseDisturbance(bandwidth_hz=2.0),
    "pulse": PulseDisturbance(width_s=0.2, start_s=0.1),
}


@pytest.mark.parametrize("term", smooth_terms.values(), ids=smooth_terms)
def test_the_true_rates_are_those_of_the_load_the_plant_feels(term: LinkDisturbance) -> None:
    rows, times = disturbance_rows([term], T, SEED), np.arange(3000) * T
    felt = np.array([load_at(rows, t) for t in times])
    load, rate, acceleration = load_and_rates([term], times, seed=SEED)
    assert np.allclose(load, felt, atol=1e-9)
    calm = np.abs(np.diff(felt, prepend=felt[0])) < 1.0  # leaves out the edges of a pulse
    for found, below in ((rate, load), (acceleration, rate)):
        slope = np.gradient(below, times)
        size = np.abs(found).max() + 1e-9
        close = np.abs(slope - found) < 2e-2 * size
        assert np.mean((close | ~calm)[2:-2]) > 0.995


def test_the_true_rates_of_weight_and_wall_follow_the_recorded_motion() -> None:
    times = np.arange(4000) * T
    position, velocity = 0.5 * np.sin(2.0 * times), np.cos(2.0 * times)
    weight = PendulumDisturbance(mass=1.0, length=0.5)
    load, rate, acceleration = load_and_rates([weight], times, position=position, velocity=velocity)
    assert np.allclose(load, 9.80665 * 0.5 * np.sin(position))
    assert np.allclose(np.gradient(load, times)[1:-1], rate[1:-1], atol=1e-4)
    assert np.allclose(np.gradient(rate, times)[2:-2], acceleration[2:-2], atol=1e-3)
    wall = ContactDisturbance(position=-0.3, side="below", stiffness=100.0, damping=1.0)
    push = load_and_rates([wall], times, position=position, velocity=velocity)[0]
    assert push.max() == 0.0
    assert np.flatnonzero(push).size == np.flatnonzero((position < -0.3) & (100.0 * (-0.3 - position) > velocity)).size
    with pytest.raises(ValueError, match="expected its recorded position and velocity"):
        load_and_rates([wall], times)


def test_a_pulse_that_never_ends_before_the_next_is_refused() -> None:
    with pytest.raises(ValueError, match="shorten the pulse, lengthen the period"):
        PulseDisturbance(width_s=1.0, period_s=0.5)
