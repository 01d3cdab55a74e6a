"""Rise, settling, overshoot, steady error and recovery on responses whose figures have a closed form, and their symmetries."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

from vssea_core.control.pole_choice import pole_for_settling_time
from vssea_core.simulation.settling import recovery_time, settled_at
from vssea_core.simulation.step_response import StepMetrics, step_metrics

TIME = np.arange(0.0, 3.0, 1e-3)


def four_fold_lag(p: float, time: np.ndarray) -> np.ndarray:
    x = p * time
    return 1.0 - np.exp(-x) * (1.0 + x + x**2 / 2.0 + x**3 / 6.0)


def second_order(w: float, damping: float, time: np.ndarray) -> np.ndarray:
    wd = w * math.sqrt(1.0 - damping**2)
    return 1.0 - np.exp(-damping * w * time) * (np.cos(wd * time) + damping * w / wd * np.sin(wd * time))


@given(p=st.floats(5.0, 60.0))
def test_the_quadruple_pole_rises_in_4_94_over_p_and_settles_when_designed_to(p: float) -> None:
    found = step_metrics(TIME, four_fold_lag(p, TIME), 0.0, 1.0)
    x10, x90 = (brentq(lambda x, s=share: four_fold_lag(1.0, np.array(x)) - s, 0.1, 30.0) for share in (0.1, 0.9))
    assert found.rise_time_s == pytest.approx((x90 - x10) / p, abs=2e-5)
    assert found.settling_time_s is not None
    assert pole_for_settling_time(found.settling_time_s) == pytest.approx(p, rel=1e-3)
    assert found.overshoot_percent == pytest.approx(0.0, abs=1e-9)


@given(w=st.floats(10.0, 40.0), damping=st.floats(0.3, 0.9))
def test_a_second_order_step_overshoots_by_its_closed_form(w: float, damping: float) -> None:
    """exp(-pi zeta / sqrt(1 - zeta^2)); and it settles no later than its envelope."""
    found = step_metrics(TIME, second_order(w, damping, TIME), 0.0, 1.0)
    overshoot = 100.0 * math.exp(-math.pi * damping / math.sqrt(1.0 - damping**2))
    assert found.overshoot_percent == pytest.approx(overshoot, abs=0.02)
    assert found.settling_time_s is not None
    envelope = -math.log(0.02 * math.sqrt(1.0 - damping**2)) / (damping * w)
    assert found.settling_time_s <= envelope + 1e-4
    settled = found.settling_time_s + 1e-9 < TIME
    assert np.abs(second_order(w, damping, TIME[settled]) - 1.0).max() <= 0.02
    assert found.steady_error == pytest.approx(0.0, abs=1e-2)


@given(
    w=st.floats(5.0, 40.0),
    damping=st.floats(0.2, 0.95),
    initial=st.floats(-3.0, 3.0),
    step=st.floats(0.01, 3.0),
    sign=st.sampled_from([-1.0, 1.0]),
    later=st.floats(-5.0, 50.0),
)
def test_the_figures_do_not_depend_on_size_direction_start_or_clock(
    w: float, damping: float, initial: float, step: float, sign: float, later: float
) -> None:
    response = second_order(w, damping, TIME)
    unit = step_metrics(TIME, response, 0.0, 1.0)
    final = initial + sign * step
    found = step_metrics(TIME + later, initial + sign * step * response, initial, final)
    assert found.overshoot_percent == pytest.approx(unit.overshoot_percent, abs=1e-8)
    assert found.rise_time_s == pytest.approx(unit.rise_time_s, abs=1e-8)
    assert found.settling_time_s == pytest.approx(unit.settling_time_s, abs=1e-7)
    assert unit.steady_error is not None
    assert found.steady_error == pytest.approx(sign * step * unit.steady_error, abs=1e-9)


def test_settling_counts_from_the_stated_origin_and_rise_does_not() -> None:
    response = second_order(20.0, 0.6, TIME)
    early = step_metrics(TIME, response, 0.0, 1.0, origin_s=-0.5)
    plain = step_metrics(TIME, response, 0.0, 1.0)
    assert early.settling_time_s == pytest.approx(plain.settling_time_s + 0.5)
    assert early.rise_time_s == plain.rise_time_s


def test_the_final_value_is_the_one_stated_never_the_last_sample() -> None:
    short = 0.95 * four_fold_lag(20.0, TIME)
    found = step_metrics(TIME, short, 0.0, 1.0)
    assert found.settling_time_s is None
    assert found.undefined["settling_time_s"] == "5 % off at the end of the record, outside the band of 2 %"
    assert found.steady_error == pytest.approx(0.05)
    assert found.rise_time_s is not None


def test_a_rise_that_never_ends_is_not_defined_and_says_how_far_it_came() -> None:
    found = step_metrics(TIME, 0.5 * four_fold_lag(20.0, TIME), 0.0, 1.0)
    assert found.rise_time_s is None
    assert found.undefined["rise_time_s"] == "reached 50 % of the step, not 90 %"


def test_what_cannot_be_defined_has_a_reason_by_its_name() -> None:
    nothing = step_metrics(TIME[:0], TIME[:0], 0.0, 1.0)
    assert nothing == StepMetrics(None, None, None, None, nothing.undefined)
    assert set(nothing.undefined) == {"rise_time_s", "settling_time_s", "overshoot_percent", "steady_error"}
    no_step = step_metrics(TIME, np.ones(len(TIME)), 1.0, 1.0)
    assert no_step.steady_error == 0.0
    assert set(no_step.undefined) == {"rise_time_s", "settling_time_s", "overshoot_percent"}
    brief = step_metrics(TIME[:100], np.ones(100), 0.0, 1.0)
    assert brief.steady_error is None
    assert brief.undefined["steady_error"] == "the record is shorter than the window of 0.2 s"


def test_the_steady_error_is_the_mean_over_the_last_window() -> None:
    position = np.where(TIME < 2.8 - 1e-9, 5.0, 0.9)
    assert step_metrics(TIME, position, 0.0, 1.0).steady_error == pytest.approx(0.1)
    assert step_metrics(TIME, position, 0.0, 1.0, steady_window_s=0.4).steady_error == pytest.approx(0.1 - 4.1 / 2.0)


def test_records_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ValueError, match="3000 times for 2 positions"):
        step_metrics(TIME, TIME[:2], 0.0, 1.0)
    with pytest.raises(ValueError, match="above 0, such as"):
        step_metrics(TIME, TIME, 0.0, 1.0, band=0.0)


@given(rate=st.floats(4.0, 50.0), size=st.floats(0.01, 10.0), hit=st.floats(0.0, 1.0), band=st.floats(1e-3, 5e-3))
def test_recovery_from_a_decaying_error_takes_the_logarithm_of_its_size(
    rate: float, size: float, hit: float, band: float
) -> None:
    error = np.where(hit - 1e-12 <= TIME, size * np.exp(-rate * (TIME - hit)), 0.0)
    expected = math.log(size / band) / rate
    found = recovery_time(TIME, error, hit, band)
    if expected > TIME[-1] - hit:
        assert found is None
    else:
        assert found == pytest.approx(expected, abs=1e-3)


def test_an_error_that_never_leaves_the_band_needs_no_recovery_and_one_that_ends_outside_has_none() -> None:
    assert recovery_time(TIME, np.full(len(TIME), 1e-4), 1.0, 1e-3) == 0.0
    assert recovery_time(TIME, TIME, 1.0, 1e-3) is None
    assert recovery_time(TIME, TIME, 99.0, 1e-3) is None
    early = np.where(TIME < 0.9, 1.0, 0.0)
    assert recovery_time(TIME, early, 1.0, 1e-3) == 0.0, "what was before the disturbance does not count"


@given(values=st.lists(st.floats(-2.0, 2.0), min_size=1, max_size=40), band=st.floats(0.01, 1.0))
def test_from_the_settling_time_on_the_signal_is_within_the_band_and_just_before_it_is_not(
    values: list[float], band: float
) -> None:
    signal = np.array(values)
    time = np.arange(len(signal)) * 0.5
    found = settled_at(time, signal, band)
    if found is None:
        assert abs(signal[-1]) > band
        return
    assert np.all(np.abs(signal[time >= found + 1e-9]) <= band)
    if found > 0.0:
        assert abs(np.interp(found, time, signal)) == pytest.approx(band)
        assert np.abs(signal[time <= found]).max() > band


def test_a_signal_that_is_not_a_number_is_not_within_the_band() -> None:
    assert settled_at(TIME[:3], np.array([0.0, np.nan, 0.0]), 1.0) == pytest.approx(2e-3)
    assert settled_at(TIME[:3], np.array([0.0, 0.0, np.nan]), 1.0) is None
