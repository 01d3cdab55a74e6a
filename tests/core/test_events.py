"""The events of a document: which there are, from where to where, and that each is judged over its own window."""

import numpy as np
import pytest

from vssea_core.channels import CHANNELS, INDEX
from vssea_core.scenario import Scenario
from vssea_core.scenarios import NOMINAL
from vssea_core.signals.documents import (
    ConstantDisturbance,
    Disturbances,
    MoveReference,
    MoveStiffness,
    SineDisturbance,
    SineReference,
    StepReference,
)
from vssea_core.simulation.events import event_metrics
from vssea_core.simulation.metrics import metrics
from vssea_core.simulation.run import simulate


def rows_of(time: np.ndarray, position: np.ndarray | float = 0.0, error: np.ndarray | float = 0.0) -> np.ndarray:
    rows = np.zeros((len(time), len(CHANNELS)))
    rows[:, INDEX["time"]], rows[:, INDEX["link_position"]], rows[:, INDEX["error"]] = time, position, error
    return rows


TIME = np.arange(0.0, 10.0, 1e-3)


def test_moves_to_and_fro_go_to_the_documents_targets_in_turn() -> None:
    scenario = Scenario(reference=MoveReference(origin=0.1, target=0.6, duration_s=1.0, dwell_s=2.0, start_s=0.5))
    found = event_metrics(scenario, rows_of(TIME))
    assert [(event.time_s, event.label) for event in found] == [
        (0.5, "move 0.1 to 0.6 rad"),
        (3.5, "move 0.6 to 0.1 rad"),
        (6.5, "move 0.1 to 0.6 rad"),
        (9.5, "move 0.6 to 0.1 rad"),
    ]
    assert [event.until_s for event in found] == pytest.approx([3.5, 6.5, 9.5, 9.999])
    steady = [event.step.steady_error for event in found if event.step is not None]
    assert steady == pytest.approx([0.6, 0.1, 0.6, 0.1])


def test_a_single_step_is_one_event_and_a_sine_is_none() -> None:
    once = Scenario(reference=StepReference(target=0.3, repeat=False, start_s=2.0))
    assert [event.label for event in event_metrics(once, rows_of(TIME))] == ["step 0 to 0.3 rad"]
    assert event_metrics(Scenario(reference=SineReference()), rows_of(TIME)) == ()
    assert event_metrics(once, rows_of(TIME[:0])) == ()


def test_disturbances_start_and_end_and_those_of_one_instant_are_one_event() -> None:
    scenario = Scenario(
        disturbances=Disturbances(
            link=(ConstantDisturbance(start_s=3.0, end_s=6.0), SineDisturbance(start_s=3.0)),
            motor=(ConstantDisturbance(start_s=4.0),),
        ),
        stiffness_reference=MoveStiffness(start_s=8.0),
    )
    found = event_metrics(scenario, rows_of(TIME))
    assert [(event.kind, event.time_s, event.label) for event in found] == [
        ("disturbance", 3.0, "constant on the link starts; sine on the link starts"),
        ("disturbance", 4.0, "constant on the motor starts"),
        ("disturbance", 6.0, "constant on the link ends"),
        ("stiffness", 8.0, "stiffness 200 to 400 N·m/rad"),
    ]
    assert all(event.step is None for event in found)


def test_each_event_is_judged_over_its_own_window_only() -> None:
    """Errors of 5 mrad in the first window until 3.2 s, of 9 mrad in the second, which does not recover."""
    error = np.where(TIME < 3.2, 5e-3, np.where(TIME < 4.0, 0.0, -9e-3))
    scenario = Scenario(
        disturbances=Disturbances(link=(ConstantDisturbance(start_s=3.0), ConstantDisturbance(start_s=4.0)))
    )
    first, second = event_metrics(scenario, rows_of(TIME, error=error))
    assert first.peak_error == 5e-3
    assert first.recovery_time_s == pytest.approx(0.2, abs=1e-3)
    assert first.undefined == {}
    assert second.peak_error == 9e-3
    assert second.recovery_time_s is None
    assert second.undefined["recovery_time_s"] == "error 0.009 rad at the end, outside the band of 0.001 rad"
    (wide, _) = event_metrics(scenario, rows_of(TIME, error=error), recovery_band=6e-3)
    assert wide.recovery_time_s == 0.0


def test_in_the_last_samples_of_a_session_events_before_them_are_left_out() -> None:
    scenario = Scenario(reference=StepReference(target=0.3, dwell_s=2.0, start_s=1.0))
    found = event_metrics(scenario, rows_of(TIME[4000:]), reference_set_at_s=0.5)
    assert [event.time_s for event in found] == [5.5, 7.5, 9.5]


def test_a_simulated_move_is_followed_and_a_load_is_recovered_from() -> None:
    scenario = NOMINAL.model_copy(
        update={
            "reference": MoveReference(target=0.5, duration_s=1.0, repeat=False, start_s=0.5),
            "disturbances": Disturbances(link=(ConstantDisturbance(torque=3.0, start_s=3.0),)),
            "duration_s": 6.0,
        }
    )
    move, load = event_metrics(scenario, simulate(scenario).rows)
    assert move.step is not None
    assert move.step.undefined == {}
    x = np.linspace(0.0, 1.0, 100_001)
    polynomial = x**5 * (126 - 420 * x + 540 * x**2 - 315 * x**3 + 70 * x**4)
    expected = x[np.argmax(polynomial >= 0.9)] - x[np.argmax(polynomial >= 0.1)]
    assert move.step.rise_time_s == pytest.approx(expected, abs=2e-3)
    assert move.step.steady_error == pytest.approx(0.0, abs=1e-6)
    assert 1e-3 < load.peak_error < 0.05
    assert load.recovery_time_s is not None
    assert 0.1 < load.recovery_time_s < 1.0


@pytest.mark.parametrize("bits", [1, 2, 4, 7])
def test_time_saturated_is_the_share_of_saturated_samples_of_the_recorded_time(bits: int) -> None:
    rows = rows_of(TIME)
    rows[2000:2500, INDEX["limits"]] = bits
    rows[3000:, INDEX["limits"]] = 8 | 64
    assert metrics(rows)["saturated_time"] == pytest.approx(0.5)
    assert metrics(rows)["saturated"] == pytest.approx(5.0)
    assert metrics(rows[2250:2750])["saturated_time"] == pytest.approx(0.25)
    assert metrics(rows[:1])["saturated_time"] == 0.0
    assert metrics(rows[:0])["saturated_time"] == 0.0
