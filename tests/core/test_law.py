"""The laws and their map to torque: the link's snap is the one that was asked for, whatever moves."""

import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.reference import parameters as reference
from tests.reference.plant import advance, derivative
from vssea_core.actuator.parameters import EquilibriumMotor
from vssea_core.control.design import state_feedback_gains, surface_gains
from vssea_core.control.law import LAYER, SGN, SLIDING_MODE, Law, StiffnessTarget, Target, Terms, act, switched
from vssea_core.control.observer import Channel, Memory, Spring
from vssea_core.control.packing import law_of
from vssea_core.control.prepared import prepare
from vssea_core.control.tuning import SlidingMode, StateFeedback, Tuning
from vssea_core.scenarios import NOMINAL
from vssea_core.signals.documents import StepReference
from vssea_core.simulation.run import simulate

LAW = law_of(prepare(Tuning(), 1e-3))
PLANT = reference.Plant()
angles, rates = st.floats(-0.4, 0.4), st.floats(-2.0, 2.0)
decades = pytest.mark.parametrize("pole", [0.5, 8.0, 20.0, 500.0])


def terms_at(law: Law, x: np.ndarray, link: np.ndarray, motor: float, r: Target, ms_acceleration: float) -> Terms:
    """The law's Terms at the true state x (theta_l, omega_l, theta_e, omega_e, theta_ms, omega_ms), perfect estimates."""
    memory = Memory(
        Channel(x[0], x[1], *link, x[0]),
        Channel(x[2], x[3], motor, 0.0, 0.0, x[2]),
        Channel(x[4], x[5], 0.0, 0.0, 0.0, x[4]),
        Spring(0.0, 0.0, 1.0),
        0.0,
    )
    return Terms(*act(law, memory, r, StiffnessTarget(x[4], x[5], ms_acceleration)))


@given(
    x=st.tuples(angles, rates, angles, rates, st.floats(35.0, 110.0), st.floats(-300.0, 300.0)),
    link=st.tuples(st.floats(-40.0, 40.0), st.floats(-100.0, 100.0), st.floats(-500.0, 500.0)),
    motor=st.floats(-3.0, 3.0),
    ms_acceleration=st.floats(-5000.0, 5000.0),
    snap=st.floats(-2e4, 2e4),
)
@settings(deadline=None, max_examples=30)
def test_the_links_snap_is_the_one_asked_for_while_the_stiffness_moves(
    x: tuple[float, ...], link: tuple[float, float, float], motor: float, ms_acceleration: float, snap: float
) -> None:
    """Every theta_ms term is needed: the plant is Eqs. (1)-(4) with all of theta_ms, its rate and its acceleration."""
    state = np.array([*x, 0.0])
    r4 = snap - terms_at(LAW, state, np.array(link), motor, Target(0, 0, 0, 0, 0.0), ms_acceleration).snap
    terms = terms_at(LAW, state, np.array(link), motor, Target(0, 0, 0, 0, r4), ms_acceleration)
    assert terms.snap == pytest.approx(snap, abs=1e-6)

    d, d1, d2 = np.array(link) * PLANT.link_inertia
    disturbances = (
        lambda t: d + d1 * t + d2 * t * t / 2.0,
        lambda t: motor * PLANT.motor_inertia,
        lambda t: 0.0,
    )
    at_rest = derivative(PLANT, 0.0, state.tolist(), 0.0, 0.0, disturbances)[5]
    torque_ms = PLANT.stiffness_inertia * (ms_acceleration - at_rest)

    def acceleration(time: float) -> float:
        there = advance(PLANT, state, 0.0, time, terms.motor_torque, torque_ms, disturbances) if time else state
        return derivative(PLANT, time, there.tolist(), 0.0, 0.0, disturbances)[1]

    def second_difference(h: float) -> float:
        return (acceleration(h) - 2.0 * acceleration(0.0) + acceleration(-h)) / h**2

    h = 4e-4
    found = (4.0 * second_difference(h / 2.0) - second_difference(h)) / 3.0
    assert found == pytest.approx(snap, rel=1e-4, abs=2.0)


@decades
@pytest.mark.parametrize("damping", [0.5, 1.0, 1.5])
def test_state_feedback_gains_place_the_poles_of_the_error_state(pole: float, damping: float) -> None:
    gains = state_feedback_gains(pole, damping)
    wanted = np.roots([1.0, 2.0 * damping * pole, pole**2])
    gamma, b = np.diag(np.ones(3), 1), np.eye(4)[:, 3:]
    placed = control.place_acker(gamma, b, np.tile(wanted, 2))
    assert np.allclose(gains, placed.ravel(), rtol=1e-9)
    assert np.allclose(np.poly(gamma - b * gains), np.real(np.poly(np.tile(wanted, 2))), rtol=1e-9)


@decades
def test_surface_gains_are_the_polynomial_of_the_sliding_poles(pole: float) -> None:
    assert np.allclose(surface_gains(pole), np.poly([-pole] * 3)[:0:-1], rtol=1e-12)


@given(sigma=st.floats(-1e6, 1e6), width=st.floats(1e-3, 1e6))
@settings(deadline=None, max_examples=50)
def test_the_switch_saturates_over_its_layer_and_is_odd(sigma: float, width: float) -> None:
    assert switched(LAYER, sigma, width) == pytest.approx(np.clip(sigma / width, -1.0, 1.0), abs=1e-15)
    assert switched(SGN, sigma, width) == np.sign(sigma)
    assert switched(LAYER, -sigma, width) == -switched(LAYER, sigma, width)


@given(
    x=st.tuples(angles, rates, angles, rates, st.floats(35.0, 110.0), st.floats(-100.0, 100.0)),
    pole=st.floats(1.0, 40.0), width=st.floats(1e4, 1e6), slope=st.floats(1.0, 200.0), r4=st.floats(-1e3, 1e3),
)  # fmt: skip
@settings(deadline=None, max_examples=50)
def test_inside_its_layer_the_sliding_law_is_state_feedback(
    x: tuple[float, ...], pole: float, width: float, slope: float, r4: float
) -> None:
    """With l = rho/phi: K = [l s1, s1 + l s2, s2 + l s3, s3 + l]."""
    s1, s2, s3 = surface_gains(pole)
    sliding = LAW._replace(
        controller=SLIDING_MODE, switch=LAYER, s1=s1, s2=s2, s3=s3, layer_width=width, switching_gain=slope * width
    )
    k1, k2, k3, k4 = slope * s1, s1 + slope * s2, s2 + slope * s3, s3 + slope
    linear = LAW._replace(k1=k1, k2=k2, k3=k3, k4=k4, s1=s1, s2=s2, s3=s3)
    given_terms = (np.array(x), np.zeros(3), 0.0, Target(0.1, 0.2, -0.3, 1.0, r4), 0.0)
    layered, feedback = terms_at(sliding, *given_terms), terms_at(linear, *given_terms)
    if abs(layered.sigma) <= width:
        assert layered.snap == pytest.approx(feedback.snap, rel=1e-9, abs=1e-6)
        assert layered.motor_torque == pytest.approx(feedback.motor_torque, rel=1e-9, abs=1e-6)
    else:
        assert layered.snap == pytest.approx(
            r4 + s1 * layered.e2 + s2 * layered.e3 + s3 * layered.e4 + slope * width * np.sign(layered.sigma), rel=1e-9
        )


def test_the_prepared_numbers_of_a_tuning_are_its_gains_and_its_model() -> None:
    tuning = Tuning(controller=SlidingMode(surface_pole=11.0, switching_gain=7e3, switch="sgn"))
    made = law_of(prepare(tuning, 1e-3))
    assert (made.controller, made.switching_gain, made.switch) == (SLIDING_MODE, 7e3, SGN)
    assert np.allclose([made.s1, made.s2, made.s3], surface_gains(11.0))
    assert (made.link_inertia, made.motor_damping) == (tuning.model.link_inertia, tuning.model.motor_damping)


@pytest.mark.parametrize("controller", [StateFeedback(natural_frequency=20.0), SlidingMode()], ids=lambda law: law.kind)
def test_a_saturated_step_recovers_because_the_observer_is_fed_what_was_applied(controller: StateFeedback) -> None:
    """A raw 1 rad step at p 20; fed the unlimited torque the loop would still be 0.3 rad off after 3 s."""
    scenario = NOMINAL.model_copy(
        update={
            "actuator": NOMINAL.actuator.model_copy(update={"motor": EquilibriumMotor(continuous_torque=74.0)}),
            "tuning": Tuning(controller=controller),
            "reference": StepReference(origin=0.0, target=1.0, repeat=False, start_s=0.0),
            "duration_s": 3.0,
        }
    )
    run = simulate(scenario)
    assert np.abs(run["motor_torque_demand"]).max() > 1.5 * 74.0
    assert np.abs(run["error"][-200:]).max() < 1e-3
