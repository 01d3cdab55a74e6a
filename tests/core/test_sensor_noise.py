"""Seeded sensor noise: added before rounding, with its stated size, the same in every run with the same seed."""

import numpy as np
import pytest

from tests.core.experiment import Experiment
from vssea_core.actuator.dynamics import PlantState
from vssea_core.actuator.parameters import EquilibriumMotor, Sensors
from vssea_core.actuator.sensors import Noise, encoders, measure, noise_of
from vssea_core.scenario import Scenario
from vssea_core.scenarios import NOMINAL, REALISTIC
from vssea_core.signals.documents import Disturbances, NoiseDisturbance
from vssea_core.simulation.run import simulate

STATE = PlantState(0.1, 1.0, -0.3, 2.0, 53.7, 3.0, 0.0)
TRUE = np.array([0.1, -0.3, 53.7, 1.0, 2.0, 3.0])
NOISY = Sensors(link_noise=1e-4, motor_noise=2e-5, stiffness_noise=1e-2, velocity_noise=0.05)


def measured(sensors: Sensors, seed: int, samples: range) -> np.ndarray:
    sizes, noise = encoders(sensors, EquilibriumMotor()), noise_of(sensors, seed)
    return np.array([measure(sizes, noise, STATE, k) for k in samples])


def test_every_signal_has_the_noise_that_the_document_says() -> None:
    errors = measured(NOISY, 1, range(20_000)) - TRUE
    expected = np.array([1e-4, 2e-5, 1e-2, 0.05, 0.05, 0.05])
    assert np.allclose(errors.std(axis=0), expected, rtol=0.02)
    assert np.all(np.abs(errors.mean(axis=0)) < 4.0 * expected / np.sqrt(20_000))
    assert np.abs(np.corrcoef(errors.T) - np.eye(6)).max() < 0.03


def test_noise_is_added_before_rounding() -> None:
    coarse = NOISY.model_copy(update={"link_bits": 14})
    counts = measured(coarse, 1, range(2000))[:, 0] / (2.0 * np.pi / 2**14)
    assert np.allclose(counts, np.rint(counts), atol=1e-6)
    assert len(set(np.rint(counts))) > 1


def test_a_measurement_depends_on_seed_and_sample_only() -> None:
    forth, back = measured(NOISY, 7, range(100)), measured(NOISY, 7, range(99, -1, -1))
    assert np.array_equal(forth, back[::-1])
    assert not np.any(forth == measured(NOISY, 8, range(100)))


def test_sensors_without_noise_read_the_state() -> None:
    assert noise_of(Sensors(), 3).any == 0.0
    assert np.array_equal(measured(Sensors(), 3, range(3)), np.array([TRUE] * 3))
    assert noise_of(Sensors(velocity_noise=0.1), 3) == Noise(0.0, 0.0, 0.0, 0.1, 3.0, 1.0)


def noisy(scenario: Scenario, seed: int) -> Scenario:
    sensors = scenario.sensors.model_copy(update={"link_noise": 5e-5, "velocity_noise": 1e-2})
    loads = Disturbances(link=(NoiseDisturbance(),), stiffness_motor=(NoiseDisturbance(rms=0.02),))
    return scenario.model_copy(update={"sensors": sensors, "disturbances": loads, "seed": seed, "duration_s": 1.0})


@pytest.mark.parametrize("scenario", [NOMINAL, REALISTIC], ids=lambda each: each.name)
def test_a_noisy_run_is_the_same_to_the_bit_with_its_seed_and_another_with_another(scenario: Scenario) -> None:
    first, again, other = (simulate(noisy(scenario, seed)).rows for seed in (4, 4, 5))
    assert np.array_equal(first, again)
    assert not np.array_equal(first[1:], other[1:])


def test_pieces_of_a_noisy_run_equal_the_whole_to_the_bit() -> None:
    whole, pieces = Experiment(noisy(REALISTIC, 4)), Experiment(noisy(REALISTIC, 4))
    rows = whole.advance(600).rows
    assert np.array_equal(np.vstack([pieces.advance(count).rows for count in (1, 2, 297, 300)]), rows)


def test_the_noise_of_a_torque_does_not_depend_on_the_sample_time() -> None:
    runs = [
        simulate(
            noisy(NOMINAL, 4).model_copy(update={"timing": NOMINAL.timing.model_copy(update={"sample_time_s": period})})
        )
        for period in (1e-3, 5e-4)
    ]
    assert np.allclose(runs[0]["link_disturbance"], runs[1]["link_disturbance"][::2], atol=1e-9)
