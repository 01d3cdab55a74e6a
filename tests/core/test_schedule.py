"""Gains that follow the stiffness: at each stiffness those of a design made there, and one tuning for the whole range."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vssea_core.actuator.spring import stiffness_motor_position
from vssea_core.control.law import Law
from vssea_core.control.packing import ROW, take_row
from vssea_core.control.prepared import prepare
from vssea_core.control.tuning import Baseline, PositionObserver, Schedule, SlidingMode, StateFeedback, Tuning
from vssea_core.scenarios import NOMINAL
from vssea_core.signals.documents import ConstantStiffness, MoveStiffness
from vssea_core.simulation.run import simulate

TUNINGS = {
    "poles and bandwidth": Tuning(schedule=Schedule(poles_exponent=0.3, bandwidth_exponent=0.35)),
    "position observer": Tuning(observer=PositionObserver(), schedule=Schedule(bandwidth_exponent=0.35)),
    "LQR on the plant": Tuning(controller=StateFeedback(design="lqr_plant")),
    "exact sampling": Tuning(controller=StateFeedback(sampled=True)),
    "baseline": Tuning(controller=Baseline(natural_frequency=8.0)),
    "sliding mode": Tuning(controller=SlidingMode(), schedule=Schedule(poles_exponent=-0.2)),
}


def row_at(prepared: np.ndarray, tuning: Tuning, stiffness: float) -> np.ndarray:
    row = np.empty(ROW)
    take_row(prepared, stiffness_motor_position(stiffness, tuning.model.spring_constant), row)
    return row


@pytest.mark.parametrize("tuning", TUNINGS.values(), ids=TUNINGS)
@given(stiffness=st.floats(20.0, 1000.0))
@settings(deadline=None, max_examples=15)
def test_between_the_rows_of_the_table_gains_are_those_of_a_design_made_there(tuning: Tuning, stiffness: float) -> None:
    table = row_at(prepare(tuning, 1e-3), tuning, stiffness)
    made_there = row_at(prepare(tuning, 1e-3, (stiffness, stiffness)), tuning, stiffness)
    size = np.abs(made_there)
    x1, x3 = Law._fields.index("x1"), Law._fields.index("x3")
    # x1 and x3 pass through zero, and have one unit.
    size[x1 : x1 + 2] = size[x3 : x3 + 2] = np.maximum(size[x1 : x1 + 2], size[x3 : x3 + 2])
    assert np.all(np.abs(table - made_there) <= 2e-4 * size + 1e-9)


def test_outside_the_table_its_ends_hold() -> None:
    tuning = TUNINGS["poles and bandwidth"]
    prepared = prepare(tuning, 1e-3, (50.0, 500.0))
    assert np.allclose(row_at(prepared, tuning, 20.0), row_at(prepared, tuning, 50.0), rtol=1e-12)
    assert np.allclose(row_at(prepared, tuning, 900.0), row_at(prepared, tuning, 500.0), rtol=1e-12)


def test_exponents_of_zero_are_the_plain_tuning_to_the_bit() -> None:
    assert np.array_equal(prepare(Tuning(schedule=Schedule(reference_stiffness=77.0)), 1e-3), prepare(Tuning(), 1e-3))


def test_at_its_reference_stiffness_a_schedule_is_the_plain_tuning() -> None:
    plain = NOMINAL.model_copy(update={"stiffness_reference": ConstantStiffness(stiffness=200.0), "duration_s": 5.0})
    tuning = Tuning(schedule=Schedule(reference_stiffness=200.0, poles_exponent=0.4, bandwidth_exponent=0.4))
    scheduled = simulate(plain.model_copy(update={"tuning": tuning}))
    assert np.abs(scheduled["link_position"] - simulate(plain)["link_position"]).max() < 1e-6


def test_a_scheduled_tuning_follows_while_the_stiffness_falls_fifty_fold() -> None:
    scenario = NOMINAL.model_copy(
        update={
            "tuning": Tuning(schedule=Schedule(poles_exponent=0.25, bandwidth_exponent=0.35)),
            "stiffness_reference": MoveStiffness(stiffness=1000.0, target=20.0, start_s=2.0, duration_s=0.5),
            "duration_s": 6.0,
        }
    )
    run = simulate(scenario)
    assert run.ending is None
    assert np.abs(run["error"][1500:3000]).max() < 5e-3


def test_pieces_of_any_length_give_the_same_run_to_the_bit() -> None:
    """The live session advances one sample at a time, a simulation all at once."""
    from vssea_core.channels import CHANNELS
    from vssea_core.simulation.closed_loop import ClosedLoop
    from vssea_core.simulation.run import prepare_scenario

    scenario = NOMINAL.model_copy(
        update={
            "tuning": TUNINGS["poles and bandwidth"],
            "stiffness_reference": MoveStiffness(stiffness=400.0, target=60.0, start_s=0.3, duration_s=0.3),
            "duration_s": 1.2,
        }
    )
    whole = simulate(scenario)
    loop = ClosedLoop(scenario, prepare_scenario(scenario))
    rows = np.empty((len(whole), len(CHANNELS)))
    for first, last in ((0, 1), (1, 2), (2, 333), (333, 334), (334, len(whole))):
        loop.advance(rows[first:last])
    assert np.array_equal(rows, whole.rows)
