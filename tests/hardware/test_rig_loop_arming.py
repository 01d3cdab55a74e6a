"""Arming: what refuses it, and that closing the loops moves nothing. Connecting and homing before it."""

from collections.abc import Callable, Iterator

import numpy as np
import pytest

from backend.loop import messages
from backend.loop.messages import Done, State
from backend.loop.rig_commands import cannot_arm
from backend.loop.rig_states import ALLOWED, SIMULATION_ONLY, refusal
from backend.rigs.faults import LINK_ENCODER, NO_BUS
from backend.rigs.rig import RigError
from backend.rigs.simulated import SimulatedRig
from backend.telemetry.beats import LEASE
from backend.telemetry.ring import EPOCH, PERIOD_S, WIDTH
from tests.hardware.rig_loop_bench import FILE, SCENARIO, RigBench, T, prepared
from vssea_core.actuator.parameters import Actuator, EquilibriumMotor, Timing
from vssea_core.channels import INDEX
from vssea_core.signals.documents import ConstantDisturbance, Disturbances


@pytest.fixture
def bench() -> Iterator[RigBench]:
    opened = RigBench()
    yield opened
    opened.close()


def test_a_connected_rig_measures_and_reports_who_it_is(bench: RigBench) -> None:
    bench.connect()
    bench.pass_s(0.5)
    assert bench.state == "connected"
    report = bench.report()
    assert (report.kind, report.homed, report.motion) == ("simulated", False, "drives off")
    assert [axis.axis for axis in report.axes] == ["motor", "stiffness"]
    assert bench.reader.written == round(0.6 / T) + 1
    assert bench.enabled() == []


def test_a_rig_that_does_not_answer_is_refused_with_its_sentence_and_closed(
    bench: RigBench, monkeypatch: pytest.MonkeyPatch
) -> None:
    def nobody() -> None:
        raise RigError(NO_BUS, "127.0.0.1:29536")

    monkeypatch.setattr(bench.rig, "connect", nobody)
    command = messages.Connect(bench.file, bench.scenario, prepared(bench.scenario.tuning), 1)
    assert bench.refused(command) == NO_BUS.sentence("127.0.0.1:29536").rstrip(".")
    assert (bench.state, bench.rig.closed) == ("starting", 1)
    assert bench.reader.written == 0


def test_a_scenario_of_another_rate_is_refused_at_connection(bench: RigBench) -> None:
    scenario = SCENARIO.model_copy(update={"timing": Timing(sample_time_s=1e-3, compute_delay_samples=1)})
    sentence = bench.refused(messages.Connect(bench.file, scenario, prepared(scenario.tuning, 1e-3), 1))
    assert "set timing.sample_time_s to 0.002 s" in sentence
    assert bench.rig.closed == 1


def test_ten_reports_a_second_and_one_at_each_change(bench: RigBench) -> None:
    bench.connect()
    bench.pipe.outbox.clear()
    bench.pass_s(2.0)
    reports = [report for report in bench.pipe.outbox if isinstance(report, messages.RigReport)]
    assert 19 <= len(reports) <= 21
    bench.pipe.outbox.clear()
    bench.stop()
    assert sum(isinstance(report, messages.RigReport) for report in bench.pipe.outbox) == 1


def test_rows_of_a_rig_that_is_not_homed_hold_what_is_known_and_nan(bench: RigBench) -> None:
    bench.connect()
    row = bench.reader.latest()
    assert row is not None
    known = [
        "time",
        "link_position",
        "motor_position",
        "motor_torque",
        "stiffness_motor_position",
        "stiffness_motor_torque",
    ]
    for name in [*known, "limits", "tuning_id"]:
        assert np.isfinite(row[INDEX[name]]), name
    unknown = set(INDEX) - {*known, "limits", "tuning_id"}
    assert all(np.isnan(row[INDEX[name]]) for name in unknown)
    assert (row[EPOCH], row[PERIOD_S]) == (1.0, T)
    bench.home()
    row = bench.reader.latest()
    assert row is not None
    assert np.isnan(row[:WIDTH]).sum() == 1  # the load of the link, which nobody knows
    assert row[INDEX["stiffness_motor_position"]] == pytest.approx(bench.rig.plant.theta_ms, abs=0.1)


def test_time_goes_on_from_connection_to_the_end(bench: RigBench) -> None:
    bench.armed()
    bench.stop()
    bench.until("stopped")
    bench.do(messages.Reset())
    bench.arm()
    time = bench.channel("time")
    assert np.allclose(np.diff(time), T)
    assert set(bench.reader.since(0).samples[:, EPOCH]) == {1.0}


def test_homing_makes_the_position_theta_ms_itself_and_ends_ready_with_the_drives_off(bench: RigBench) -> None:
    bench.connect()
    bench.home()
    assert bench.state == "ready"
    assert bench.report().homed
    assert bench.report().span_found == pytest.approx(84.3, abs=0.1)
    assert bench.enabled() == []
    assert bench.rig.plant.theta_ms == pytest.approx(69.9, abs=0.5)
    assert bench.rig.given == (0.0, 0.0)


def aligned(starts_at: float, align: bool) -> float:
    """Home a rig whose motor encoder starts `starts_at` [rad] off, and return the deflection that it shows then [rad]."""
    homing = FILE.homing.model_copy(update={"align_motor": align})
    bench = RigBench(file=FILE.model_copy(update={"homing": homing}))
    bench.rig.jump_encoder("motor", starts_at)
    bench.connect()
    bench.home()
    return float(bench.channel("motor_position")[-1] - bench.channel("link_position")[-1])


@pytest.mark.parametrize("starts_at", [0.0, 0.7, -120.0])
def test_an_incremental_motor_encoder_is_aligned_with_the_link(starts_at: float) -> None:
    assert aligned(starts_at, align=True) == pytest.approx(0.0, abs=2e-3)


def test_an_absolute_motor_encoder_is_believed() -> None:
    assert aligned(0.05, align=False) == pytest.approx(0.05, abs=2e-3)


def test_a_stiffness_drive_that_was_left_in_its_quick_stop_can_be_homed(bench: RigBench) -> None:
    """As it is found when the bus was lost and the rig is connected again."""
    bench.connect()
    SimulatedRig.arm(bench.rig, "stiffness")
    bench.pass_s(0.1)
    SimulatedRig.stop(bench.rig, "stiffness")
    bench.pass_s(0.1)
    assert bench.rig.axis("stiffness").state == "stopping"
    bench.home()
    assert bench.enabled() == []


def test_homing_again_finds_the_same_place(bench: RigBench) -> None:
    bench.connect()
    bench.home()
    bench.home()
    row = bench.reader.latest()
    assert row is not None
    assert row[INDEX["stiffness_motor_position"]] == pytest.approx(bench.rig.plant.theta_ms, abs=0.1)
    bench.arm()


def spoil(**fields: float) -> Callable[[RigBench], None]:
    return lambda bench: bench.rig.spoiled.update(fields)


def silence_operator(bench: RigBench) -> None:
    bench.alive[LEASE] = False
    bench.pass_s(0.5)


def let_the_motor_turn(bench: RigBench) -> None:
    bench.rig.set_disturbances(Disturbances(motor=(ConstantDisturbance(torque=-8.0),)))
    bench.pass_s(0.3)


def outside(bench: RigBench) -> None:
    bench.rig.spoiled.update(link_position=1.62, motor_position=1.62)
    bench.turns(20)


REASONS: list[tuple[str, Callable[[RigBench], None], str]] = [
    ("stale", lambda b: b.rig.missed.update(link=1), "the link encoder did not answer"),
    ("outside", outside, "the link is at 1.620 rad, expected -1.6 to 1.6"),
    ("deflected", spoil(motor_position=0.7), "the spring is deflected by 0.700 rad, limit 0.6"),
    ("moving", let_the_motor_turn, "the motor moves at"),
    ("nobody", silence_operator, "nobody is in control"),
]


@pytest.mark.parametrize(("name", "make", "reason"), REASONS, ids=[case[0] for case in REASONS])
def test_arming_is_refused_in_words(bench: RigBench, name: str, make: Callable[[RigBench], None], reason: str) -> None:
    bench.connect()
    bench.home()
    assert bench.report().cannot_arm == ()
    make(bench)
    bench.turn() if name != "nobody" else None
    conduct = bench.loop._conduct
    assert conduct is not None
    assert any(reason in clause for clause in cannot_arm(conduct)), cannot_arm(conduct)
    bench.rig.orders.clear()
    if name == "stale":
        bench.rig.missed.update(link=2)
        bench.turn()
        bench.rig.missed.update(link=2)
    if bench.state == "ready":
        answer = bench.ask(messages.Arm())
        assert not isinstance(answer, Done)
        assert reason in answer.sentence
    assert ("arm", "motor") not in bench.rig.orders


def test_a_rig_that_is_not_homed_cannot_be_armed(bench: RigBench) -> None:
    bench.connect()
    assert "home it first" in bench.refused(messages.Arm())
    assert any("not homed" in clause for clause in bench.report().cannot_arm)


def test_a_latched_fault_refuses_arming_and_homing(bench: RigBench) -> None:
    bench.connect()
    bench.home()
    bench.rig.report(LINK_ENCODER)
    bench.turn()
    assert "clear the cause" in bench.refused(messages.Arm())
    assert "clear the cause" in bench.refused(messages.Home())
    assert any("a fault is latched" in clause for clause in bench.report().cannot_arm)


def test_nobody_in_control_refuses_homing(bench: RigBench) -> None:
    bench.connect()
    silence_operator(bench)
    assert "take control" in bench.refused(messages.Home())


def test_a_tuning_of_another_rate_refuses_arming(bench: RigBench) -> None:
    command = messages.Connect(bench.file, bench.scenario, prepared(bench.scenario.tuning, 1e-3), 1)
    bench.do(command)
    bench.home()
    assert "made for cycles of 1 ms" in bench.refused(messages.Arm())


def preloaded(torque: float) -> RigBench:
    """A rig whose motor's dry friction holds a loaded spring while the drives are off."""
    scenario = SCENARIO.model_copy(
        update={
            "actuator": Actuator(motor=EquilibriumMotor(coulomb_friction=8.0, torque_lag_s=1.6e-4)),
            "disturbances": Disturbances(link=(ConstantDisturbance(torque=torque),)),
        }
    )
    bench = RigBench(scenario.model_copy(update={"disturbances": Disturbances()}), truth=scenario)
    bench.connect()
    bench.home()
    bench.pass_s(8.0)  # the link rings for a while
    return bench


def test_after_homing_the_stiffness_axis_holds_a_spring_that_is_loaded() -> None:
    bench = preloaded(4.0)
    try:
        assert (bench.state, bench.enabled()) == ("ready", ["stiffness"])
        assert bench.rig.plant.theta_ms == pytest.approx(69.9, abs=0.5)
        assert bench.report().motion == "the stiffness axis holds"
        bench.stop()
        bench.pass_s(1.5)
        assert (bench.state, bench.enabled()) == ("stopped", ["stiffness"])
    finally:
        bench.close()


@pytest.mark.parametrize("torque", [0.0, 5.0, -5.0])
def test_arming_is_bumpless_on_a_preloaded_spring(torque: float) -> None:
    bench = preloaded(torque)
    try:
        link, theta_ms = bench.rig.plant.theta_l, bench.rig.plant.theta_ms
        assert abs(bench.rig.plant.theta_e - link) > 0.03 or torque == 0.0
        bench.arm()
        first = bench.reader.written
        bench.pass_s(1.5)
        assert bench.state == "armed"
        links, torques = bench.channel("link_position")[first:], bench.channel("motor_torque")[first:]
        assert np.abs(links - link).max() < 2e-3
        begin = np.abs(torques[: round(0.01 / T)])
        assert begin.max() < 2.0  # blended in, never at once
        assert np.abs(np.diff(torques)).max() < 4.0  # what the encoders' counts cost
        assert abs(bench.rig.plant.theta_ms - theta_ms) < 0.5
    finally:
        bench.close()


def test_the_torque_is_blended_in_over_100_ms(bench: RigBench) -> None:
    bench.armed()
    limits = bench.channel("limits").astype(int)
    blended = np.flatnonzero(limits & 16384)
    assert len(blended) == pytest.approx(0.1 / T, abs=2)


def test_done_of_arm_comes_when_the_loops_are_closed(bench: RigBench) -> None:
    bench.connect()
    bench.home()
    number = bench.send(messages.Arm())
    bench.turn()
    assert bench.answer(number) is None
    assert bench.state == "ready"
    while bench.answer(number) is None:
        assert bench.rig.given[0] == 0.0
        bench.turn()
    assert isinstance(bench.answer(number), Done)
    assert bench.state == "armed"


@pytest.mark.parametrize("kind", list(SIMULATION_ONLY), ids=lambda kind: kind.__name__)
def test_what_only_a_simulation_can_is_refused_in_words(kind: type[messages.Command]) -> None:
    assert "rig" in str(refusal(object.__new__(kind), "running"))


@pytest.mark.parametrize(
    "state", ["starting", "connected", "homing", "ready", "armed", "running", "stopping", "stopped", "fault"]
)
def test_every_command_is_allowed_or_refused_with_a_sentence_in_every_state(state: State) -> None:
    for kind, allowed in ALLOWED.items():
        sentence = refusal(object.__new__(kind), state)
        assert (sentence is None) == (state in allowed)
        if sentence is not None:
            assert state in sentence or "not connected" in sentence or "already" in sentence
            assert not sentence.endswith(".")


def test_every_command_of_the_session_has_its_place_in_the_table() -> None:
    assert set(ALLOWED) | set(SIMULATION_ONLY) == set(messages.Command.__args__)
    assert not set(ALLOWED) & set(SIMULATION_ONLY)
