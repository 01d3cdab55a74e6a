"""The controller of a rig: what it promises of arming, braking, holding, missed cycles and numbers that are none."""

import math

import numpy as np
import pytest

from backend.loop.warm import compile_kernels
from tests.core.rig_bench import (
    LIMITS_OF_RIG,
    LINK,
    STIFFNESS_MOTOR,
    RigBench,
    bits_in,
    column,
    rig_scenario,
)
from vssea_core.channels import CHANNELS
from vssea_core.control.prepared import prepare
from vssea_core.control.tuning import VelocityObserver
from vssea_core.signals.documents import (
    ConstantDisturbance,
    Disturbances,
    JogReference,
    MoveReference,
    MoveStiffness,
    SineDisturbance,
    SineReference,
)
from vssea_core.tick import hardware
from vssea_core.tick.controller import BRAKING, CLOSED, READING, STIFFNESS_HOLDS, Controller

SPEED_L, SPEED_E, SPEED_MS = 1, 3, 5


def row() -> np.ndarray:
    return np.zeros((1, len(CHANNELS)))[0]


@pytest.mark.parametrize("stiffness", [200.0, 800.0])
def test_arming_on_a_preloaded_spring_begins_with_no_torque_and_moves_nothing(stiffness: float) -> None:
    bench = RigBench(rig_scenario(stiffness, link=(ConstantDisturbance(torque=4.0),)))  # dry friction holds the motor
    armed, rest = bench.arm()
    after, states = bench.run(500, CLOSED)
    torque = column(np.vstack([armed, after]), "motor_torque")
    assert abs(column(armed, "spring_torque")[0]) > 3.5, "the spring has to be preloaded"
    assert np.abs(torque[:2]).max() == 0.0
    assert np.abs(np.diff(torque)).max() < 6.0, "a zero estimate on a preloaded spring would kick by hundreds"
    assert np.abs(states[:, LINK] - rest[0, LINK]).max() < 2e-3  # smoothed dry friction alone creeps at 5 mrad/s
    assert "blended_in" in bits_in(armed)
    assert "blended_in" not in bits_in(after)


def test_arming_holds_the_measured_stiffness_within_the_range_of_the_rig() -> None:
    bench = RigBench(rig_scenario(300.0))
    bench.arm()
    assert bench.controller.scenario.stiffness_reference.stiffness == pytest.approx(300.0, rel=1e-4)
    _, states = bench.run(200, CLOSED)
    assert np.ptp(states[:, STIFFNESS_MOTOR]) < 0.01
    too_stiff = RigBench(rig_scenario(1000.0))
    too_stiff.arm()
    _, states = too_stiff.run(400, CLOSED)
    assert too_stiff.controller.scenario.stiffness_reference.stiffness == pytest.approx(900.0)
    assert states[-1, STIFFNESS_MOTOR] == pytest.approx(LIMITS_OF_RIG.theta_ms_stiff, abs=0.02)
    assert np.abs(states[:, SPEED_MS]).max() < 60.0, "it gets there by its slewed reference, not by a step"


def test_a_beginning_forgets_the_references_and_estimates_before_it() -> None:
    bench = RigBench(rig_scenario())
    bench.arm()
    bench.controller.set_reference(SineReference(amplitude=0.5, frequency_hz=0.5, fade_in_s=0.0))
    bench.run(200, CLOSED)
    bench.controller.set_reference(MoveReference(target=0.4))  # leaves a transition to be worked off
    bench.run(10, CLOSED)
    for axis in ("motor", "stiffness"):
        bench.rig.disarm(axis)
    bench.rig.jump_encoder("link", 0.5)
    bench.rig.jump_encoder("motor", 0.5)
    bench.sent = (0.0, 0.0)
    bench.run(2, READING)
    y = bench.measured
    bench.controller.begin(y.link_position, y.motor_position, y.stiffness_position)
    assert bench.controller.reference_now() == (y.link_position, 0.0, 0.0, 0.0, 0.0)
    rows, _ = bench.run(1, READING)
    assert column(rows, "link_velocity")[0] == 0.0
    assert column(rows, "link_disturbance_rate")[0] == 0.0
    assert column(rows, "link_disturbance_estimate")[0] == pytest.approx(column(rows, "spring_torque")[0], rel=1e-9)


def test_time_goes_on_over_a_beginning() -> None:
    bench = RigBench(rig_scenario())
    bench.arm()
    rows, _ = bench.run(3, CLOSED)
    assert np.allclose(column(rows, "time"), (56 + np.arange(3)) * 2e-3, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("stiffness", [25.0, 200.0, 900.0])
def test_braking_brings_the_motor_from_its_speed_limit_almost_to_rest_in_three_tenths_of_a_second(
    stiffness: float,
) -> None:
    bench = RigBench(rig_scenario(stiffness))
    bench.arm()
    bench.controller.set_reference(JogReference(velocity=2.5, acceleration=5.0))
    _, before = bench.run(500, CLOSED)
    rows, states = bench.run(250, BRAKING)
    assert before[-1, SPEED_E] > 2.3
    assert abs(states[150, SPEED_E]) < 0.1 * before[-1, SPEED_E]
    assert np.abs(column(rows, "motor_torque")[2:]).max() < 0.8 * LIMITS_OF_RIG.motor_torque
    assert np.ptp(states[:, STIFFNESS_MOTOR]) < 0.05


def test_braking_needs_no_model_and_no_observer() -> None:
    bench, wrong = (RigBench(rig_scenario()) for _ in range(2))
    model = rig_scenario().tuning.model.model_copy(update={"link_inertia": 1.0, "motor_inertia": 20.0})
    for each in (bench, wrong):
        each.arm()
        each.controller.set_reference(JogReference(velocity=1.0))
        each.run(600, CLOSED)
    wrong.install(rig_scenario().tuning.model_copy(update={"model": model}), 2)
    torques = [column(each.run(100, BRAKING)[0], "motor_torque") for each in (bench, wrong)]
    assert np.abs(torques[0]).max() > 10.0
    assert np.array_equal(*torques)


def test_braking_in_a_stiffness_move_halts_the_stiffness_motor_and_holds_it() -> None:
    bench = RigBench(rig_scenario(60.0))
    bench.arm()
    bench.controller.set_stiffness(MoveStiffness(stiffness=60.0, target=800.0, start_s=0.0, duration_s=0.3))
    _, moving = bench.run(75, CLOSED)
    _, states = bench.run(250, BRAKING)
    speed, travel = abs(moving[-1, SPEED_MS]), abs(states[-1, STIFFNESS_MOTOR] - moving[-1, STIFFNESS_MOTOR])
    assert speed > 100.0
    assert travel < 1.5 * speed / 40.0  # its filter comes to rest within v / bandwidth
    assert np.ptp(states[125:, STIFFNESS_MOTOR]) < 0.05
    _, held = bench.run(100, STIFFNESS_HOLDS)
    assert np.ptp(held[:, STIFFNESS_MOTOR]) < 0.05


def test_a_held_stiffness_carries_its_load_without_the_motor() -> None:
    bench = RigBench(rig_scenario(100.0, link=(ConstantDisturbance(torque=4.0),)))
    bench.rig.arm("stiffness")
    bench.run(6, READING)
    y = bench.measured
    bench.controller.begin(y.link_position, y.motor_position, y.stiffness_position)
    rows, states = bench.run(500, STIFFNESS_HOLDS)
    assert np.all(column(rows, "motor_torque") == 0.0)
    assert np.ptp(states[100:, STIFFNESS_MOTOR]) < 0.05


def test_reading_asks_for_no_torque_wherever_the_stiffness_motor_seems_to_be() -> None:
    controller = RigBench(rig_scenario()).controller
    for stiffness_position in (0.0, -40.0, 60.0, 1e4):
        filled = row()
        assert controller.tick(0.1, 0.12, stiffness_position, 0.0, 0.0, READING, 0.0, filled) == (0.0, 0.0)
        assert controller.finite
        assert filled[24] == stiffness_position


def test_holding_comes_to_rest_smoothly() -> None:
    bench = RigBench(rig_scenario())
    bench.arm()
    bench.controller.set_reference(JogReference(velocity=0.6))
    bench.run(750, CLOSED)
    before = bench.controller.reference_now()
    bench.controller.hold()
    after = bench.controller.reference_now()
    assert before.r1 == pytest.approx(0.6)
    assert np.allclose(before, after, rtol=0.0, atol=1e-9)
    bench.run(750, CLOSED)
    rested = bench.controller.reference_now()
    assert rested.r1 == pytest.approx(0.0, abs=1e-6)
    assert bench.measured.link_position == pytest.approx(rested.r, abs=1e-3)


def disturbance_of(missed: tuple[int, ...]) -> float:
    """Return by how much [rad] the link of a tracking rig leaves where it had been without missed cycles."""
    links = []
    for lost in ((), missed):
        bench = RigBench(rig_scenario())
        bench.arm()
        bench.controller.set_reference(SineReference(amplitude=0.5, frequency_hz=0.5))
        bench.run(1100, CLOSED)
        links.append(bench.run(400, CLOSED, missed=lost)[1][:, LINK])
    return float(np.abs(links[0] - links[1]).max())


def test_a_missed_cycle_moves_the_link_by_less_than_its_encoder_resolves() -> None:
    count = 2.0 * math.pi / 2**17
    assert 0.0 < disturbance_of((100,)) < count
    assert disturbance_of((100, 101)) < count
    assert disturbance_of(tuple(range(100, 103))) < 2.0 * count


def test_missed_cycles_hold_the_torques_and_go_on_in_time() -> None:
    bench = RigBench(rig_scenario())
    bench.arm()
    bench.controller.set_reference(JogReference(velocity=0.6))
    bench.run(150, CLOSED)
    held = bench.sent
    rows, states = bench.run(2, CLOSED, missed=(0, 1))
    assert bench.sent == held
    assert np.diff(column(rows, "time"))[0] == pytest.approx(2e-3)
    assert np.abs(column(rows, "link_position") - states[:, LINK]).max() < 1e-4


@pytest.mark.parametrize("position", range(3))
def test_a_measurement_that_is_no_number_gives_no_torque_and_says_so(position: int) -> None:
    bench = RigBench(rig_scenario())
    bench.arm()
    y = bench.measured
    places = [y.link_position, y.motor_position, y.stiffness_position]
    places[position] = math.nan
    assert bench.controller.tick(*places, 0.0, 0.0, CLOSED, 1.0, row()) == (0.0, 0.0)
    assert not bench.controller.finite
    bench.run(1, CLOSED)
    assert bench.controller.finite


def test_a_law_that_computes_no_number_gives_no_motor_torque_says_so_and_still_holds_the_stiffness() -> None:
    scenario = rig_scenario(100.0)
    prepared = prepare(scenario.tuning, 2e-3)
    bench = RigBench(scenario)
    bench.arm()
    bench.run(50, CLOSED)
    broken = np.where(prepared == scenario.tuning.model.link_damping, math.nan, prepared)
    assert np.isnan(broken).any()
    bench.controller.install(scenario.tuning, broken, 2)
    rows, states = bench.run(100, CLOSED)
    assert not bench.controller.finite
    assert np.all(column(rows, "motor_torque")[1:] == 0.0)
    assert np.ptp(states[:, STIFFNESS_MOTOR]) < 0.05


def test_a_torque_added_on_purpose_is_recorded_and_looks_like_a_disturbance_to_the_observer() -> None:
    bench = RigBench(rig_scenario())
    bench.arm()
    bench.controller.set_disturbances(
        Disturbances(
            link=(ConstantDisturbance(torque=50.0),),
            motor=(SineDisturbance(amplitude=5.0, frequency_hz=1.0),),
            stiffness_motor=(ConstantDisturbance(torque=0.05),),
        )
    )
    bench.run(300, CLOSED)
    rows, states = bench.run(500, CLOSED)
    added = column(rows, "motor_disturbance")
    gap = column(rows, "motor_disturbance_estimate") - added
    assert np.ptp(added) == pytest.approx(10.0, rel=0.01)
    assert np.abs(gap - gap.mean()).max() < 4.0 < np.ptp(added)  # friction as it creeps is the rest
    assert np.abs(states[:, LINK]).max() < 2e-3, "the loop holds against it, and no link torque came of it"
    assert column(rows, "stiffness_motor_disturbance")[-1] == pytest.approx(0.05)
    assert np.all(np.isnan(column(rows, "link_disturbance")))


def test_a_live_change_of_the_tuning_moves_no_more_torque_than_a_cycle_does_anyway() -> None:
    bench = RigBench(rig_scenario())
    bench.arm()
    bench.controller.set_reference(SineReference(amplitude=0.5, frequency_hz=0.25))
    before, _ = bench.run(1500, CLOSED)
    tuning = rig_scenario().tuning
    bench.install(tuning.model_copy(update={"observer": tuning.observer.model_copy(update={"bandwidth": 70.0})}), 2)
    after, _ = bench.run(2, CLOSED)
    usual = np.abs(np.diff(column(before, "motor_torque_demand")[-500:])).max()
    assert abs(column(after, "motor_torque_demand")[0] - column(before, "motor_torque_demand")[-1]) <= 1.5 * usual
    assert list(column(after, "tuning_id")) == [2.0, 2.0]


def test_a_tuning_that_needs_velocity_signals_is_refused() -> None:
    bench = RigBench(rig_scenario())
    tuning = rig_scenario().tuning.model_copy(update={"observer": VelocityObserver()})
    with pytest.raises(ValueError, match="velocity_source"):
        bench.install(tuning, 2)
    with pytest.raises(ValueError, match="velocity_source"):
        Controller(rig_scenario().model_copy(update={"tuning": tuning}), np.zeros(200), LIMITS_OF_RIG)


def test_a_session_compiles_nothing_that_was_not_compiled_before() -> None:
    compile_kernels()
    compiled = [len(kernel.signatures) for kernel in (hardware.tick, hardware.target_in_force)]
    bench = RigBench(rig_scenario())
    bench.arm()
    bench.controller.set_reference(MoveReference(target=0.2))
    bench.run(2, CLOSED, missed=(1,))
    bench.run(2, BRAKING)
    bench.controller.reference_now()
    assert [len(kernel.signatures) for kernel in (hardware.tick, hardware.target_in_force)] == compiled == [1, 1]
