"""The disturbance observers: poles, exact steady errors for polynomial disturbances, the transfer functions of Section 3."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vssea_core.control.observer_design import position_form, velocity_exact, velocity_first_order_hold

Polynomial = np.polynomial.Polynomial
Form = Callable[[float, float], tuple[np.ndarray, ...]]
VELOCITY_FORMS = {"exact": velocity_exact, "first-order hold": velocity_first_order_hold}
bandwidths = st.floats(1.0, 2000.0)
sample_times = st.floats(1e-4, 5e-3)
velocity_forms = pytest.mark.parametrize("form", VELOCITY_FORMS.values(), ids=VELOCITY_FORMS)


def velocity_errors(form: Form, g: float, t: float, d: Polynomial, samples: int, f: float = 0.7) -> np.ndarray:
    """True minus estimated d, d', d'' after `samples` of the exact motion v' = f - d, from an estimate of zero."""
    a, h, b0, b1 = form(g, t)
    lost, estimate, v = d.integ(), np.zeros(3), 0.0
    for k in range(1, samples + 1):
        v_next = f * k * t - lost(k * t)
        estimate = a @ estimate + h * (v_next - v) + b0 * f + b1 * f
        v = v_next
    return np.array([d(samples * t), d.deriv(1)(samples * t), d.deriv(2)(samples * t)]) - estimate


def position_errors(g: float, t: float, d: Polynomial, samples: int, phi: float = 0.7) -> np.ndarray:
    """The same for the position form, on the exact motion theta'' = phi - d without damping."""
    a, b0, b1, m = position_form(g, 0.0, t)
    lost, x = d.integ(2), np.zeros(5)
    for k in range(1, samples + 1):
        predicted = a @ x + (b0 + b1) * phi
        x = predicted + m * (phi * (k * t) ** 2 / 2.0 - lost(k * t) - predicted[0])
    return np.array([d(samples * t), d.deriv(1)(samples * t), d.deriv(2)(samples * t)]) - x[2:]


@velocity_forms
@given(g=bandwidths, t=sample_times)
@settings(deadline=None, max_examples=40)
def test_the_velocity_form_has_its_triple_pole_at_g(form: Form, g: float, t: float) -> None:
    a, *_ = form(g, t)
    scaled = np.diag([1.0, t, t * t])
    assert np.allclose(np.poly(scaled @ a @ np.linalg.inv(scaled)), np.poly([math.exp(-g * t)] * 3), atol=1e-9)


@given(g=bandwidths, t=sample_times, rate=st.floats(0.0, 50.0))
@settings(deadline=None, max_examples=40)
def test_the_position_form_has_its_five_poles_at_g(g: float, t: float, rate: float) -> None:
    a, _, _, m = position_form(g, rate, t)
    scaled = np.diag(t ** np.arange(5.0))
    closed = scaled @ (np.eye(5) - np.outer(m, np.eye(5)[0])) @ a @ np.linalg.inv(scaled)
    assert np.allclose(np.poly(closed), np.poly([math.exp(-g * t)] * 5), atol=1e-8)


@given(g=bandwidths, t=sample_times)
@settings(deadline=None, max_examples=40)
def test_the_exact_form_forgets_any_error_up_to_the_nyquist_frequency(g: float, t: float) -> None:
    g = min(g, math.pi / t)
    a, *_ = velocity_exact(g, t)
    scaled = np.diag([1.0, t, t * t])
    power = np.linalg.matrix_power(scaled @ a @ np.linalg.inv(scaled), math.ceil(60.0 / (g * t)))
    assert np.abs(power).max() < 1e-12


@given(g=st.floats(20.0, 400.0), t=st.floats(5e-4, 2e-3), d=st.lists(st.floats(-10.0, 10.0), min_size=1, max_size=3))
@settings(deadline=None, max_examples=30)
def test_the_exact_form_estimates_disturbances_up_to_degree_two_without_error(
    g: float, t: float, d: list[float]
) -> None:
    settled = math.ceil(45.0 / (g * t))
    errors = velocity_errors(velocity_exact, g, t, Polynomial(d), settled)
    assert np.abs(errors * [1.0, 1.0 / g, 1.0 / g**2]).max() < 1e-6


@given(g=st.floats(40.0, 200.0), d=st.lists(st.floats(-10.0, 10.0), min_size=1, max_size=3))
@settings(deadline=None, max_examples=15)
def test_the_position_form_estimates_disturbances_up_to_degree_two_without_error(g: float, d: list[float]) -> None:
    """Torque is held to first order; a constant one, as here, leaves no error at all."""
    errors = position_errors(g, 1e-3, Polynomial(d), math.ceil(60.0 / (g * 1e-3)))
    assert np.abs(errors * [1.0, 1.0 / g, 1.0 / g**2]).max() < 1e-4


def test_the_first_order_hold_is_exact_for_a_constant_and_tends_to_exact_with_the_square_of_the_sample_time() -> None:
    g = 50.0
    assert np.abs(velocity_errors(velocity_first_order_hold, g, 1e-3, Polynomial([4.0]), 1000)).max() < 1e-7
    coarse, fine = (
        velocity_errors(velocity_first_order_hold, g, t, Polynomial([4.0, -30.0, 80.0]), round(1.0 / t))
        for t in (4e-3, 2e-3)
    )
    assert abs(coarse[0]) > 1e-4
    assert coarse[0] / fine[0] == pytest.approx(4.0, rel=0.02)


@pytest.mark.parametrize("t", [4e-3, 1e-3, 2.5e-4])
def test_the_exact_form_errs_under_a_cubic_disturbance_by_what_its_own_recursion_says(t: float) -> None:
    """d''' = c: e+ = (Phi - L C) e + c ([T^3/6, T^2/2, T] - L T^4/24), which tends to c/g^3, 3c/g^2, 3c/g."""
    g, c = 30.0, 12.0
    a, h, _, _ = velocity_exact(g, t)
    gain = -h
    left_out = c * (np.array([t**3 / 6.0, t**2 / 2.0, t]) - gain * t**4 / 24.0)
    steady = np.linalg.solve(np.eye(3) - a, left_out)
    errors = velocity_errors(velocity_exact, g, t, Polynomial([0.0, 0.0, 0.0, c / 6.0]), round(1.5 / t))
    assert np.allclose(errors, steady, rtol=1e-4)
    limit = c * np.array([1.0 / g**3, 3.0 / g**2, 3.0 / g])
    assert np.allclose(steady, limit, rtol=(g * t) ** 2)


@pytest.mark.parametrize(
    ("errors_of", "factors"),
    [
        (lambda t, d: velocity_errors(velocity_exact, 30.0, t, d, round(1.5 / t)), [1.0, 3.0, 3.0]),
        (lambda t, d: velocity_errors(velocity_first_order_hold, 30.0, t, d, round(1.5 / t)), [1.0, 3.0, 3.0]),
        (lambda t, d: position_errors(30.0, t, d, round(1.5 / t)), [10.0, 10.0, 5.0]),
    ],
    ids=["exact", "first-order hold", "position"],
)
def test_steady_errors_for_a_cubic_disturbance_tend_to_those_of_the_continuous_observer(
    errors_of: Callable[[float, Polynomial], np.ndarray], factors: list[float]
) -> None:
    g, c = 30.0, 12.0
    limit = c * np.array(factors) / g ** np.array([3, 2, 1])
    cubic = Polynomial([0.0, 0.0, 0.0, c / 6.0])
    coarse, fine = (np.abs(errors_of(t, cubic) / limit - 1.0).max() for t in (2e-3, 5e-4))
    assert fine < 0.06
    assert fine < 0.3 * coarse


@velocity_forms
@pytest.mark.parametrize("w", [5.0, 60.0, 300.0])
def test_estimates_of_a_sine_follow_the_transfer_functions_of_the_continuous_observer(form: Form, w: float) -> None:
    """d^/d = (3g s^2 + 3g^2 s + g^3)/D, d'^/d = s (3g^2 s + g^3)/D, d''^/d = s^2 g^3/D with D = (s + g)^3."""
    g, t, s = 100.0, 1e-4, 1j * w
    a, h, _, _ = form(g, t)
    z = np.exp(s * t)
    found = np.linalg.solve(z * np.eye(3) - a, h * (z - 1.0) * (-1.0 / s))
    expected = np.array([3 * g * s**2 + 3 * g**2 * s + g**3, s * (3 * g**2 * s + g**3), s**2 * g**3]) / (s + g) ** 3
    assert np.allclose(found, expected, rtol=0.03, atol=1e-9)
