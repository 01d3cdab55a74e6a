"""One step of the integrator against scipy's Dormand-Prince formulas, which know nothing of positions and velocities."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import RK45

from vssea_core.actuator.dynamics import Plant, dormand_prince_step, lag_shares
from vssea_core.actuator.stages import POSITION_WEIGHTS, VELOCITY_WEIGHTS
from vssea_core.scenarios import NOMINAL
from vssea_core.signals.disturbances import INSTANTS
from vssea_core.simulation.state import plant_numbers

H = 1e-3
PLANT = plant_numbers(NOMINAL.actuator, H)
Y_TAU = PLANT.spring_constant


def slope(plant: Plant, y: np.ndarray, tau_e: float, tau_ms: float, load_l: float, load_e: float) -> np.ndarray:
    """Eqs. (1)-(4) as they are printed, deflection and back torque corrected."""
    theta_l, theta_e, theta_ms, omega_l, omega_e, omega_ms = y
    tau_s = Y_TAU * np.sin((theta_e - theta_l) / 2.0) / theta_ms**3
    back = -12.0 * Y_TAU * np.sin((theta_e - theta_l) / 4.0) ** 2 / theta_ms**4
    return np.array(
        [
            omega_l,
            omega_e,
            omega_ms,
            (tau_s - plant.link_damping * omega_l - load_l) * plant.per_link_inertia,
            (tau_e - tau_s - plant.motor_damping * omega_e - load_e) * plant.per_motor_inertia,
            (tau_ms - plant.stiffness_damping * omega_ms - back) * plant.per_stiffness_inertia,
        ]
    )


states = st.tuples(
    st.floats(-1.0, 1.0), st.floats(-0.3, 0.3), st.floats(40.0, 70.0),
    st.floats(-5.0, 5.0), st.floats(-5.0, 5.0), st.floats(-20.0, 20.0),
)  # fmt: skip
loads = st.tuples(*[st.floats(-20.0, 20.0)] * 6)


@given(state=states, link=loads, motor=loads, tau_e=st.floats(-70.0, 70.0), tau_ms=st.floats(-3.0, 3.0))
@settings(deadline=None, max_examples=60)
def test_a_step_is_that_of_dormand_and_prince(
    state: tuple[float, ...], link: tuple[float, ...], motor: tuple[float, ...], tau_e: float, tau_ms: float
) -> None:
    theta_l, deflection, *rest = state
    y = np.array([theta_l, theta_l + deflection, *rest])
    slopes = np.zeros((6, 6))
    for stage in range(6):
        at = y + H * RK45.A[stage, :stage] @ slopes[:stage] if stage else y
        slopes[stage] = slope(PLANT, at, tau_e, tau_ms, link[stage], motor[stage])
    expected = y + H * RK45.B @ slopes
    unlagged = lag_shares(0.0, PLANT.per_motor_inertia, PLANT.motor_damping, H)
    found = dormand_prince_step(PLANT, None, unlagged, tuple(y), 0.0, tau_e, tau_ms, link, motor, (0.0,) * 6, H)
    assert np.allclose(found, expected, rtol=1e-13, atol=1e-13 * np.abs(slopes).max() * H)


def test_the_weights_are_those_of_the_table() -> None:
    velocity, position = np.array(VELOCITY_WEIGHTS), np.array(POSITION_WEIGHTS)
    assert np.allclose(velocity[:6, :5], RK45.A, rtol=1e-15, atol=0.0)
    assert np.allclose(velocity[6], RK45.B, rtol=1e-15, atol=0.0)
    assert velocity[:6].sum(axis=1) == pytest.approx(INSTANTS)
    assert position[2:6].sum(axis=1) == pytest.approx(np.square(INSTANTS[2:]) / 2.0)
    assert position[6].sum() == pytest.approx(0.5)
