"""The drive's transport delay: exact against a linear plant with exactly delayed input, unknown to the controller."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from tests.core.experiment import Experiment
from vssea_core.actuator.dynamics import PlantState
from vssea_core.actuator.parameters import Actuator, EquilibriumMotor, Timing
from vssea_core.actuator.parts import DELAY_LINE, Delay, advance_in_parts, delay_of, lags_of_parts, passed_on
from vssea_core.compiled import entry
from vssea_core.scenario import Scenario
from vssea_core.scenarios import NOMINAL, REALISTIC
from vssea_core.signals.documents import Disturbances, StepReference
from vssea_core.simulation.run import simulate
from vssea_core.simulation.state import plant_numbers

T = 1e-3
MOTOR = EquilibriumMotor()
TINY = 1e-5  # N m: the spring is linear to 1e-14 for the deflections that this makes


@entry
def driven(plant, lag_s, delay, line, start, torques, none):  # type: ignore[no-untyped-def]
    """States (n, 7) of the plant at each tick, and at the end of the last, for a sequence of torques."""
    now, lags = start, lags_of_parts(plant, lag_s, delay.share, 1e-3)
    states = np.empty((len(torques) + 1, 7))
    for k in range(len(torques)):
        for j in range(7):
            states[k, j] = now[j]
        older, newer = passed_on(delay, line, torques[k])
        now, _ = advance_in_parts(
            plant, lag_s, lags, now, older, newer, delay.share, 0.0, none, none, none, k * 1e-3, 1e-3
        )
    for j in range(7):
        states[len(torques), j] = now[j]
    return states


def linear_states(lag_s: float, delay_s: float, torques: np.ndarray) -> np.ndarray:
    """[theta_l, omega_l, theta_e, omega_e] at the ticks: matrix exponentials between exact switching times."""
    j_l, b_l, j_e, b_e, k = 0.10, 0.10, 3.17, 4.0, 200.0
    a = np.zeros((6, 6))  # theta_l, omega_l, theta_e, omega_e, motor torque, commanded torque
    a[0, 1] = a[2, 3] = 1.0
    a[1, :3] = -k / j_l, -b_l / j_l, k / j_l
    a[3, 0], a[3, 2], a[3, 3], a[3, 4] = k / j_e, -k / j_e, -b_e / j_e, 1.0 / j_e
    if lag_s > 0.0:
        a[4, 4], a[4, 5] = -1.0 / lag_s, 1.0 / lag_s
    x, states, t = np.zeros(6), [], 0.0
    switches = [k * T + delay_s for k in range(len(torques))]
    for tick in range(len(torques) + 1):
        end = tick * T
        while t < end:
            due = [i for i, at in enumerate(switches) if at <= t + 1e-12]
            x[5] = torques[due[-1]] if due else 0.0
            if lag_s == 0.0:
                x[4] = x[5]
            until = min([at for at in switches if at > t + 1e-12] + [end])
            x = expm(a * (until - t)) @ x
            t = until
        states.append(x[:4].copy())
    return np.array(states)


@pytest.mark.parametrize("lag_s", [0.0, 1.6e-4, 2e-3])
@pytest.mark.parametrize("delay_s", [0.0, 3e-4, 1e-3, 2.5e-3, 0.02])
def test_the_plant_is_driven_as_by_an_exactly_delayed_input(delay_s: float, lag_s: float) -> None:
    torques = TINY * np.random.default_rng(1).normal(size=60)
    plant = plant_numbers(Actuator(), T)._replace(per_stiffness_inertia=0.0)
    start = PlantState(0.0, 0.0, 0.0, 0.0, (6.2e7 / 400.0) ** (1 / 3), 0.0, 0.0)
    line, delay = np.zeros(DELAY_LINE), delay_of(delay_s, T)
    found = driven(plant, lag_s, delay, line, start, torques, np.empty((0, 16)))
    expected = linear_states(lag_s, delay_s, torques)
    assert np.abs(expected).max() > 1e-4 * TINY
    per_newton_metre = np.abs(found[:, :4] - expected).max() / TINY
    assert per_newton_metre < (1e-12 if lag_s == 0.0 else 1e-9)


@given(delay_s=st.floats(0.0, 0.02), period=st.sampled_from([9e-4, 1e-3, 2e-3, 5e-3]))
@settings(deadline=None, max_examples=100)
def test_a_delay_is_whole_samples_and_a_share(delay_s: float, period: float) -> None:
    delay = delay_of(delay_s, period)
    assert delay.samples == int(delay.samples)
    assert 0.0 <= delay.share < 1.0
    assert (delay.samples + delay.share) * period == pytest.approx(delay_s, abs=1e-9 * period)


def test_a_delay_longer_than_the_line_is_refused_with_what_to_do() -> None:
    scenario = NOMINAL.model_copy(
        update={
            "actuator": Actuator(motor=EquilibriumMotor(torque_delay_s=0.02)),
            "timing": Timing(sample_time_s=5e-4),
        }
    )
    with pytest.raises(
        ValueError, match=r"is 40 samples of 0.0005 s; expected at most 23 samples, so shorten the delay"
    ):
        simulate(scenario)


def delayed(scenario: Scenario, delay_s: float) -> Scenario:
    motor = scenario.actuator.motor.model_copy(update={"torque_delay_s": delay_s})
    return scenario.model_copy(
        update={"actuator": scenario.actuator.model_copy(update={"motor": motor}), "duration_s": 2.0}
    )


def test_the_controller_does_not_know_of_the_delay() -> None:
    """Its first answer to a step is the same; what the drive is commanded is what is recorded and observed."""
    step = NOMINAL.model_copy(
        update={"reference": StepReference(target=0.05, start_s=0.02), "disturbances": Disturbances()}
    )
    at_once, late = simulate(delayed(step, 0.0)), simulate(delayed(step, 0.003))
    assert np.array_equal(at_once["motor_torque"][:21], late["motor_torque"][:21])
    assert late["motor_torque"][20] > 1.0
    moved = [int(np.argmax(np.abs(run["motor_velocity"]) > 1e-9)) for run in (at_once, late)]
    assert moved == [21, 24]
    assert np.abs(late["motor_disturbance_estimate"][21:24]).max() > 0.1, (
        "it takes the missing torque for a disturbance"
    )


def test_a_sample_of_delay_that_the_controller_knows_is_another_matter() -> None:
    known = simulate(delayed(NOMINAL, 0.0).model_copy(update={"timing": Timing(compute_delay_samples=1)}))
    unknown = simulate(delayed(NOMINAL, 1e-3))
    assert np.abs(known["error"] - unknown["error"]).max() > 1e-6


def test_a_longer_delay_makes_the_loop_worse_until_it_is_unstable() -> None:
    errors = []
    for delay_s in (0.0, 0.004, 0.02):
        run = simulate(delayed(REALISTIC, delay_s))
        errors.append(np.sqrt(np.mean(run["error"] ** 2)))
    assert errors[0] < errors[1] < errors[2]
    assert errors[2] > 10.0 * errors[0]


def test_pieces_of_a_delayed_run_equal_the_whole_to_the_bit() -> None:
    scenario = delayed(REALISTIC, 0.0033)
    whole, pieces = Experiment(scenario), Experiment(scenario)
    rows = whole.advance(900).rows
    assert np.array_equal(np.vstack([pieces.advance(count).rows for count in (1, 2, 397, 500)]), rows)


def test_no_delay_uses_no_line() -> None:
    assert delay_of(0.0, T) == Delay(0.0, 0.0)
