"""Linear quadratic regulators against python-control, scipy and the return difference they must satisfy."""

import control
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.linalg import solve_continuous_are

from vssea_core.control.design import chain_gains, chain_gains_of_poles
from vssea_core.control.linear_model import LinearModel, state_space
from vssea_core.control.lqr import lqr_chain_gains, lqr_plant_gains, lqr_plant_poles

GAMMA, B = np.diag(np.ones(3), 1), np.array([0.0, 0.0, 0.0, 1.0])
PAPER = LinearModel(0.12, 0.25, 3.3, 6.0, 200.0)
decades = st.floats(-6.0, 8.0).map(lambda exponent: 10.0**exponent)
models = st.builds(
    LinearModel,
    st.floats(0.03, 0.45),
    st.floats(0.0, 1.0),
    st.floats(3.1, 3.6),
    st.floats(0.0, 18.0),
    st.floats(20, 1000),
)


@pytest.mark.parametrize(
    "weights", [(1.0, 1.0, 1.0, 1.0), (1e8, 1.0, 1.0, 1.0), (1e4, 0.0, 0.0, 0.0), (1e12, 0.0, 0.0, 1e4)]
)
@pytest.mark.parametrize("r", [1e-3, 1.0])
def test_on_the_chain_the_gains_are_python_controls(weights: tuple[float, float, float, float], r: float) -> None:
    expected, _, _ = control.lqr(GAMMA, B[:, None], np.diag(weights), r)
    assert lqr_chain_gains(weights, r) == pytest.approx(np.ravel(expected), rel=1e-9)


@given(q=st.tuples(decades, *[st.one_of(st.just(0.0), decades)] * 3), r=decades)
@example(q=(8.6e-5, 0.38, 0.0, 6.6e10), r=6.1e-8)  # poles eleven decades apart
@example(q=(1.0, 0.0, 0.0, 0.0), r=1.0)
@settings(deadline=None, max_examples=200)
def test_on_the_chain_the_return_difference_is_kalmans_at_any_scale(
    q: tuple[float, float, float, float], r: float
) -> None:
    """|1 + K (jw - Gamma)^-1 b|^2 = 1 + sum q_i / r |w^(i-1) / w^4|^2 for every w, and so at least 1."""
    gains = lqr_chain_gains(q, r)
    radius = (q[0] / r) ** 0.125
    for w in radius * np.array([0.01, 0.3, 1.0, 3.0, 100.0]):
        s, powers = 1j * w, w ** np.arange(0.0, 8.0, 2.0)
        found = abs(s**4 + gains @ s ** np.arange(4)) ** 2
        assert found == pytest.approx(w**8 + powers @ np.array(q) / r, rel=1e-6)


@given(model=models, q=st.tuples(*[st.floats(0.01, 1e4)] * 4), r=st.floats(1e-4, 1.0))
@settings(deadline=None)
def test_on_the_plant_the_gains_are_those_of_the_riccati_equation(
    model: LinearModel, q: tuple[float, float, float, float], r: float
) -> None:
    a, b, _ = state_space(model)
    expected = b @ solve_continuous_are(a, b[:, None], np.diag(q), [[r]]) / r
    assert np.allclose(lqr_plant_gains(model, q, r), expected, rtol=1e-5, atol=1e-6 * np.abs(expected).max())


def test_the_chain_takes_over_the_poles_of_the_plants_regulator() -> None:
    weights = (101.0, 1.0, 1.0, 1.0)
    expected, _, poles = control.lqr(*(np.atleast_2d(m) for m in (state_space(PAPER)[0], state_space(PAPER)[1][:, None])),
                                     np.diag(weights), 0.1)  # fmt: skip
    assert lqr_plant_gains(PAPER, weights, 0.1) == pytest.approx(np.ravel(expected), rel=1e-8)
    assert np.allclose(np.sort_complex(lqr_plant_poles(PAPER, weights, 0.1)), np.sort_complex(poles), rtol=1e-7)
    on_chain = chain_gains(PAPER, np.ravel(expected))
    assert on_chain == pytest.approx(chain_gains_of_poles(lqr_plant_poles(PAPER, weights, 0.1)), rel=1e-8)


@pytest.mark.parametrize(
    ("weights", "r", "sentence"),
    [
        ((0.0, 1.0, 1.0, 1.0), 1.0, "that of a position above 0"),
        ((1.0, -1.0, 0.0, 0.0), 1.0, "none below 0"),
        ((1.0, 0.0, 0.0, 0.0), 0.0, "more than 0, or the gains have no bound"),
    ],
)
def test_weights_without_a_regulator_are_refused(
    weights: tuple[float, float, float, float], r: float, sentence: str
) -> None:
    with pytest.raises(ValueError, match=sentence):
        lqr_chain_gains(weights, r)


def test_on_the_plant_a_weight_on_either_position_will_do() -> None:
    assert np.isfinite(lqr_plant_gains(PAPER, (0.0, 0.0, 1.0, 0.0), 1.0)).all()
    with pytest.raises(ValueError, match="position above 0"):
        lqr_plant_gains(PAPER, (0.0, 1.0, 0.0, 1.0), 1.0)
