"""Observers with other poles than a multiple one: where the poles are, what the Kalman gain is, what errors are left."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm, solve_discrete_are

from vssea_core.control import observer_design
from vssea_core.control.observer_design import position_form, velocity_exact, velocity_first_order_hold
from vssea_core.control.observer_poles import position_poles, steady_errors, velocity_poles

Polynomial = np.polynomial.Polynomial
VELOCITY_FORMS = {"exact": velocity_exact, "first-order hold": velocity_first_order_hold}
VELOCITY_FORMS_OF_POLES = {
    "exact": observer_design.velocity_exact_of_poles,
    "first-order hold": observer_design.velocity_first_order_hold_of_poles,
}
bandwidths = st.floats(1.0, 2000.0)
sample_times = st.floats(1e-4, 5e-3)
negative = st.floats(-500.0, -1.0)
pairs = st.builds(lambda a, b: [complex(a, b), complex(a, -b)], negative, negative)


def in_samples(matrix: np.ndarray, t: float) -> np.ndarray:
    """The same matrix for states scaled by powers of the sample time."""
    scale = t ** np.arange(float(len(matrix)))
    return scale[:, None] * matrix / scale


def closed(a: np.ndarray, m: np.ndarray) -> np.ndarray:
    """Error matrix of the current form, (I - M C) A."""
    return (np.eye(5) - np.outer(m, np.eye(5)[0])) @ a


@pytest.mark.parametrize("form", VELOCITY_FORMS_OF_POLES.values(), ids=VELOCITY_FORMS_OF_POLES)
@given(pole=negative, pair=pairs, t=sample_times)
@settings(deadline=None, max_examples=40)
def test_the_velocity_forms_have_any_three_poles(
    form: Callable[..., tuple[np.ndarray, ...]], pole: float, pair: list[complex], t: float
) -> None:
    a, *_ = form([pole, *pair], t)
    assert np.allclose(np.poly(in_samples(a, t)), np.poly(np.exp(np.array([pole, *pair]) * t)).real, atol=1e-9)


@given(pole=negative, first=pairs, second=pairs, rate=st.floats(0.0, 50.0), t=sample_times)
@settings(deadline=None, max_examples=40)
def test_the_position_form_has_any_five_poles(
    pole: float, first: list[complex], second: list[complex], rate: float, t: float
) -> None:
    poles = [pole, *first, *second]
    a, _, _, m = observer_design.position_form_of_poles(poles, rate, t)
    assert np.allclose(np.poly(in_samples(closed(a, m), t)), np.poly(np.exp(np.array(poles) * t)).real, atol=1e-8)


@given(rate=st.floats(0.0, 4000.0), t=sample_times)
@settings(deadline=None, max_examples=60)
def test_the_position_forms_prediction_is_the_exponential_of_its_model(rate: float, t: float) -> None:
    """From the smallest damping rate to one of many a sample; phi held to first order as a level and a ramp."""
    block = np.diag([1.0, -1.0, 1.0, 1.0, 0.0, 1.0], 1)
    block[1, 1] = -rate * t
    block[1, 5] = 1.0
    expected = expm(block)
    a, b0, b1, _ = position_form(100.0, rate, t)
    scale = t ** np.arange(5.0)
    assert np.allclose(in_samples(a, t), expected[:5, :5], rtol=1e-9, atol=1e-14)
    assert np.allclose((b0 + b1) * scale / t**2, expected[:5, 5], rtol=1e-9, atol=1e-14)
    assert np.allclose(b1 * scale / t**2, expected[:5, 6], rtol=1e-9, atol=1e-14)


def butterworth(order: int, g: float) -> np.ndarray:
    """Poles as the left half of the roots of s^(2n) = (-1)^(n+1) g^(2n)."""
    roots = np.roots([1.0, *[0.0] * (2 * order - 1), (-1.0) ** order])
    poles: np.ndarray = g * roots[roots.real < -1e-9]
    return poles


def gap(poles: np.ndarray, expected: np.ndarray) -> float:
    """Largest distance from a pole to the nearest expected one, both ways."""
    distances = np.abs(poles[:, None] - expected)
    return float(max(distances.min(axis=0).max(), distances.min(axis=1).max()))


@given(g=bandwidths)
def test_butterworth_is_on_a_circle_of_radius_g(g: float) -> None:
    assert gap(velocity_poles(g, "butterworth"), butterworth(3, g)) < 1e-9 * g
    assert gap(position_poles(g, "kalman"), butterworth(5, g)) < 1e-9 * g


@pytest.mark.parametrize("form", VELOCITY_FORMS.values(), ids=VELOCITY_FORMS)
def test_the_shape_of_a_velocity_form_is_that_of_its_poles_and_the_multiple_pole_is_the_default(
    form: Callable[..., tuple[np.ndarray, ...]],
) -> None:
    t, g = 1e-3, 90.0
    a, *_ = form(g, t, "butterworth")
    assert np.allclose(np.poly(in_samples(a, t)), np.poly(np.exp(butterworth(3, g) * t)).real, atol=1e-12)
    assert all(np.array_equal(one, other) for one, other in zip(form(g, t), form(g, t, "multiple"), strict=True))


def riccati(g: float, rate: float, t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Steady-state Kalman filter for q / (r t) = g^10, r = 1: M, A, process noise and covariance, in x_i / g^i."""
    a = np.diag([1.0, -1.0, 1.0, 1.0], 1)
    a[1, 1] = -rate / g
    noise = np.zeros((5, 5))
    noise[4, 4] = 1.0
    van_loan = expm(g * t * np.block([[-a, noise], [np.zeros((5, 5)), a.T]]))
    transition = van_loan[5:, 5:].T
    process = transition @ van_loan[:5, 5:] * (g * t)
    c = np.eye(5)[:1]
    covariance = solve_discrete_are(transition.T, c.T, process, np.eye(1))
    return covariance[:, 0] / (1.0 + covariance[0, 0]), transition, process, covariance


@pytest.mark.parametrize(
    ("g", "t"), [(10.0, 1e-4), (10.0, 1e-3), (100.0, 1e-4), (100.0, 1e-3), (100.0, 5e-3), (800.0, 1e-3)]
)
def test_kalman_is_the_solution_of_the_riccati_equation(g: float, t: float) -> None:
    _, _, _, m = position_form(g, 0.0, t, "kalman")
    assert m / g ** np.arange(5.0) == pytest.approx(riccati(g, 0.0, t)[0], rel=1e-6)


@pytest.mark.parametrize("rate", [1.0, 6.0, 33.0])
def test_with_damping_the_estimates_vary_hardly_more_than_the_optimal_ones(rate: float) -> None:
    """Its poles stay those of the undamped chain; at g 100 that costs less than 0.1 % of the variance of d^."""
    g, t = 100.0, 1e-3
    optimal, transition, process, _ = riccati(g, rate, t)
    ours = position_form(g, rate, t, "kalman")[3] / g ** np.arange(5.0)

    def variance(m: np.ndarray) -> np.ndarray:
        keep = np.eye(5) - np.outer(m, np.eye(5)[0])
        step, noise = keep @ transition, keep @ process @ keep.T + np.outer(m, m)
        flat = np.linalg.solve(np.eye(25) - np.kron(step, step), noise.ravel())
        return flat.reshape(5, 5).diagonal()

    excess = variance(ours)[2] / variance(optimal)[2] - 1.0
    assert -1e-9 < excess < 1e-3


def test_the_optimal_poles_are_butterworths_of_radius_g_and_the_samples_add_next_to_nothing() -> None:
    """As long as g T is well below pi: what is folded from beyond the Nyquist frequency goes with (g T / 2 pi)^10."""
    g = 100.0
    for t in (1e-4, 1e-3, 5e-3):
        m, transition, _, _ = riccati(g, 0.0, t)
        poles = np.log(np.linalg.eigvals(closed(transition, m))) / t
        assert gap(poles, butterworth(5, g)) < 1e-7 * g


@given(g=bandwidths)
def test_steady_errors_of_multiple_poles_are_those_of_the_theory(g: float) -> None:
    powers = g ** np.array([3.0, 2.0, 1.0])
    assert steady_errors(velocity_poles(g)) * powers == pytest.approx([1.0, 3.0, 3.0], rel=1e-12)
    assert steady_errors(position_poles(g)) * powers == pytest.approx([10.0, 10.0, 5.0], rel=1e-12)


def velocity_errors(matrices: tuple[np.ndarray, ...], t: float, d: Polynomial, samples: int) -> np.ndarray:
    """True minus estimated d, d', d'' after `samples` of the exact motion v' = -d."""
    a, h, _, _ = matrices
    lost, estimate = d.integ(), np.zeros(3)
    for k in range(1, samples + 1):
        estimate = a @ estimate - h * (lost(k * t) - lost((k - 1) * t))
    return np.array([d(samples * t), d.deriv(1)(samples * t), d.deriv(2)(samples * t)]) - estimate


def position_errors(matrices: tuple[np.ndarray, ...], t: float, d: Polynomial, samples: int) -> np.ndarray:
    """The same on the exact motion theta'' = -d without damping."""
    a, _, _, m = matrices
    lost, x = d.integ(2), np.zeros(5)
    for k in range(1, samples + 1):
        predicted = a @ x
        x = predicted + m * (-lost(k * t) - predicted[0])
    return np.array([d(samples * t), d.deriv(1)(samples * t), d.deriv(2)(samples * t)]) - x[2:]


SHAPES = {
    "exact, butterworth": (
        velocity_poles(30.0, "butterworth"),
        lambda t, d: velocity_errors(velocity_exact(30.0, t, "butterworth"), t, d, round(1.5 / t)),
    ),
    "first-order hold, butterworth": (
        velocity_poles(30.0, "butterworth"),
        lambda t, d: velocity_errors(velocity_first_order_hold(30.0, t, "butterworth"), t, d, round(1.5 / t)),
    ),
    "position, multiple": (
        position_poles(30.0),
        lambda t, d: position_errors(position_form(30.0, 0.0, t), t, d, round(1.5 / t)),
    ),
    "position, kalman": (
        position_poles(30.0, "kalman"),
        lambda t, d: position_errors(position_form(30.0, 0.0, t, "kalman"), t, d, round(2.5 / t)),
    ),
}


@pytest.mark.parametrize(("poles", "errors_of"), SHAPES.values(), ids=SHAPES)
def test_steady_errors_are_what_the_recursions_tend_to_at_short_samples(
    poles: np.ndarray, errors_of: Callable[[float, Polynomial], np.ndarray]
) -> None:
    cubic = Polynomial([0.0, 0.0, 0.0, 12.0 / 6.0])
    limit = 12.0 * steady_errors(poles)
    coarse, fine = (np.abs(errors_of(t, cubic) / limit - 1.0).max() for t in (2e-3, 5e-4))
    assert fine < 0.06
    assert fine < 0.3 * coarse


@pytest.mark.parametrize("form", [velocity_exact, velocity_first_order_hold])
def test_an_unknown_shape_is_refused_with_those_there_are(form: Callable[..., object]) -> None:
    with pytest.raises(ValueError, match="'round'; expected 'multiple' or 'butterworth'"):
        form(100.0, 1e-3, "round")
    with pytest.raises(ValueError, match="'round'; expected 'multiple' or 'kalman'"):
        position_form(100.0, 1.0, 1e-3, "round")  # type: ignore[arg-type]
