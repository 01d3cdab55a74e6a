"""The simulated rig: the same plant as in simulation, drives that obey, and everything that can be broken on purpose."""

import numpy as np
import pytest

from backend.rigs.faults import CONFIGURATION, REBOOTED
from backend.rigs.rig import AXES, Axis, RigError
from backend.rigs.simulated import DEADLINE_CYCLES, ENABLING_CYCLES, PARTS, Part, SimulatedRig
from tests.core.rig_bench import NEVER_REACHED, RigBench, column, rig_scenario
from vssea_core.actuator.spring import stiffness_motor_position
from vssea_core.control.prepared import prepare
from vssea_core.control.tuning import PositionObserver, Schedule, SlidingMode, StateFeedback
from vssea_core.scenario import Scenario
from vssea_core.scenarios import REALISTIC
from vssea_core.signals.documents import (
    ConstantDisturbance,
    Disturbances,
    MoveReference,
    MoveStiffness,
    NoiseDisturbance,
)
from vssea_core.simulation.closed_loop import ClosedLoop
from vssea_core.simulation.plan import PreparedRun
from vssea_core.simulation.state import PENDING, equilibrium_state
from vssea_core.tick.controller import CLOSED

KNOWN_TO_BOTH = (
    "time", "reference", "error_velocity", "error_acceleration", "error_jerk", "sliding_variable", "snap",
    "motor_torque_demand", "motor_torque", "motor_torque_limit", "link_disturbance_estimate",
    "motor_disturbance_estimate", "link_disturbance_rate", "link_disturbance_acceleration", "motor_disturbance_rate",
    "stiffness_reference", "stiffness_motor_torque", "limits", "tuning_id",
)  # fmt: skip
SAMPLES = 3000


def with_tuning(**changes: object) -> Scenario:
    scenario = REALISTIC.model_copy(
        update={"stiffness_reference": MoveStiffness(stiffness=120.0, target=500.0, start_s=0.8, duration_s=0.5)}
    )
    return scenario.model_copy(update={"tuning": scenario.tuning.model_copy(update=changes)})


SCENARIOS = {
    "realistic": REALISTIC,
    "stiffness move, predicting": with_tuning(observer=PositionObserver(bandwidth=100.0, predict=True)),
    "gains that follow the stiffness": with_tuning(
        schedule=Schedule(poles_exponent=0.2, bandwidth_exponent=0.35), observer=PositionObserver(bandwidth=90.0)
    ),
    "super-twisting": with_tuning(controller=SlidingMode(switch="super_twisting")),
    "late torque": REALISTIC.model_copy(
        update={
            "actuator": REALISTIC.actuator.model_copy(
                update={"motor": REALISTIC.actuator.motor.model_copy(update={"torque_delay_s": 6e-4})}
            ),
            "disturbances": Disturbances(link=(NoiseDisturbance(rms=0.5, start_s=0.2),)),
        }
    ),
}


@pytest.mark.parametrize("scenario", SCENARIOS.values(), ids=SCENARIOS)
def test_a_controller_on_the_simulated_rig_equals_the_simulation_to_the_bit_through_live_changes(
    scenario: Scenario,
) -> None:
    bench = RigBench(scenario, NEVER_REACHED)
    for drive in bench.rig._drives.values():
        drive.state = "enabled"  # the simulation's are, from t = 0 on
    bench.sent = tuple(equilibrium_state(scenario)[PENDING : PENDING + 2].tolist())
    loop = ClosedLoop(scenario, PreparedRun(prepare(scenario.tuning, bench.period)))
    expected = np.zeros((SAMPLES, 32))
    parts = []

    def go_on(until: int) -> None:
        done = sum(map(len, parts))
        loop.advance(expected[done:until])
        parts.append(bench.run(until - done, CLOSED)[0])

    go_on(1000)
    other = scenario.tuning.model_copy(update={"controller": StateFeedback(natural_frequency=17.0)})
    loop.install(other, prepare(other, bench.period), 9)
    bench.install(other, 9)
    go_on(1800)
    reference = MoveReference(target=0.4, duration_s=0.9, repeat=False)
    loop.set_reference(reference)
    bench.controller.set_reference(reference)
    go_on(2300)
    stiffness = MoveStiffness(stiffness=300.0, target=150.0, start_s=0.1, duration_s=0.4)
    loop.set_stiffness(stiffness)
    bench.controller.set_stiffness(stiffness)
    go_on(SAMPLES)
    rows = np.vstack(parts)
    for name in KNOWN_TO_BOTH:
        assert np.array_equal(column(rows, name), column(expected, name)), name
    assert np.ptp(column(rows, "motor_torque")) > 1.0
    for name, most in (("link_position", 3e-5), ("motor_position", 3e-6), ("stiffness_motor_position", 3e-4)):
        assert np.abs(column(rows, name) - column(expected, name)).max() < most, "measured: to the encoder's count"


def rig(**options: float) -> SimulatedRig:
    made = SimulatedRig(rig_scenario(), **options)
    made.connect()
    made.configure()
    return made


def enabled() -> SimulatedRig:
    made = rig()
    for axis in AXES:
        made.arm(axis)
    for _ in range(ENABLING_CYCLES):
        made.exchange(0.0, 0.0)
    return made


def test_it_says_that_it_is_a_simulation() -> None:
    assert rig().identify().kind == "simulated"


def test_there_is_no_exchange_before_it_is_configured() -> None:
    with pytest.raises(RigError) as refused:
        SimulatedRig(rig_scenario()).exchange(0.0, 0.0)
    assert refused.value.fault is CONFIGURATION


@pytest.mark.parametrize("axis", AXES)
def test_an_axis_gives_torque_only_once_it_is_enabled_which_takes_a_few_cycles(axis: Axis) -> None:
    made = rig()
    assert made.axis(axis).state == "disabled"
    made.exchange(5.0, 0.1)
    assert made.given == (0.0, 0.0)
    made.arm(axis)
    states = []
    for _ in range(ENABLING_CYCLES):
        y = made.exchange(5.0, 0.1)
        states.append(made.axis(axis).state)
    assert states == ["enabling"] * (ENABLING_CYCLES - 1) + ["enabled"]
    assert made.given == ((5.0, 0.0) if axis == "motor" else (0.0, 0.1))
    assert (y.motor_torque, y.stiffness_torque) == made.given
    made.disarm(axis)
    made.exchange(5.0, 0.1)
    assert made.given == (0.0, 0.0)


def test_a_torque_beyond_the_peak_or_no_number_is_not_given() -> None:
    made = enabled()
    made.exchange(1e4, -1e4)
    assert made.given == (74.0, -0.79)
    made.exchange(float("nan"), float("nan"))
    assert made.given == (74.0, -0.79), "what is no number is not taken over"


def test_the_motor_halts_by_itself_when_it_is_told_to_stop() -> None:
    made = enabled()
    for _ in range(100):
        made.exchange(40.0, 0.0)
    fast = made.plant.omega_e
    made.stop("motor")
    for _ in range(100):
        made.exchange(40.0, 0.0)
    assert fast > 1.0
    assert abs(made.plant.omega_e) < 0.02
    assert made.axis("motor").state == "stopping"
    made.arm("motor")
    made.exchange(40.0, 0.0)
    assert made.axis("motor").state == "enabling", "a stop is left by arming, as a drive's quick stop is"


def test_the_stiffness_motor_halts_where_it_is_and_holds_its_load() -> None:
    made = SimulatedRig(rig_scenario(100.0, link=(ConstantDisturbance(torque=5.0),)))
    made.configure()
    made.arm("stiffness")
    for _ in range(ENABLING_CYCLES):
        made.exchange(0.0, 0.0)
    for _ in range(10):
        made.exchange(0.0, 0.3)
    at = made.plant.theta_ms
    made.stop("stiffness")
    for _ in range(200):
        made.exchange(0.0, 0.3)
    assert abs(made.plant.omega_ms) < 0.5
    assert abs(made.plant.theta_ms - at) < 2.0


def test_a_faulted_drive_gives_no_torque_is_not_armed_and_is_reset_only_once_its_cause_is_gone() -> None:
    made = enabled()
    made.fault_drive("motor", 0x4310, "over-temperature")
    made.exchange(5.0, 0.1)
    status = made.axis("motor")
    assert (status.state, status.error_code, status.error_words) == ("fault", 0x4310, "over-temperature")
    assert made.given == (0.0, 0.1)
    made.arm("motor")
    made.reset("motor")
    assert made.axis("motor").state == "fault"
    made.mend()
    made.arm("motor")
    assert made.axis("motor").state == "fault", "arming does not leave a fault"
    made.reset("motor")
    assert made.axis("motor").state == "disabled"
    assert made.axis("motor").error_code == 0


@pytest.mark.parametrize("part", PARTS)
def test_a_silent_nodes_values_grow_old_one_by_one(part: Part) -> None:
    made = enabled()
    made.silence(part)
    ages = []
    for _ in range(3):
        y = made.exchange(20.0, 0.1)
        ages.append((y.link_age, y.motor_age, y.stiffness_age)[PARTS.index(part)])
        assert sum((y.link_age, y.motor_age, y.stiffness_age)) == ages[-1]
    assert ages == [1, 2, 3]
    assert made.given == (20.0, 0.1), "a silent drive still hears"
    made.mend()
    assert made.exchange(0.0, 0.0)[3:6] == (0, 0, 0)
    assert made.health().late_answers == 3


def test_on_a_cut_bus_the_drives_hold_what_they_have_until_their_deadline_and_then_stop() -> None:
    made = enabled()
    made.exchange(20.0, 0.0)
    made.cut_bus()
    given = []
    for _ in range(DEADLINE_CYCLES + 1):
        y = made.exchange(-50.0, 0.5)
        given.append(made.given[0])
        assert made.axis("motor").state == "unknown"
    assert given[: DEADLINE_CYCLES - 1] == [20.0] * (DEADLINE_CYCLES - 1)
    assert given[-1] <= 0.0
    assert (y.link_age, y.motor_age, y.stiffness_age) == (DEADLINE_CYCLES + 1,) * 3
    made.mend()
    assert made.axis("motor").state == "stopping"


def test_an_encoder_freezes_with_fresh_answers_and_another_jumps() -> None:
    made = enabled()
    before = made.exchange(40.0, 0.0)
    made.freeze_encoder("link")
    made.jump_encoder("motor", 0.3)
    for _ in range(50):
        y = made.exchange(40.0, 0.0)
    assert y.link_position == before.link_position
    assert (y.link_age, y.motor_age) == (0, 0)
    assert y.motor_position - made.plant.theta_e == pytest.approx(0.3, abs=5e-3)


def test_the_stiffness_position_is_off_until_homed() -> None:
    made = rig(stiffness_offset=12.5)
    true = made.plant.theta_ms
    assert made.exchange(0.0, 0.0).stiffness_position == pytest.approx(true - 12.5, abs=1e-3)
    made.home(-12.5)
    assert made.exchange(0.0, 0.0).stiffness_position == pytest.approx(true, abs=1e-3)


@pytest.mark.parametrize("torque", [0.1, -0.1])
def test_the_stiffness_motor_meets_real_end_stops(torque: float) -> None:
    made, mechanism = enabled(), rig_scenario().actuator.stiffness
    for _ in range(600):
        made.exchange(0.0, torque)
    stiffness = mechanism.softest if torque > 0.0 else mechanism.stiffest
    assert made.plant.theta_ms == stiffness_motor_position(stiffness, mechanism.spring_constant)
    assert made.plant.omega_ms == 0.0


def test_what_the_bus_reports_is_told_once() -> None:
    made = rig()
    made.report(REBOOTED, "node 1")
    assert made.bus_faults() == ((REBOOTED, "node 1"),)
    assert made.bus_faults() == ()


def test_closing_disables_both_axes() -> None:
    made = enabled()
    made.close()
    assert {made.axis(axis).state for axis in AXES} == {"disabled"}
