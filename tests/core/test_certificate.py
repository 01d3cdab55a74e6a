"""Certificates hold against the worst disturbance there is, and are as sharp as they say."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from tests.reference.linear import law_rows
from tests.reference.parameters import Plant
from vssea_core.control.certificate import certificate, snap_bound, snap_weights
from vssea_core.control.design import chain_gains_of_poles, polynomial_of, state_feedback_gains
from vssea_core.control.linear_model import LinearModel
from vssea_core.control.lqr import lqr_chain_gains
from vssea_core.control.observer_bounds import estimation_bounds, transient_constant
from vssea_core.control.observer_poles import position_poles, steady_errors, velocity_poles
from vssea_core.control.peak_gain import peak_gain

GAINS = {
    "quadruple pole": state_feedback_gains(8.0, 1.0),
    "oscillating pairs": state_feedback_gains(8.0, 0.3),
    "spread poles": chain_gains_of_poles([-2.0, -9.0, complex(-5.0, 12.0), complex(-5.0, -12.0)]),
    "lqr": lqr_chain_gains((1e5, 10.0, 1.0, 1.0), 1.0),
}
designs = pytest.mark.parametrize("gains", GAINS.values(), ids=GAINS)
D = 300.0


def companion(gains: np.ndarray) -> np.ndarray:
    a = np.diag(np.ones(len(gains) - 1), 1)
    a[-1] -= gains
    return a


def worst_case(a: np.ndarray, b: np.ndarray, c: np.ndarray, time: float, dt: float) -> np.ndarray:
    """States (samples, n) under the bang-bang input of size 1 that drives c x(time) as high as it can be."""
    count = round(time / dt)
    block = np.zeros((len(a) + 1,) * 2)
    block[:-1, :-1], block[:-1, -1] = a, b
    step = expm(block * dt)
    phi, gam = step[:-1, :-1], step[:-1, -1]
    responses, row = np.empty(count), c.copy()
    for k in range(count):
        responses[k] = row @ gam
        row = row @ phi
    x, states = np.zeros(len(a)), []
    for w in np.sign(responses[::-1]):
        x = phi @ x + gam * w
        states.append(x)
    return np.array(states)


@designs
def test_no_bounded_disturbance_exceeds_the_peak_error_and_the_worst_one_reaches_it(gains: np.ndarray) -> None:
    found = certificate(gains, D)
    states = D * worst_case(companion(gains), np.eye(4)[3], np.eye(4)[0], 12.0, 2e-3)
    assert np.abs(states[:, 0]).max() <= found.peak_error * (1.0 + 1e-9)
    assert states[-1, 0] == pytest.approx(found.peak_error, rel=2e-4)


@designs
def test_the_worst_disturbance_of_any_direction_stays_within_lyapunovs_bound(gains: np.ndarray) -> None:
    found = certificate(gains, D)
    scale = found.scale ** -np.arange(4.0)
    for direction in np.vstack([np.eye(4), np.ones(4), [1.0, -1.0, 1.0, -1.0]]):
        states = D * worst_case(companion(gains), np.eye(4)[3], direction * scale, 6.0, 4e-3)
        assert np.linalg.norm(states * scale, axis=1).max() <= found.lyapunov_bound
    assert found.conservatism > 1.0
    assert found.conservatism == pytest.approx(found.lyapunov_bound / found.peak_error)


@designs
def test_the_lyapunov_matrix_solves_its_equation_and_its_transient_bound_holds(gains: np.ndarray) -> None:
    found = certificate(gains, D)
    scaled = companion(gains / found.scale ** np.arange(4.0, 0.0, -1.0))
    p = found.lyapunov_matrix
    assert np.allclose(scaled.T @ p + p @ scaled, -np.eye(4), atol=1e-9 * np.abs(p).max())
    assert np.linalg.eigvalsh(p).min() > 0.0
    for x in np.linalg.eigh(p)[1].T:
        assert found.decay / found.scale <= x @ x / (2.0 * x @ p @ x) * (1.0 + 1e-9), (
            "the P-norm shrinks at least as fast"
        )
    for time in np.linspace(0.0, 20.0, 200):
        bound = found.overshoot * math.exp(-found.decay * time / found.scale)
        assert np.linalg.norm(expm(scaled * time), 2) <= bound


@given(p=st.floats(0.5, 500.0))
@settings(deadline=None, max_examples=30)
def test_the_quadruple_pole_errs_by_at_most_d_over_p_to_the_fourth(p: float) -> None:
    found = certificate(state_feedback_gains(p, 1.0), D)
    assert found.peak_error == pytest.approx(D / p**4, rel=1e-10)
    assert found.conservatism == pytest.approx(29.92, abs=0.01), "the same at any p: the states are scaled"


@given(damping=st.floats(0.02, 0.98), w=st.floats(0.1, 1e3))
@settings(deadline=None, max_examples=30)
def test_the_peak_gain_of_an_oscillator_is_its_closed_form(damping: float, w: float) -> None:
    """1/(s^2 + 2 z w s + w^2): coth(pi z / (2 sqrt(1 - z^2))) / w^2."""
    expected = 1.0 / (w * w * math.tanh(math.pi * damping / (2.0 * math.sqrt(1.0 - damping**2))))
    assert peak_gain(np.array([1.0]), np.array([w * w, 2.0 * damping * w])) == pytest.approx(expected, rel=1e-9)


def test_a_response_that_does_not_die_out_or_has_poles_too_far_apart_is_refused() -> None:
    with pytest.raises(ValueError, match="left half-plane"):
        peak_gain(np.array([1.0]), np.array([1.0, 0.0]))
    with pytest.raises(ValueError, match="expected at most about"):
        peak_gain(np.array([1.0]), np.array([1e6, 1e6 + 1.0]))
    with pytest.raises(ValueError, match="do not stabilise"):
        certificate(np.array([1.0, 1.0, 1.0, 1.0]), D)
    with pytest.raises(ValueError, match="expected 0 or more"):
        certificate(GAINS["lqr"], -1.0)


@designs
def test_the_weights_of_the_estimation_errors_are_those_of_the_references_torque(gains: np.ndarray) -> None:
    model = LinearModel(0.12, 0.25, 3.3, 6.0, 350.0)
    plant = Plant(link_inertia=0.12, link_damping=0.25, motor_inertia=3.3, motor_damping=6.0)
    _, torque = law_rows(gains, plant, 350.0)
    assert snap_weights(model, gains) == pytest.approx(torque / model.torque_per_snap, rel=1e-10)
    errors = np.array([0.1, -2.0, 30.0, 0.01])
    signs = np.sign(snap_weights(model, gains))
    assert snap_bound(model, gains, errors) == pytest.approx(snap_weights(model, gains) @ (signs * np.abs(errors)))


POLES = {
    "velocity": velocity_poles(60.0),
    "velocity, butterworth": velocity_poles(60.0, "butterworth"),
    "position": position_poles(60.0),
    "position, kalman": position_poles(60.0, "kalman"),
}


@pytest.mark.parametrize("poles", POLES.values(), ids=POLES)
def test_estimates_err_by_at_most_their_bounds_and_the_worst_disturbance_gets_there(poles: np.ndarray) -> None:
    """The error of d, d', d'' as the last three states of the observer's chain of integrators, driven by d'''."""
    polynomial = polynomial_of(poles)
    order = len(polynomial)
    error = np.diag(np.ones(order - 1), 1)
    error[:, 0] = -polynomial[::-1]
    bounds = estimation_bounds(poles, 1.0)
    for i in range(3):
        states = worst_case(error, np.eye(order)[-1], np.eye(order)[order - 3 + i], 0.6, 1e-4)
        assert states[-1, order - 3 + i] == pytest.approx(bounds[i], rel=1e-3)
        assert np.abs(states[:, order - 3 + i]).max() <= bounds[i] * (1.0 + 1e-9)


def test_for_multiple_poles_the_bounds_are_the_steady_errors() -> None:
    for name in ("velocity", "position"):
        assert estimation_bounds(POLES[name], 7.0) == pytest.approx(7.0 * steady_errors(POLES[name]), rel=1e-9)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.8])
def test_the_constant_before_the_exponential_of_eq_24_is_the_smallest_that_holds(share: float) -> None:
    g = 60.0
    constant = transient_constant(velocity_poles(g), share * g)
    error = np.array([[-3.0, 1.0, 0.0], [-3.0, 0.0, 1.0], [-1.0, 0.0, 0.0]])
    grid = np.linspace(0.0, 60.0, 3001)
    reached = max(np.linalg.norm(expm(error * time), 2) * math.exp(share * time) for time in grid)
    assert reached <= constant * (1.0 + 1e-9)
    assert reached >= 0.999 * constant
    assert constant > 1.3, "the paper's 1 is too small"
    assert transient_constant(velocity_poles(5.0), share * 5.0) == pytest.approx(constant)


def test_the_triple_pole_decays_slower_than_its_own_rate() -> None:
    with pytest.raises(ValueError, match="expected less than 60"):
        transient_constant(velocity_poles(60.0), 60.0)
