"""The bound on the tracking error under a bounded disturbance, against simulations of the product's own loop."""

import math

import numpy as np
import pytest

from vssea_core.analysis.error_bound import error_bound
from vssea_core.control.tuning import (
    Baseline,
    Controller,
    NoObserver,
    Observer,
    PositionObserver,
    SlidingMode,
    Tuning,
    VelocityObserver,
)
from vssea_core.scenarios import NOMINAL
from vssea_core.signals.documents import Disturbances, SineDisturbance, StepReference
from vssea_core.simulation.run import simulate

LAWS: dict[str, Tuning] = {
    "feedback, velocity": Tuning(observer=VelocityObserver(bandwidth=60.0)),
    "feedback, butterworth": Tuning(observer=VelocityObserver(bandwidth=60.0, shape="butterworth")),
    "feedback, position": Tuning(observer=PositionObserver(bandwidth=80.0)),
    "layer": Tuning(controller=SlidingMode(switching_gain=1e4), observer=VelocityObserver(bandwidth=60.0)),
}
AMPLITUDE, FREQUENCY_HZ = 2.0, 1.0
JERK = AMPLITUDE * (2.0 * math.pi * FREQUENCY_HZ) ** 3


@pytest.mark.parametrize("tuning", LAWS.values(), ids=LAWS)
def test_a_sine_stays_within_the_exact_bound_and_the_exact_within_lyapunovs(tuning: Tuning) -> None:
    found = error_bound(tuning, 1e-3, 200.0, JERK, 0.0)
    assert found is not None
    scenario = NOMINAL.model_copy(
        update={
            "tuning": tuning,
            "reference": StepReference(origin=0.0, target=0.0, repeat=False),
            "disturbances": Disturbances(link=(SineDisturbance(amplitude=AMPLITUDE, frequency_hz=FREQUENCY_HZ),)),
            "duration_s": 4.0,
        }
    )
    largest = float(np.abs(simulate(scenario)["error"][2000:]).max())
    assert 0.05 * found.found.peak_error < largest < 1.02 * found.found.peak_error
    assert found.found.peak_error < found.found.lyapunov_bound


@pytest.mark.parametrize(
    ("controller", "observer"),
    [(Baseline(), VelocityObserver()), (SlidingMode(), NoObserver())],
    ids=["baseline", "off"],
)
def test_without_an_observer_or_a_chain_there_is_no_such_bound(controller: Controller, observer: Observer) -> None:
    assert error_bound(Tuning(controller=controller, observer=observer), 1e-3, 200.0, 1.0, 1.0) is None
