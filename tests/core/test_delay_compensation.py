"""Predicting the state over the compute delay gives back the loop without delay, one sample later."""

import numpy as np
import pytest

from vssea_core.actuator.parameters import Timing
from vssea_core.control.tuning import Observer, PositionObserver, SlidingMode, StateFeedback, Tuning, VelocityObserver
from vssea_core.scenario import Scenario
from vssea_core.scenarios import NOMINAL
from vssea_core.signals.documents import ConstantStiffness, Disturbances, StepReference
from vssea_core.simulation.run import simulate

DELAYED = Timing(compute_delay_samples=1)
OBSERVERS = {
    "velocity": VelocityObserver(bandwidth=150.0, predict=True),
    "position": PositionObserver(bandwidth=100.0, predict=True),
}


def step(observer: Observer, timing: Timing, stiffness: float = 200.0) -> Scenario:
    """A raw step of 0.02 rad, small enough for no limit to act."""
    return NOMINAL.model_copy(
        update={
            "timing": timing,
            "tuning": Tuning(controller=StateFeedback(natural_frequency=25.0), observer=observer),
            "reference": StepReference(origin=0.0, target=0.02, repeat=False, start_s=0.1),
            "stiffness_reference": ConstantStiffness(stiffness=stiffness),
            "disturbances": Disturbances(),
            "duration_s": 1.0,
        }
    )


@pytest.mark.parametrize("stiffness", [30.0, 200.0, 1000.0])
@pytest.mark.parametrize("observer", OBSERVERS.values(), ids=OBSERVERS)
def test_the_response_is_that_without_delay_shifted_by_one_sample(observer: Observer, stiffness: float) -> None:
    without = simulate(step(observer, Timing(), stiffness))
    compensated = simulate(step(observer, DELAYED, stiffness))
    # The law looks one sample ahead, at reference and state alike, so even the shift is gone.
    assert np.abs(compensated["link_position"] - without["link_position"]).max() < 1e-6 * 0.02 / 1e-3
    bare = simulate(step(observer.model_copy(update={"predict": False}), DELAYED, stiffness))
    assert np.abs(bare["link_position"] - without["link_position"]).max() > 1e-4 * 0.02


@pytest.mark.parametrize("observer", OBSERVERS.values(), ids=OBSERVERS)
def test_without_a_delay_it_changes_nothing(observer: Observer) -> None:
    plain = simulate(step(observer.model_copy(update={"predict": False}), Timing()))
    assert np.array_equal(simulate(step(observer, Timing())).rows, plain.rows)


def test_a_fast_layer_that_the_delay_makes_shake_is_calm_again() -> None:
    """rho T / phi of 1.2 is stable without delay and not with one sample of it, unless that is predicted."""
    fast = SlidingMode(switching_gain=6e5, layer_width=500.0)

    def chatter(observer: Observer, timing: Timing) -> float:
        tuning = Tuning(controller=fast, observer=observer)
        run = simulate(NOMINAL.model_copy(update={"tuning": tuning, "timing": timing, "disturbances": Disturbances()}))
        return float(np.sqrt(np.mean(np.diff(run["motor_torque"][5000:]) ** 2)))

    assert chatter(VelocityObserver(), Timing()) < 0.1
    assert chatter(VelocityObserver(), DELAYED) > 10.0
    assert chatter(VelocityObserver(predict=True), DELAYED) < 0.1
