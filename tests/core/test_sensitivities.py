"""Closed-loop maps and noise: against the open loop, closed forms and Parseval's theorem."""

import math

import control
import numpy as np
import pytest

from tests.core.operating_points import OBSERVERS, realistic
from vssea_core.actuator.sensors import Encoders
from vssea_core.analysis.assembly import NOISE, TORQUE
from vssea_core.analysis.certify import scenario_of
from vssea_core.analysis.frequency_response import frequency_response
from vssea_core.analysis.loop import loop_model
from vssea_core.analysis.noise import observer_figures, torque_noise
from vssea_core.analysis.sensitivities import map_at, response, sensitivities
from vssea_core.control.tuning import Observer, PositionObserver, StateFeedback, VelocityObserver
from vssea_core.signals.documents import Disturbances, SineReference
from vssea_core.simulation.run import simulate

observers = pytest.mark.parametrize("observer", OBSERVERS.values(), ids=OBSERVERS)
W = np.geomspace(0.5, 3000.0, 400)
COUNTS = Encoders(2.0 * math.pi / 2**17, 2.0 * math.pi / (16384 * 100), 0.0)


@observers
def test_the_response_is_that_of_python_control(observer: Observer) -> None:
    loop = loop_model(realistic(observer))
    G = frequency_response(loop.A, loop.B, loop.C, loop.D, 1e-3, W)
    expected = control.ss(loop.A, loop.B, loop.C, loop.D, 1e-3)(np.exp(1j * W * 1e-3)).transpose(2, 0, 1)
    size = np.abs(expected).max(axis=0)
    assert np.all(np.abs(G - expected) <= 1e-8 * size)


@observers
@pytest.mark.parametrize("delay", [0, 1])
def test_s_and_t_of_the_open_loop_add_up_to_one(observer: Observer, delay: int) -> None:
    loop = loop_model(realistic(observer, delay))
    L = control.ss(*loop.broken_at_plant(), 1e-3)(np.exp(1j * W * 1e-3))
    assert map_at(loop, "S", W) == pytest.approx(1.0 / (1.0 + L), rel=1e-6)
    assert map_at(loop, "T", W) == pytest.approx(L / (1.0 + L), rel=1e-6)
    assert map_at(loop, "S", W) + map_at(loop, "T", W) == pytest.approx(1.0)


@pytest.mark.parametrize("g", [20.0, 50.0])
def test_the_nominal_velocity_observer_has_the_transfer_of_the_theory(g: float) -> None:
    """d -> estimate is (3 g s^2 + 3 g^2 s + g^3) / (s + g)^3, whatever the controller does; sampling adds little below g."""
    loop = loop_model(realistic(VelocityObserver(bandwidth=g), delay=0, lag_s=0.0))
    s = 1j * np.geomspace(0.1, g, 50)
    expected = (3.0 * g * s**2 + 3.0 * g**2 * s + g**3) / (s + g) ** 3
    for name in ("link_estimate", "motor_estimate"):
        assert np.abs(map_at(loop, name, s.imag) - expected).max() < 0.6 * g * 1e-3


@observers
def test_a_constant_load_leaves_no_error_and_a_slow_reference_is_followed(observer: Observer) -> None:
    loop = loop_model(realistic(observer))
    slow = np.array([1e-3])
    for name in ("link_disturbance_to_error", "motor_disturbance_to_error", "reference_to_error"):
        assert abs(map_at(loop, name, slow)[0]) < 1e-5


@observers
def test_every_peak_is_the_largest_of_its_curve(observer: Observer) -> None:
    loop = loop_model(realistic(observer))
    found = sensitivities(loop)
    for name, curve in found.curves.items():
        assert found.peaks[name].value >= np.abs(curve).max() * (1.0 - 1e-12)
        at = np.array([found.peaks[name].frequency])
        assert abs(map_at(loop, name, at)[0]) == pytest.approx(found.peaks[name].value)
    assert found.peaks["S"].value > 1.0


@observers
@pytest.mark.parametrize("delay", [0, 1])
def test_torque_noise_is_the_integral_of_its_spectrum(observer: Observer, delay: int) -> None:
    loop = loop_model(realistic(observer, delay))
    angle = (np.arange(20000) + 0.5) * math.pi / 20000
    G = response(loop, angle / 1e-3)[:, TORQUE, NOISE : NOISE + 2]
    variance = np.sum(np.abs(G) ** 2 * np.array([COUNTS.link, COUNTS.motor]) ** 2 / 12.0, axis=1)
    found = torque_noise(loop, COUNTS)
    assert found.rms == pytest.approx(math.sqrt(np.mean(variance)), rel=1e-6)
    assert found.chatter == pytest.approx(
        math.sqrt(np.mean(variance * np.abs(1.0 - np.exp(-1j * angle)) ** 2)), rel=1e-6
    )


def test_sample_to_sample_torque_is_that_of_the_theorys_simulations() -> None:
    """Theory, section 5: 0.86 N m at k 200 and 5.6 N m at k 50 with the position observer; friction hardly matters."""
    for stiffness, expected in ((200.0, 0.86), (50.0, 5.6)):
        loop = loop_model(realistic(PositionObserver(), delay=0, lag_s=0.0, stiffness=stiffness))
        assert torque_noise(loop, COUNTS).chatter == pytest.approx(expected, rel=0.01)


def test_equal_low_frequency_error_needs_2_15_times_the_bandwidth_on_positions() -> None:
    """Errors 10 c / g^3 against c / g^3 for d''' = c."""
    of = {}
    for g, observer in ((20.0, VelocityObserver(bandwidth=20.0)), (43.1, PositionObserver(bandwidth=43.1))):
        loop = loop_model(realistic(observer, delay=0, lag_s=0.0))
        of[g] = abs(1.0 - map_at(loop, "link_estimate", np.array([0.5]))[0])
    assert of[43.1] == pytest.approx(of[20.0], rel=0.05)


@observers
def test_the_estimates_bandwidth_is_where_it_falls_to_half_the_power(observer: Observer) -> None:
    loop = loop_model(realistic(observer))
    found = observer_figures(loop, COUNTS)
    at = map_at(loop, "link_estimate", np.array([found.estimate_bandwidth]))[0]
    assert abs(at) == pytest.approx(math.sqrt(0.5), rel=1e-4)
    assert found.tracking_error_1hz == pytest.approx(
        abs(map_at(loop, "reference_to_error", np.array([2.0 * math.pi]))[0])
    )


def test_an_unstable_loop_has_no_response_and_the_reason_is_given() -> None:
    point = realistic(link_inertia=3.0)
    with pytest.raises(ValueError, match="closed loop is unstable"):
        sensitivities(loop_model(point))
    with pytest.raises(ValueError, match="closed loop is unstable"):
        torque_noise(loop_model(point), COUNTS)


def test_faster_poles_cost_torque_noise() -> None:
    """kappa p^4: the price of a pole is told by the figure a user sees."""
    noise = []
    for pole in (10.0, 20.0, 40.0):
        point = realistic(PositionObserver())
        tuning = point.tuning.model_copy(update={"controller": StateFeedback(natural_frequency=pole)})
        loop = loop_model(type(point)(tuning, point.timing, point.stiffness, point.plant))
        noise.append(torque_noise(loop, COUNTS).rms)
    assert noise == sorted(noise)


@pytest.mark.parametrize("predict", [False, True])
@observers
def test_the_error_of_a_sine_is_that_of_its_simulation(observer: Observer, predict: bool) -> None:
    """A small sine of 1.5 Hz, one sample of delay, compensated or not: the amplitude of the steady error."""
    point = realistic(observer.model_copy(update={"predict": predict}))
    scenario = scenario_of(point, 8.0).model_copy(
        update={
            "reference": SineReference(amplitude=1e-4, frequency_hz=1.5, fade_in_s=1.0),
            "disturbances": Disturbances(),
        }
    )
    late = simulate(scenario)["error"][4000:]
    w = 2.0 * math.pi * 1.5
    times = np.arange(len(late)) * 1e-3
    amplitude = np.hypot(*np.linalg.lstsq(np.column_stack([np.sin(w * times), np.cos(w * times)]), late, rcond=None)[0])
    expected = abs(map_at(loop_model(point), "reference_to_error", np.array([w]))[0])
    assert amplitude / 1e-4 == pytest.approx(expected, rel=2e-3)
