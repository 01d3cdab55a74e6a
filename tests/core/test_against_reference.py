"""The compiled loop and the independent reference (12-state observer, matrix exponentials, DOP853) are the same experiment."""

import numpy as np
import pytest

from tests.core.as_reference import reference_config
from tests.reference.closed_loop import simulate as reference_simulate
from vssea_core.actuator.drive import CONTINUOUS, STIFFNESS_RATE, STIFFNESS_TORQUE
from vssea_core.actuator.parameters import Actuator, EquilibriumMotor, Link, Sensors, StiffnessMechanism, Timing
from vssea_core.actuator.sensors import encoders
from vssea_core.control.tuning import PositionObserver, SlidingMode, StiffnessLoop, Tuning, VelocityObserver
from vssea_core.scenario import Scenario
from vssea_core.scenarios import NOMINAL, REALISTIC
from vssea_core.signals.documents import (
    ConstantDisturbance,
    Disturbances,
    MoveReference,
    MoveStiffness,
    SineDisturbance,
    StepReference,
)
from vssea_core.simulation.run import simulate
from vssea_core.simulation.trajectory import Trajectory

WITHIN = 1e-7  # rad
EARLY_LOADS = Disturbances(
    link=(ConstantDisturbance(torque=3.0, start_s=0.1), SineDisturbance(start_s=0.2, end_s=0.8)),
    motor=(SineDisturbance(amplitude=4.0, frequency_hz=2.0, phase=1.0),),
)
SHORT = NOMINAL.model_copy(update={"duration_s": 1.0, "disturbances": EARLY_LOADS})
PRELOAD = Disturbances(link=(ConstantDisturbance(torque=5.0),))
FREE_SLEW = StiffnessLoop(torque_reserve=1e6)
SOFTENING = MoveStiffness(stiffness=600.0, target=200.0, start_s=0.1, duration_s=0.5)
UNDER_LOAD = {"stiffness_reference": SOFTENING, "disturbances": PRELOAD}


def varied(scenario: Scenario, **changes: object) -> Scenario:
    return scenario.model_copy(update=changes)


def tuned(**parts: object) -> Scenario:
    return varied(SHORT, tuning=Tuning().model_copy(update=parts))


VARIANTS: dict[str, Scenario] = {
    "sliding mode in a layer": tuned(controller=SlidingMode()),
    "sliding mode with sgn": tuned(controller=SlidingMode(switch="sgn", switching_gain=500.0)),
    "first-order hold": tuned(observer=VelocityObserver(discretisation="first_order_hold")),
    "encoder differences": varied(
        tuned(observer=VelocityObserver(velocity_source="difference", bandwidth=60.0)), sensors=REALISTIC.sensors
    ),
    "position form": tuned(observer=PositionObserver()),
    "one sample of delay": varied(SHORT, timing=Timing(compute_delay_samples=1)),
    "a heavier link than believed": varied(SHORT, actuator=Actuator(link=Link(inertia=0.12))),
    "torque-loop lag": varied(SHORT, actuator=Actuator(motor=EquilibriumMotor(torque_lag_s=1.6e-4))),
    "a saturating step": varied(SHORT, reference=StepReference(target=1.0, repeat=False, start_s=0.1)),
    "a move": varied(SHORT, reference=MoveReference(origin=0.1, repeat=False, start_s=0.1, duration_s=0.6)),
    "moving stiffness": varied(tuned(stiffness_loop=FREE_SLEW), **UNDER_LOAD),
    "moving stiffness, its rate alone known": varied(
        tuned(stiffness_loop=FREE_SLEW.model_copy(update={"terms": "rate"})), **UNDER_LOAD
    ),
    "moving stiffness, nothing of it known": varied(
        tuned(stiffness_loop=FREE_SLEW.model_copy(update={"terms": "none"})), **UNDER_LOAD
    ),
    "moving stiffness, position form": varied(
        tuned(stiffness_loop=FREE_SLEW, observer=PositionObserver()), sensors=REALISTIC.sensors, **UNDER_LOAD
    ),
    "back torque as printed": varied(
        SHORT, duration_s=0.02, actuator=Actuator(stiffness=StiffnessMechanism(back_torque="paper"))
    ),
}


def both(scenario: Scenario) -> tuple[Trajectory, dict[str, np.ndarray]]:
    """Run `scenario` here and in the reference; the reference knows neither I^2 t nor a slewed stiffness reference."""
    run = simulate(scenario)
    assert run.ending is None
    unknown = CONTINUOUS | STIFFNESS_RATE | STIFFNESS_TORQUE
    assert not np.any(run["limits"].astype(int) & unknown), "a limit acts that the reference lacks"
    return run, reference_simulate(reference_config(scenario))


def link_gap(run: Trajectory, reference: dict[str, np.ndarray]) -> np.ndarray:
    return np.abs(run["link_position"] - reference["state"][:, 0])


@pytest.mark.parametrize("scenario", VARIANTS.values(), ids=VARIANTS)
def test_every_variant_agrees_with_the_reference(scenario: Scenario) -> None:
    run, reference = both(scenario)
    assert link_gap(run, reference).max() < WITHIN
    assert np.abs(run["stiffness_motor_position"] - reference["state"][:, 4]).max() < 1e-6
    assert np.abs(run["motor_torque"] - reference["torque_applied"]).max() < 1e-3
    for channel, column in (("error", None), ("error_velocity", 1), ("error_acceleration", 2)):
        wanted = reference["tracking_error"] if column is None else reference["error"][:, column]
        assert np.allclose(run[channel], wanted, rtol=1e-5, atol=1e-4)


def test_nominal_agrees_with_the_reference_over_its_whole_length() -> None:
    run, reference = both(NOMINAL)
    assert run["time"][-1] == pytest.approx(9.999)
    assert link_gap(run, reference).max() < WITHIN


def test_realistic_behind_ideal_encoders_agrees_with_the_reference() -> None:
    run, reference = both(varied(REALISTIC, sensors=Sensors(velocities=False)))
    assert link_gap(run, reference).max() < WITHIN


def test_realistic_agrees_with_the_reference_until_rounding_turns_an_encoder_count() -> None:
    """Quantisers make two exact solutions part: within a count the stiffness motor floats, and rounding of 1e-15 grows to
    1e-7 of its 54 rad in some seconds; then one count turns a sample earlier. The load at 3 s lies before that."""
    run, reference = both(varied(REALISTIC, duration_s=4.0))
    resolution = np.array(encoders(REALISTIC.sensors, REALISTIC.actuator.motor))
    angles = np.column_stack([run["link_position"], run["motor_position"], run["stiffness_motor_position"]])
    differ = np.rint(angles / resolution) != np.rint(reference["state"][:, 0:6:2] / resolution)
    parted = int(np.argmax(differ.any(axis=1))) if differ.any() else len(run)
    assert parted > 3500
    gap = link_gap(run, reference)
    assert gap[:parted].max() < WITHIN
    assert gap.max() < resolution[0] / 2.0
