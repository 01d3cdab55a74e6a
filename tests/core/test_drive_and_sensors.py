"""Limits of the drives, applied last and told by bits; encoders that round to whole counts."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vssea_core.actuator import drive
from vssea_core.actuator.dynamics import PlantState
from vssea_core.actuator.parameters import Actuator, EquilibriumMotor, Sensors, StiffnessMechanism
from vssea_core.actuator.sensors import Noise, encoders, measure, quantised
from vssea_core.channels import LIMITS
from vssea_core.scenario import Scenario
from vssea_core.scenarios import NOMINAL, REALISTIC
from vssea_core.signals.documents import (
    ConstantDisturbance,
    ConstantStiffness,
    Disturbances,
    MoveStiffness,
    StepReference,
)
from vssea_core.simulation.metrics import limit_shares
from vssea_core.simulation.run import simulate
from vssea_core.simulation.state import drive_numbers
from vssea_core.tick import bounds

T = 1e-3
DRIVES = drive_numbers(Actuator(), T)
COLD = drive.Heat(0.0, 0.0)
torques, speeds = st.floats(-1e4, 1e4), st.floats(-10.0, 10.0)
heats = st.builds(drive.Heat, st.floats(0.0, 6000.0), st.floats(0.0, 0.7))


@given(heat=heats, torque=torques, speed=speeds)
@settings(deadline=None, max_examples=100)
def test_the_motor_never_gets_more_than_every_limit_allows(heat: drive.Heat, torque: float, speed: float) -> None:
    given_torque, limit, bits = drive.limit_motor_torque(DRIVES, heat, torque, speed)
    assert abs(given_torque) <= min(limit, DRIVES.peak_torque)
    if given_torque * speed > 0.0:
        line = DRIVES.stall_torque - DRIVES.torque_per_speed * abs(speed)
        assert abs(given_torque) <= max(0.0, line) * (1.0 + 1e-12)
    assert given_torque * torque >= 0.0, "a limit never turns a torque round"
    assert (bits == 0) == (given_torque == torque)


@given(heat=heats, torque=st.floats(-5.0, 5.0), speed=st.floats(-600.0, 600.0))
@settings(deadline=None, max_examples=100)
def test_the_stiffness_motor_never_gets_more_than_its_limits_allow(
    heat: drive.Heat, torque: float, speed: float
) -> None:
    given_torque, bits = drive.limit_stiffness_torque(DRIVES, heat, torque, speed)
    assert abs(given_torque) <= DRIVES.stiffness_peak_torque
    if torque * speed > 0.0 and abs(speed) > DRIVES.stiffness_speed:
        assert given_torque == 0.0
    assert (bits == 0) == (given_torque == torque)


@pytest.mark.parametrize(
    ("heat", "torque", "speed", "bit"),
    [
        (COLD, 20.0, 1.0, 0),
        (COLD, 90.0, 0.0, drive.PEAK),
        (drive.Heat(620.0, 0.0), 70.0, 0.0, drive.CONTINUOUS),
        (COLD, 60.0, 3.0, drive.SPEED),
        (COLD, -60.0, 3.0, 0),
        (COLD, 10.0, 5.0, drive.SPEED),
    ],
)
def test_the_bits_say_which_limit_held_the_torque_back(heat: drive.Heat, torque: float, speed: float, bit: int) -> None:
    assert drive.limit_motor_torque(DRIVES, heat, torque, speed)[2] == bit


@pytest.mark.parametrize("demand", [30.0, 74.0])
def test_under_a_lasting_demand_the_torque_settles_at_the_continuous_torque(demand: float) -> None:
    drives = DRIVES._replace(thermal_decay=np.exp(-T / 0.5))
    heat, torque, course = COLD, 0.0, []
    for _ in range(10_000):
        torque, _, bits = drive.limit_motor_torque(drives, heat, demand, 0.0)
        heat = drive.Heat(*drive.warmed(drives, heat, torque, 0.0))
        course.append(torque)
    assert course[0] == demand
    assert bits == drive.CONTINUOUS
    assert torque == pytest.approx(DRIVES.continuous_torque, rel=0.02)
    assert np.all(np.diff(course) <= 1e-9), "it folds back without hunting"
    assert heat.motor <= DRIVES.continuous_torque**2 * (1.0 + 1e-9)


def test_equal_continuous_and_peak_torque_switch_the_thermal_limit_off() -> None:
    drives = DRIVES._replace(continuous_torque=DRIVES.peak_torque)
    assert drive.limit_motor_torque(drives, drive.Heat(1e9, 0.0), 74.0, 0.0) == (74.0, 74.0, 0)


def shares(**changes: object) -> dict[str, float]:
    return limit_shares(simulate(NOMINAL.model_copy(update={"duration_s": 1.5} | changes)).rows)


LOADED = {"disturbances": Disturbances(link=(ConstantDisturbance(torque=18.0),))}
PROVOKED: dict[str, dict[str, object]] = {
    "motor_peak_torque": {"reference": StepReference(target=2.0, start_s=0.1)},
    "motor_continuous_torque": {
        "actuator": Actuator(motor=EquilibriumMotor(continuous_torque=10.0, thermal_time_s=0.1))
    }
    | LOADED,
    "motor_speed": {"reference": StepReference(target=2.0, start_s=0.1)},
    "stiffness_motor_torque": {
        "actuator": Actuator(stiffness=StiffnessMechanism(peak_torque=0.05, continuous_torque=0.05))
    }
    | {"stiffness_reference": MoveStiffness(start_s=0.1, target=800.0)},
    "stiffness_motor_speed": {
        "actuator": Actuator(stiffness=StiffnessMechanism(back_torque="paper", peak_torque=50.0)),
        "disturbances": Disturbances(link=(ConstantDisturbance(torque=8.0, start_s=0.1),)),
    },
    "leaf_torque": {"disturbances": Disturbances(link=(ConstantDisturbance(torque=22.0),))},
    "stiffness_rate": {"stiffness_reference": MoveStiffness(start_s=0.1, target=900.0, duration_s=0.1)},
    "stiffness_end_stop": {"stiffness_reference": ConstantStiffness(stiffness=1000.0)},
}


@pytest.mark.parametrize("limit", [limit.name for limit in LIMITS if limit.bit < bounds.RIG_TORQUE])
def test_every_limit_is_reported_when_it_acts_and_not_in_a_calm_run(limit: str) -> None:
    assert limit not in shares()
    assert shares(**PROVOKED[limit])[limit] > 0.0


def test_each_limits_bit_is_the_one_the_kernel_sets() -> None:
    bits = {limit.name: limit.bit for limit in LIMITS}
    assert list(bits.values()) == [
        drive.PEAK, drive.CONTINUOUS, drive.SPEED, drive.STIFFNESS_TORQUE, drive.STIFFNESS_SPEED, drive.LEAF_TORQUE,
        drive.STIFFNESS_RATE, drive.END_STOP, bounds.RIG_TORQUE, bounds.RIG_RATE, bounds.RIG_SPEED, bounds.RIG_POSITION,
        bounds.RIG_DEFLECTION, bounds.RIG_STIFFNESS, bounds.BLENDED,
    ]  # fmt: skip


def test_the_applied_torque_of_a_hard_run_stays_below_its_limit() -> None:
    run = simulate(NOMINAL.model_copy(update={"reference": StepReference(target=3.0), "duration_s": 4.0}))
    assert np.all(np.abs(run["motor_torque"]) <= run["motor_torque_limit"] + 1e-12)
    assert np.all(np.abs(run["motor_torque"]) <= 74.0)
    assert np.any(run["limits"] != 0.0)


@given(angle=st.floats(-100.0, 100.0), resolution=st.floats(1e-7, 0.1))
@settings(deadline=None, max_examples=100)
def test_an_encoder_is_within_half_a_count_and_on_a_whole_one(angle: float, resolution: float) -> None:
    read = quantised(angle, resolution)
    assert abs(read - angle) <= 0.5 * resolution * (1.0 + 1e-6)
    assert read / resolution == pytest.approx(round(read / resolution), abs=1e-6)


def test_an_ideal_encoder_reads_the_angle_itself() -> None:
    state = PlantState(0.123456789, 1.0, -0.3, 2.0, 53.7, 3.0, 0.0)
    assert tuple(measure(encoders(Sensors(), EquilibriumMotor()), Noise(), state, 7)) == (
        0.123456789,
        -0.3,
        53.7,
        1.0,
        2.0,
        3.0,
    )


def test_the_motors_encoder_sits_before_the_gear() -> None:
    sizes = encoders(REALISTIC.sensors, EquilibriumMotor())
    assert sizes.link == pytest.approx(2.0 * np.pi / 2**17)
    assert sizes.motor == pytest.approx(2.0 * np.pi / (16384 * 100))
    assert sizes.stiffness_motor == pytest.approx(2.0 * np.pi / 16384)


def test_the_loop_only_sees_whole_counts() -> None:
    """Behind encoders of 8 bits the error that the law works on differs from the true one by up to half a count."""
    coarse = Sensors(link_bits=8, velocities=False)
    scenario = REALISTIC.model_copy(update={"sensors": coarse, "duration_s": 1.0})
    fine = Scenario(**(dict(scenario) | {"sensors": Sensors(velocities=False)}))
    rough, smooth = (simulate(each)["motor_torque_demand"] for each in (scenario, fine))
    assert np.abs(np.diff(rough)).max() > 100.0 * np.abs(np.diff(smooth)).max()
