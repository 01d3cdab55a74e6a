"""Super-twisting: the promise of sgn without its chatter; its integral waits while a limit holds the torque back."""

import numpy as np

from tests.core.experiment import Experiment
from vssea_core.control.packing import TWISTING_AT
from vssea_core.control.tuning import SlidingMode, Tuning
from vssea_core.scenario import Scenario
from vssea_core.scenarios import NOMINAL
from vssea_core.signals.documents import StepReference
from vssea_core.simulation.state import MEMORY

TWISTING = MEMORY + TWISTING_AT
SUPER = Tuning(controller=SlidingMode(switch="super_twisting", twisting_gain=1e4))


def scenario(**parts: object) -> Scenario:
    return NOMINAL.model_copy(update={"tuning": SUPER, **parts})


def test_it_tracks_as_sgn_does_with_a_hundredth_of_its_chatter() -> None:
    """Theory: sgn with rho 500 gives 0.03 mrad and 1.6 N m, super-twisting with L 1e4 0.03 mrad and 0.02 N m."""
    figures = {}
    for switch in ("sgn", "super_twisting"):
        controller = SlidingMode(switch=switch, switching_gain=500.0, twisting_gain=1e4)
        run = Experiment(scenario(tuning=Tuning(controller=controller))).advance(10_000)
        settled = slice(5000, None)
        figures[switch] = (
            np.sqrt(np.mean(run["error"][settled] ** 2)),
            np.sqrt(np.mean(np.diff(run["motor_torque"][settled]) ** 2)),
        )
    assert figures["super_twisting"][0] < 5e-5
    assert figures["super_twisting"][1] < 0.02 * figures["sgn"][1]


def test_its_integral_is_what_the_law_says_sample_by_sample() -> None:
    experiment = Experiment(scenario())
    experiment.advance(3500)
    gain, period = 1e4, experiment.period
    for _ in range(200):
        before = experiment.state[TWISTING]
        sample = experiment.advance(1)
        assert sample["limits"][0] == 0.0
        step = 1.1 * gain * period * np.sign(sample["sliding_variable"][0])
        assert experiment.state[TWISTING] == before + step


def test_its_integral_waits_while_a_limit_holds_the_torque_back() -> None:
    reference = StepReference(origin=0.0, target=1.0, repeat=False, start_s=0.0)
    strong = Tuning(controller=SlidingMode(switch="super_twisting", twisting_gain=1e6))
    experiment = Experiment(scenario(reference=reference, tuning=strong))
    held = 0
    for _ in range(60):
        before = experiment.state[TWISTING]
        if int(experiment.advance(1)["limits"][0]) & 7:
            assert experiment.state[TWISTING] == before
            held += 1
    assert held > 20


def test_another_law_forgets_the_integral() -> None:
    experiment = Experiment(scenario())
    experiment.advance(3500)
    while experiment.state[TWISTING] == 0.0:
        experiment.advance(1)
    experiment.advance(1, Tuning())
    assert experiment.state[TWISTING] == 0.0
