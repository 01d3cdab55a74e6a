"""The linear model, its chain of integrators and its sampled form, against matrix algebra and scipy."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from tests.reference.linear import sampled_plant
from tests.reference.parameters import Plant
from vssea_core.control.linear_model import LinearModel, normal_form, plant_polynomial, sampled, state_space
from vssea_core.control.matrix_exponential import exponential_less_identity

models = st.builds(
    LinearModel,
    st.floats(0.03, 0.45),
    st.floats(0.0, 1.0),
    st.floats(3.1, 3.6),
    st.floats(0.0, 18.0),
    st.floats(20, 1000),
)


@given(model=models)
def test_in_the_links_derivatives_the_plant_is_a_chain_of_four_integrators(model: LinearModel) -> None:
    a, b, c = state_space(model)
    transform, alpha = normal_form(model)
    size = np.abs(transform) @ np.abs(a) + np.abs(transform)
    assert np.allclose(transform[0], c)
    assert np.all(np.abs((transform @ a)[:3] - transform[1:]) <= 1e-13 * size[:3])
    assert np.all(np.abs(transform[3] @ a - alpha) <= 1e-13 * size[3])
    assert np.allclose(transform @ b, [0.0, 0.0, 0.0, 1.0 / model.torque_per_snap], rtol=1e-14, atol=0.0)


@given(model=models)
def test_the_plant_polynomial_is_the_characteristic_one(model: LinearModel) -> None:
    a, _, _ = state_space(model)
    w = np.sqrt(np.abs(a).max())
    scale = w ** -np.arange(4.0, 0.0, -1.0)
    expected = np.poly(np.diag(w ** -np.array([0, 1, 0, 1.0])) @ a @ np.diag(w ** np.array([0, 1, 0, 1.0])) / w)
    assert np.allclose(plant_polynomial(model) * scale, expected[:0:-1], atol=1e-12)


@given(model=models, t=st.floats(1e-4, 5e-3))
@settings(deadline=None)
def test_the_sampled_plant_is_that_of_the_reference(model: LinearModel, t: float) -> None:
    jl, bl, je, be, k = model
    plant = Plant(link_inertia=jl, link_damping=bl, motor_inertia=je, motor_damping=be)
    for found, expected in zip(sampled(model, t), sampled_plant(plant, k, t), strict=True):
        assert np.allclose(found, expected, rtol=1e-9, atol=1e-13)


@given(entries=st.lists(st.floats(-6.0, 6.0), min_size=9, max_size=9))
@settings(deadline=None)
def test_the_exponential_is_that_of_scipy(entries: list[float]) -> None:
    matrix = np.array(entries).reshape(3, 3)
    expected = expm(matrix)
    assert np.allclose(
        exponential_less_identity(matrix) + np.eye(3), expected, rtol=1e-9, atol=1e-11 * np.abs(expected).max()
    )


@pytest.mark.parametrize("rate", [-1e-12, -1e-6, -0.3, -3.0, 2.0])
def test_nothing_is_lost_beside_the_identity(rate: float) -> None:
    assert exponential_less_identity(np.diag([rate, 2 * rate])).diagonal() == pytest.approx(
        np.expm1([rate, 2 * rate]), rel=1e-14, abs=0.0
    )
