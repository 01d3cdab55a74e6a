"""The limits of a rig are laws: no demand, state or history gets a torque past them."""

import math
from itertools import pairwise

import numba
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba.np.unsafe.ndarray import to_fixed_tuple

from backend.rigs.rig import AXES
from backend.rigs.simulated import SimulatedRig
from tests.core.rig_bench import LIMITS_OF_RIG, LINK, MOTOR, STIFFNESS_MOTOR, RigBench, bits_in, column, rig_scenario
from vssea_core.actuator.drive import Drives, Heat
from vssea_core.actuator.spring import leaf
from vssea_core.channels import LIMITS
from vssea_core.scenario import Scenario
from vssea_core.signals.documents import (
    ConstantDisturbance,
    ConstantStiffness,
    ContactDisturbance,
    Disturbances,
    JogReference,
    Reference,
    StiffnessReference,
)
from vssea_core.simulation.state import DRIVES_SIZE, drive_numbers
from vssea_core.tick.bounds import (
    BLENDED,
    BOUNDS_SIZE,
    RIG_RATE,
    RIG_SPEED,
    RIG_TORQUE,
    STIFFNESS_SLACK,
    Bounds,
    bounds_row,
)
from vssea_core.tick.controller import CLOSED, RigLimits
from vssea_core.tick.limits import Motion, limit_brake, limit_motor, limit_stiffness

PERIOD = 2e-3
SPEED_E, SPEED_MS = 3, 5
STEP = LIMITS_OF_RIG.motor_torque_rate * PERIOD
ACTUATOR = rig_scenario().actuator
BOUNDS = bounds_row(LIMITS_OF_RIG, ACTUATOR, PERIOD)
DRIVES = np.array(drive_numbers(ACTUATOR, PERIOD))


@numba.njit(error_model="numpy")
def motion_of(bounds, places, speeds, sag):
    spring = leaf(places[1] - places[0], places[2])
    scale = bounds.spring_constant
    return Motion(*places, *speeds, scale * spring.torque, scale * spring.back, scale * spring.stiffness, sag)


@numba.njit(error_model="numpy")
def limited(bounds_row, drives_row, places, speeds, sag, heat, torque, before):
    """Return what motor, brake and stiffness motor are given of `torque`."""
    bounds = Bounds(*to_fixed_tuple(bounds_row, BOUNDS_SIZE))
    drives = Drives(*to_fixed_tuple(drives_row, DRIVES_SIZE))
    motion = motion_of(bounds, places, speeds, sag)
    hot = Heat(heat, 0.0)
    motor = limit_motor(bounds, drives, hot, motion, torque, before)
    brake = limit_brake(bounds, drives, hot, torque, before)
    stiffness = limit_stiffness(bounds, drives, hot, motion, torque)
    return motor, brake, stiffness


def motor_at(
    torque: float, link: float = 0.0, deflection: float = 0.0, speed: float = 0.0, before: float | None = None
):
    """Return motor torque and bits in a state of a rig whose motor and link move alike."""
    before = torque if before is None else before
    places, speeds = (link, link + deflection, 53.7), (speed, speed, 0.0)
    given_torque, _, bits = limited(BOUNDS, DRIVES, places, speeds, deflection, 0.0, torque, before)[0]
    return given_torque, bits


wide = st.floats(-1e6, 1e6)
places = st.tuples(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0), st.floats(25.0, 130.0))
speeds = st.tuples(st.floats(-20.0, 20.0), st.floats(-20.0, 20.0), st.floats(-900.0, 900.0))
earlier = st.floats(-LIMITS_OF_RIG.motor_torque, LIMITS_OF_RIG.motor_torque)
heats = st.floats(0.0, 5000.0)


@settings(max_examples=400)
@given(places=places, speeds=speeds, sag=st.floats(-1.0, 1.0), heat=heats, torque=wide, before=earlier)
def test_no_torque_is_ever_above_the_limit_or_grows_beyond_its_rate(places, speeds, sag, heat, torque, before) -> None:
    motor, brake, stiffness = limited(BOUNDS, DRIVES, places, speeds, sag, heat, torque, before)
    for given_torque, _, _ in (motor, brake):
        assert abs(given_torque) <= LIMITS_OF_RIG.motor_torque
        grown = abs(given_torque) - (abs(before) if given_torque * before >= 0.0 else 0.0)
        assert grown <= STEP * (1.0 + 1e-12)
    assert abs(stiffness[0]) <= LIMITS_OF_RIG.stiffness_torque
    hot = ACTUATOR.motor.continuous_torque
    if heat >= hot**2:
        assert abs(motor[0]) <= hot
        assert abs(brake[0]) <= hot


@settings(max_examples=400)
@given(places=places, speeds=speeds, sag=st.floats(-1.0, 1.0), torque=wide, before=earlier)
def test_what_was_limited_is_told_by_a_bit(places, speeds, sag, torque, before) -> None:
    motor, brake, stiffness = limited(BOUNDS, DRIVES, places, speeds, sag, 0.0, torque, before)
    for given_torque, bits in ((motor[0], motor[2]), (brake[0], brake[2]), stiffness):
        assert bits != 0 or given_torque == torque


@settings(max_examples=200)
@given(places=places, speeds=speeds, torque=wide, before=earlier)
def test_limits_know_no_direction(places, speeds, torque, before) -> None:
    (link, motor, theta_ms), (omega_l, omega_e, omega_ms) = places, speeds
    one = limited(BOUNDS, DRIVES, places, speeds, 0.1, 0.0, torque, before)[0]
    other = limited(
        BOUNDS, DRIVES, (-link, -motor, theta_ms), (-omega_l, -omega_e, omega_ms), -0.1, 0.0, -torque, -before
    )[0]
    if omega_e != 0.0:
        assert other[0] == pytest.approx(-one[0], abs=1e-9)
        assert other[2] == one[2]


@settings(max_examples=200)
@given(deflection=st.floats(-0.15, 0.15), link=st.floats(-1.0, 1.0), speed=st.floats(-2.0, 2.0))
def test_what_holds_a_preloaded_spring_below_the_speed_limit_is_left_alone(deflection, link, speed) -> None:
    spring = ACTUATOR.stiffness.spring_constant * math.sin(deflection / 2.0) / 53.7**3
    assert motor_at(spring, link, deflection, speed) == (pytest.approx(spring, abs=0.0), 0)


def test_driving_torque_fades_towards_the_speed_limit_and_becomes_braking_beyond_it() -> None:
    torques = [motor_at(60.0, speed=speed, before=60.0)[0] for speed in (0.0, 2.0, 2.6, 2.8, 2.95, 3.0, 3.2)]
    assert torques[0] == torques[1] == 60.0
    assert all(a > b for a, b in pairwise(torques[2:]))
    assert torques[5] == pytest.approx(0.0, abs=1e-9)
    assert torques[6] < -20.0
    assert motor_at(60.0, speed=2.95, before=60.0)[1] & RIG_SPEED


def test_the_rate_holds_back_both_a_rise_and_a_fall() -> None:
    assert motor_at(60.0, before=0.0) == (pytest.approx(STEP), RIG_RATE)
    assert motor_at(0.0, before=60.0) == (pytest.approx(60.0 - STEP), RIG_RATE)
    assert motor_at(71.0, before=60.0)[1] & RIG_TORQUE


def pushed(scenario: Scenario, limits: RigLimits, motor: float, stiffness: float, time_s: float) -> np.ndarray:
    """Return the true states of a rig while motor and stiffness motor are pushed with constant demands [N m]."""
    period = scenario.timing.sample_time_s
    row, drives = bounds_row(limits, scenario.actuator, period), np.array(drive_numbers(scenario.actuator, period))
    bounds = Bounds(*row)
    rig = SimulatedRig(scenario)
    rig.configure()
    for axis in AXES:
        rig.arm(axis)
    for _ in range(6):
        rig.exchange(0.0, 0.0)
    torque = stiffness_torque = sag = 0.0
    last, speeds, states = None, [0.0, 0.0, 0.0], []
    for _ in range(round(time_s / period)):
        y = rig.exchange(torque, stiffness_torque)
        at = (y.link_position, y.motor_position, y.stiffness_position)
        if last is not None:
            keep, gain = bounds.difference_keep, bounds.difference_gain
            speeds = [keep * w + gain * (a - b) for w, a, b in zip(speeds, at, last, strict=True)]
        last = at
        sag += bounds.sag_gain * (at[1] - at[0] - sag)
        (torque, _, _), _, _ = limited(row, drives, at, tuple(speeds), sag, 0.0, motor, torque)
        _, _, (stiffness_torque, _) = limited(row, drives, at, tuple(speeds), sag, 0.0, stiffness, torque)
        states.append(rig.plant)
    return np.array(states)


@pytest.mark.parametrize("push", [70.0, -70.0])
@pytest.mark.parametrize("stiffness", [25.0, 200.0, 900.0])
@pytest.mark.parametrize("sample_time_s", [1e-3, 2e-3, 4e-3])
def test_a_demand_that_never_ceases_to_push_takes_neither_link_nor_motor_past_the_position_limit(
    push: float, stiffness: float, sample_time_s: float
) -> None:
    states = pushed(rig_scenario(stiffness, sample_time_s), LIMITS_OF_RIG, push, 0.0, 2.5)
    for inertia in (LINK, MOTOR):
        farthest = np.abs(states[:, inertia]).max()
        assert farthest < LIMITS_OF_RIG.link_high
        assert farthest > LIMITS_OF_RIG.link_high - 0.15, "and it does get near"
    assert 2.5 < np.abs(states[:, SPEED_E]).max() < LIMITS_OF_RIG.motor_speed
    assert np.abs(states[-50:, SPEED_E]).max() < 0.1, "it comes to rest there"


@pytest.mark.parametrize(("push", "stiffness"), [(0.75, 100.0), (-0.75, 100.0), (-0.75, 600.0), (0.75, 30.0)])
def test_a_demand_that_never_ceases_to_push_keeps_the_stiffness_motor_within_its_range_and_speed(
    push: float, stiffness: float
) -> None:
    states = pushed(rig_scenario(stiffness), LIMITS_OF_RIG, 0.0, push, 1.5)
    theta = states[:, STIFFNESS_MOTOR]
    slack = STIFFNESS_SLACK * (LIMITS_OF_RIG.theta_ms_soft - LIMITS_OF_RIG.theta_ms_stiff)
    assert LIMITS_OF_RIG.theta_ms_stiff - slack - 0.005 < theta.min()  # a dozen counts
    assert theta.max() < LIMITS_OF_RIG.theta_ms_soft + slack + 0.005
    border = LIMITS_OF_RIG.theta_ms_soft if push > 0.0 else LIMITS_OF_RIG.theta_ms_stiff
    assert theta[-1] == pytest.approx(border, abs=0.3)
    assert np.abs(states[:, SPEED_MS]).max() < 1.01 * LIMITS_OF_RIG.stiffness_speed


@pytest.mark.parametrize("stiffness", [50.0, 200.0, 800.0])
def test_a_loop_that_pushes_the_link_into_a_wall_deflects_the_spring_no_farther_than_its_limit(
    stiffness: float,
) -> None:
    wall = ContactDisturbance(stiffness=2e4, damping=50.0, position=0.1, side="above")
    limits = LIMITS_OF_RIG._replace(deflection=0.08)
    bench = RigBench(rig_scenario(stiffness, link=(wall,)), limits)
    bench.arm()
    bench.controller.set_reference(JogReference(velocity=0.3))
    rows, states = bench.run(1000, CLOSED)
    deflection = states[:, MOTOR] - states[:, LINK]
    assert 0.075 < np.abs(deflection).max() < 0.08
    assert "rig_deflection" in bits_in(rows)


def test_a_loop_that_is_jogged_past_the_limit_stays_inside_and_says_so() -> None:
    bench = RigBench(rig_scenario())
    bench.arm()
    bench.controller.set_reference(JogReference(velocity=0.8))
    rows, states = bench.run(1300, CLOSED)
    assert column(rows, "reference")[-1] > LIMITS_OF_RIG.link_high + 0.1
    assert np.abs(states[:, [LINK, MOTOR]]).max() < LIMITS_OF_RIG.link_high
    assert "rig_position" in bits_in(rows)
    bench.controller.set_reference(JogReference(velocity=-0.8))
    _, states = bench.run(1300, CLOSED)
    assert states[-1, LINK] < 1.0, "away from the border it is free"


def test_a_commanded_stiffness_outside_the_range_of_the_rig_stops_at_its_border_and_says_so() -> None:
    bench = RigBench(rig_scenario())
    bench.arm()
    for asked, border in ((1000.0, 900.0), (20.0, 25.0)):
        bench.controller.set_stiffness(ConstantStiffness(stiffness=asked))
        rows, states = bench.run(800, CLOSED)
        assert column(rows, "stiffness")[-1] == pytest.approx(border, rel=2e-3)
        assert "rig_stiffness" in bits_in(rows)
        assert np.abs(states[:, SPEED_MS]).max() < 1.01 * LIMITS_OF_RIG.stiffness_speed
    bench.controller.set_stiffness(ConstantStiffness(stiffness=100.0))
    rows, _ = bench.run(800, CLOSED)
    assert "rig_stiffness" not in bits_in(rows[-100:])


PROVOKED: dict[str, tuple[dict[str, float], Reference | StiffnessReference]] = {
    "rig_torque": ({"motor_torque": 3.0}, JogReference(velocity=0.5)),
    "rig_torque_rate": ({"motor_torque_rate": 60.0}, JogReference(velocity=0.5)),
    "rig_speed": ({"motor_speed": 0.3}, JogReference(velocity=0.5)),
    "rig_position": ({"link_high": 0.2}, JogReference(velocity=0.5)),
    "rig_deflection": ({"deflection": 0.01}, JogReference(velocity=0.5)),
    "rig_stiffness": ({}, ConstantStiffness(stiffness=950.0)),
}


@pytest.mark.parametrize("limit", [limit.name for limit in LIMITS if RIG_TORQUE <= limit.bit < BLENDED])
def test_every_limit_of_a_rig_is_reported_when_it_acts_and_not_in_a_calm_run(limit: str) -> None:
    narrower, asked = PROVOKED[limit]
    calm, bench = RigBench(rig_scenario()), RigBench(rig_scenario(), LIMITS_OF_RIG._replace(**narrower))
    for each in (calm, bench):
        each.arm()
    bench.rig.set_disturbances(Disturbances(link=(ConstantDisturbance(torque=4.0, start_s=0.6),)))
    calm.controller.set_reference(JogReference(velocity=0.5))
    change = bench.controller.set_stiffness if limit == "rig_stiffness" else bench.controller.set_reference
    change(asked)
    assert limit not in bits_in(calm.run(500, CLOSED)[0])
    assert limit in bits_in(bench.run(500, CLOSED)[0])


def test_a_motor_that_is_asked_too_much_for_too_long_is_taken_back_to_its_continuous_torque() -> None:
    motor = ACTUATOR.motor.model_copy(update={"thermal_time_s": 0.5, "continuous_torque": 10.0})
    scenario = rig_scenario().model_copy(update={"actuator": ACTUATOR.model_copy(update={"motor": motor})})
    bench = RigBench(scenario)
    bench.arm()
    bench.rig.set_disturbances(Disturbances(link=(ConstantDisturbance(torque=15.0, start_s=0.0),)))
    rows, _ = bench.run(1500, CLOSED)
    assert "motor_continuous_torque" in bits_in(rows)
    assert np.abs(column(rows, "motor_torque")[-200:]).max() <= 10.5
    assert np.abs(column(rows, "motor_torque")).max() > 15.0
