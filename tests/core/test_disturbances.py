"""Disturbance terms: their value at the integrator's instants, their sum, and start and end on whole ticks."""

import math
from functools import partial

import numba
import numpy as np
from hypothesis import example, given, settings
from hypothesis import strategies as st

from vssea_core.signals.disturbances import INSTANTS, disturbance_rows, load_at, loads_of_step
from vssea_core.signals.documents import ConstantDisturbance, Disturbance, SineDisturbance

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


@numba.njit
def six_loads(rows, tick, time, h, whole):  # type: ignore[no-untyped-def]
    return loads_of_step(rows, tick, time, h, whole)


def value(term: Disturbance, time: float) -> float:
    """The term's formula, with t the scenario's time."""
    if isinstance(term, ConstantDisturbance):
        return term.torque
    return term.amplitude * math.sin(2.0 * math.pi * term.frequency_hz * time + term.phase)


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
