"""Poles of the sampled loop: their terms, their order, and what sampling does to repeated ones."""

import numpy as np
import pytest

from tests.core.operating_points import OBSERVERS, realistic
from vssea_core.actuator.parameters import Timing
from vssea_core.analysis.loop import LoopModel, loop_model
from vssea_core.analysis.operating_point import at_model
from vssea_core.analysis.poles import poles
from vssea_core.control.tuning import Observer, StateFeedback, Tuning


def model_of(A: np.ndarray) -> LoopModel:
    n = len(A)
    return LoopModel(A, np.zeros((n, 13)), np.zeros((4, n)), np.zeros((4, 13)), tuple("x" * n), 1e-3, False)


def test_a_sampled_oscillator_has_the_poles_it_was_made_of() -> None:
    s = complex(-3.0, 40.0)
    z = np.exp(s * 1e-3)
    found = poles(model_of(np.array([[z.real, z.imag, 0.0], [-z.imag, z.real, 0.0], [0.0, 0.0, 0.0]])))
    (pole,) = found.poles
    assert pole.continuous == pytest.approx(s)
    assert pole.pair
    assert pole.natural_frequency == pytest.approx(abs(s))
    assert pole.damping == pytest.approx(3.0 / abs(s))
    assert found.deadbeat == 1


def test_the_slowest_to_decay_comes_first_and_is_dominant() -> None:
    found = poles(loop_model(realistic()))
    decay = [-pole.continuous.real for pole in found.poles]
    assert decay == sorted(decay)
    assert found.dominant is found.poles[0]


def test_the_quadruple_pole_splits_as_the_theory_says() -> None:
    tuning = Tuning(controller=StateFeedback(natural_frequency=8.0))
    found = poles(loop_model(at_model(tuning, Timing(), 1000.0)))
    slow = [pole.continuous for pole in found.poles if abs(pole.continuous) < 60.0]
    assert slow == pytest.approx([-4.1, complex(-4.4, 4.7), -24.6], abs=0.06)


@pytest.mark.parametrize("observer", OBSERVERS.values(), ids=OBSERVERS)
def test_repeated_observer_poles_are_noted(observer: Observer) -> None:
    """The nominal observer keeps its own poles: the motor's channel is not moved by the loop."""
    found = poles(loop_model(realistic(observer)))
    count = 3 if observer.kind == "velocity" else 5
    assert found.note is not None
    assert f"{count} near 100 rad/s" in found.note


def test_the_document_has_a_number_for_every_pole() -> None:
    loop = loop_model(realistic())
    document = poles(loop).document()
    count = sum(2 if pole["pair"] else 1 for pole in document["poles"]) + document["deadbeat"]
    assert count == len(loop.A)
