"""Gains from poles: one polynomial, whether on the chain, on Eq. (5) or sampled."""

import math

import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from vssea_core.control.design import (
    baseline_poles_gains,
    chain_gains,
    chain_gains_of_poles,
    exact_sampled_gains,
    plant_gains,
    polynomial_of,
    prefilter,
    state_feedback_gains,
)
from vssea_core.control.linear_model import LinearModel, sampled, state_space
from vssea_core.control.lqr import lqr_plant_gains
from vssea_core.control.pole_choice import butterworth_poles, pole_for_bandwidth, pole_for_settling_time

PAPER = LinearModel(0.12, 0.25, 3.3, 6.0, 200.0)
models = st.builds(
    LinearModel,
    st.floats(0.03, 0.45),
    st.floats(0.0, 1.0),
    st.floats(3.1, 3.6),
    st.floats(0.0, 18.0),
    st.floats(20, 1000),
)
real_poles = st.floats(-100.0, -0.5)
pole_sets = st.one_of(
    st.lists(real_poles, min_size=4, max_size=4),
    st.builds(
        lambda p, q: [*p, *q], *[st.builds(lambda a, b: [complex(a, b), complex(a, -b)], real_poles, real_poles)] * 2
    ),
    st.builds(lambda p: [p] * 4, real_poles),
)


def scaled_polynomial(matrix: np.ndarray, radius: float) -> np.ndarray:
    """Characteristic polynomial of matrix / radius, highest power first, from traces (Newton): no eigenvalues."""
    scaled, n = matrix / radius, len(matrix)
    coefficients, power = [1.0], np.eye(n)
    for k in range(1, n + 1):
        power = scaled @ (power if k == 1 else power + coefficients[-1] * np.eye(n))
        coefficients.append(-np.trace(power) / k)
    return np.array(coefficients)


@given(poles=pole_sets)
def test_the_chains_gains_are_the_coefficients_of_its_polynomial(poles: list[complex]) -> None:
    assert np.allclose(chain_gains_of_poles(poles), np.poly(poles)[:0:-1].real, rtol=1e-12)
    assert chain_gains_of_poles([-7.0] * 4) == pytest.approx(state_feedback_gains(7.0, 1.0), rel=1e-14)


@given(model=models, poles=pole_sets)
def test_on_the_plant_the_same_poles_result_and_the_gains_lead_back(model: LinearModel, poles: list[complex]) -> None:
    gains = chain_gains_of_poles(poles)
    on_plant = plant_gains(model, gains)
    a, b, _ = state_space(model)
    closed = a - np.outer(b, on_plant)
    radius = max(float(np.abs(closed).max()) ** 0.5, float(np.abs(poles).max()))
    balance = np.array([1.0, radius, 1.0, radius])
    found = scaled_polynomial(closed * balance / balance[:, None], radius)
    assert np.allclose(found, np.poly(np.array(poles) / radius).real, atol=1e-11)
    size = chain_gains_of_poles([-radius] * 4)
    assert np.allclose(chain_gains(model, on_plant) / size, gains / size, atol=1e-12)


def test_the_baseline_is_ackermanns_and_settles_at_the_reference() -> None:
    gains, gain = baseline_poles_gains(PAPER, 8.0)
    a, b, c = state_space(PAPER)
    assert gains == pytest.approx(np.ravel(control.acker(a, b[:, None], [-8.0] * 4)), rel=1e-6)
    assert gain == pytest.approx(prefilter(a, b, c, gains), rel=1e-9)
    closed = control.ss(a - np.outer(b, gains), b[:, None] * gain, c[None], 0.0)
    assert control.dcgain(closed) == pytest.approx(1.0, rel=1e-9)


def rise_time(model: LinearModel, gains: np.ndarray) -> float:
    """10 to 90 % of the linear step response of u = -K x + N_r r [s], from a sampled exponential."""
    a, b, c = state_space(model)
    closed, t = a - np.outer(b, gains), np.arange(0.0, 3.0, 1e-4)
    system = control.ss(closed, b[:, None] * prefilter(a, b, c, gains), c[None], 0.0)
    y = control.step_response(system, T=t).outputs
    return float(t[np.argmax(y >= 0.9)] - t[np.argmax(y >= 0.1)])


def test_the_baselines_of_figure_2_rise_as_fast_as_expected() -> None:
    """Poles -8: (x90 - x10) / 8 of the four-fold lag, 0.617 s; LQR: 0.81 s."""
    x10, x90 = (
        brentq(lambda x, s=share: 1 - math.exp(-x) * (1 + x + x**2 / 2 + x**3 / 6) - s, 0.1, 30) for share in (0.1, 0.9)
    )
    assert rise_time(PAPER, baseline_poles_gains(PAPER, 8.0)[0]) == pytest.approx((x90 - x10) / 8.0, abs=2e-4)
    assert (x90 - x10) / 8.0 == pytest.approx(0.617, abs=5e-4)
    assert rise_time(PAPER, lqr_plant_gains(PAPER, (101.0, 1.0, 1.0, 1.0), 0.1)) == pytest.approx(0.81, abs=5e-3)


@given(model=models, poles=pole_sets, t=st.floats(1e-4, 5e-3))
@settings(deadline=None)
def test_the_exact_sampled_design_puts_the_sampled_poles_where_they_belong(
    model: LinearModel, poles: list[complex], t: float
) -> None:
    """u = kappa (nu - alpha x) with nu = -K T x, held over T: prod(z - exp(s_i T)), compared in z - 1 over |s T|."""
    gains = plant_gains(model, exact_sampled_gains(model, poles, t))
    phi, gam = sampled(model, t)
    a, _, _ = state_space(model)
    rate = max(float(np.abs(poles).max()), float(np.abs(a).max()) ** 0.5)
    balance = np.array([1.0, rate, 1.0, rate])
    closed = (phi - np.outer(gam, gains)) * balance / balance[:, None]
    found = scaled_polynomial(closed - np.eye(4), min(1.0, rate * t))
    expected = np.poly(np.expm1(np.array(poles) * t) / min(1.0, rate * t)).real
    assert np.allclose(found, expected, atol=1e-8)


def test_the_exact_sampled_design_tends_to_the_continuous_one_as_the_sample_time_shrinks() -> None:
    poles = butterworth_poles(4, 20.0)
    ideal = chain_gains_of_poles(poles)
    gaps = [np.abs(exact_sampled_gains(PAPER, poles, t) / ideal - 1.0).max() for t in (1e-3, 5e-4, 2.5e-4, 1e-6)]
    assert gaps[0] / gaps[1] == pytest.approx(2.0, rel=0.05)
    assert gaps[1] / gaps[2] == pytest.approx(2.0, rel=0.05)
    assert gaps[3] < 1e-3 * gaps[0] * 1.5


def test_at_the_documented_point_the_plain_law_splits_its_poles_and_the_exact_one_does_not() -> None:
    """p 8, k 1000, 1 ms: -4.1, -4.4 +- 4.7j, -24.6."""
    model, t = LinearModel(0.1, 0.1, 3.17, 4.0, 1000.0), 1e-3
    phi, gam = sampled(model, t)

    def continuous_poles(gains: np.ndarray) -> np.ndarray:
        return np.sort_complex(np.log(np.linalg.eigvals(phi - np.outer(gam, plant_gains(model, gains)))) / t)

    split = continuous_poles(state_feedback_gains(8.0, 1.0))
    assert np.allclose(split, [-24.6, -4.4 - 4.7j, -4.4 + 4.7j, -4.1], atol=0.06)
    assert np.abs(continuous_poles(exact_sampled_gains(model, [-8.0] * 4, t)) + 8.0).max() < 0.05


@pytest.mark.parametrize(
    ("poles", "sentence"),
    [
        ([-8.0] * 3, "3 poles were given.*give four"),
        ([-8.0, -8.0, -8.0, 1.0], "not in the left half-plane"),
        ([-8.0, -8.0, -8.0, complex(-3, 2)], "without its conjugate"),
    ],
)
def test_poles_that_cannot_be_are_refused_with_a_sentence(poles: list[complex], sentence: str) -> None:
    for design in (chain_gains_of_poles, lambda p: exact_sampled_gains(PAPER, p, 1e-3)):
        with pytest.raises(ValueError, match=sentence):
            design(poles)


def test_a_resonance_beyond_nyquist_is_refused_with_the_sample_time_that_would_do() -> None:
    stiff = LinearModel(0.005, 0.1, 3.17, 4.0, 1e5)
    with pytest.raises(ValueError, match=r"Nyquist frequency.*below 0.000702 s"):
        exact_sampled_gains(stiff, [-8.0] * 4, 1e-3)


@given(order=st.integers(1, 8), radius=st.floats(0.1, 1e3))
def test_butterworth_poles_make_a_maximally_flat_filter(order: int, radius: float) -> None:
    """|G(jw)|^2 = 1 / (1 + (w/radius)^2n)."""
    polynomial = np.append(polynomial_of(butterworth_poles(order, radius)), 1.0)
    w = radius * np.array([0.1, 0.7, 1.0, 2.0])
    gain = polynomial[0] / np.abs(np.polyval(polynomial[::-1], 1j * w))
    assert gain**2 == pytest.approx(1.0 / (1.0 + (w / radius) ** (2 * order)), rel=1e-9)


@given(seconds=st.floats(0.01, 100.0), band=st.floats(1e-6, 0.5))
def test_the_quadruple_pole_settles_in_the_time_asked_for(seconds: float, band: float) -> None:
    p = pole_for_settling_time(seconds, band)
    system = control.ss(
        np.diag([-p] * 4) + p * np.diag(np.ones(3), 1), [[0.0], [0.0], [0.0], [p]], [[1.0, 0, 0, 0]], 0.0
    )
    y = control.step_response(system, T=np.linspace(0.0, seconds, 101)).outputs
    assert 1.0 - y[-1] == pytest.approx(band, rel=1e-6, abs=1e-12)
    assert pole_for_settling_time(2.0 * seconds, band) == pytest.approx(p / 2.0)


@given(bandwidth=st.floats(0.1, 1e3))
def test_the_quadruple_pole_is_3_db_down_at_the_bandwidth_asked_for(bandwidth: float) -> None:
    p = pole_for_bandwidth(bandwidth)
    assert abs(1.0 / (1.0 + 1j * bandwidth / p) ** 4) == pytest.approx(math.sqrt(0.5), rel=1e-12)


@pytest.mark.parametrize(
    ("choose", "sentence"),
    [
        (lambda: pole_for_settling_time(0.0), "expected more than 0 s"),
        (lambda: pole_for_settling_time(1.0, 1.0), "between 0 and 1"),
        (lambda: pole_for_bandwidth(-1.0), "more than 0 rad/s"),
    ],
)
def test_wishes_that_cannot_be_met_are_refused(choose: object, sentence: str) -> None:
    assert callable(choose)
    with pytest.raises(ValueError, match=sentence):
        choose()
