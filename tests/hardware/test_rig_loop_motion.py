"""Jog, go-to, follow and hold on a rig, and the changes that are live."""

from collections.abc import Iterator

import numpy as np
import pytest

from backend.loop import messages
from backend.loop.messages import Moved
from backend.rigs.simulated import SimulatedRig
from tests.hardware.rig_loop_bench import RigBench, T, prepared
from vssea_core.control.tuning import StateFeedback
from vssea_core.signals.documents import (
    ConstantStiffness,
    FilteredStepReference,
    MoveReference,
    SineReference,
    StepReference,
)

NAN = float("nan")


@pytest.fixture
def bench() -> Iterator[RigBench]:
    opened = RigBench()
    opened.armed()
    yield opened
    opened.close()


def jog_for(bench: RigBench, duration_s: float, link: float = 0.3, stiffness: float = 0.0) -> None:
    for _ in range(round(duration_s / 0.1)):
        bench.jog(link, stiffness)
        bench.pass_s(0.1 - T)


def moved(bench: RigBench) -> list[tuple[str, str]]:
    return [(report.part, report.why) for report in bench.pipe.outbox if isinstance(report, Moved)]


def test_a_jog_moves_for_as_long_as_it_is_renewed_and_then_holds(bench: RigBench) -> None:
    jog_for(bench, 1.5)
    assert bench.state == "running"
    assert bench.report().motion == "jogging 0.30 rad/s"
    assert bench.rig.plant.omega_l == pytest.approx(0.3, abs=0.03)
    bench.until("armed", most_s=1.5)
    bench.pass_s(0.5)
    assert abs(bench.rig.plant.omega_l) < 0.01
    assert bench.report().motion.startswith("holding")
    assert bench.enabled() == ["motor", "stiffness"]


def test_a_jog_that_is_not_renewed_begins_to_come_to_rest_after_300_ms(bench: RigBench) -> None:
    jog_for(bench, 1.0)
    last = bench.now - 0.1
    while bench.report().motion != "coming to rest":
        bench.turn()
    assert 0.3 - T <= bench.now - last < 0.3 + 0.1 + 2 * T  # the report comes ten times a second
    assert bench.state == "running"


def test_letting_go_comes_to_rest_at_once(bench: RigBench) -> None:
    jog_for(bench, 0.8)
    speed = bench.rig.plant.omega_l
    bench.jog(0.0, 0.0)
    assert bench.until("armed", most_s=1.0) < 0.8
    assert abs(speed) > 0.2


def test_a_stale_jog_is_dropped_and_does_not_keep_a_jog_alive(bench: RigBench) -> None:
    old = bench.now - 0.31
    assert "s old" in bench.refused(messages.Jog(0.3, 0.0, old))
    assert bench.state == "armed"
    bench.jog()
    sent = bench.now
    for _ in range(20):
        bench.send(messages.Jog(0.3, 0.0, sent - 0.25))
        bench.pass_s(0.05)
    bench.until("armed", most_s=1.0)
    assert bench.rig.plant.theta_l < 0.2


def test_a_jog_dated_ahead_or_not_at_all_lives_no_longer_than_any_other(bench: RigBench) -> None:
    bench.do(messages.Jog(0.3, 0.0, bench.now + 100.0))
    bench.until("armed", most_s=1.2)
    bench.refused(messages.Jog(0.3, 0.0, NAN))
    assert bench.state == "armed"


def test_a_flood_of_jogs_is_never_a_queue(bench: RigBench) -> None:
    for _ in range(500):
        bench.send(messages.Jog(0.3, 0.0, bench.now))
    bench.turn()
    begun = bench.now
    bench.until("armed", most_s=2.0)
    assert bench.now - begun < 1.2


def test_a_jog_turns_round_without_a_jump(bench: RigBench) -> None:
    jog_for(bench, 0.8, 0.4)
    jog_for(bench, 0.8, -0.4)
    assert bench.rig.plant.omega_l == pytest.approx(-0.4, abs=0.05)
    reference = bench.channel("reference")[-800:]
    assert np.abs(np.diff(reference, 2)).max() / T**2 < 4.0


def test_a_jog_comes_to_rest_before_the_limit_of_the_link(bench: RigBench) -> None:
    jog_for(bench, 4.0, 0.8)
    assert bench.report().faults == ()
    assert 1.55 < bench.rig.plant.theta_l < 1.6
    assert abs(bench.rig.plant.omega_l) < 0.02
    bench.until("armed", most_s=2.0)
    assert "at the rig's limit" in bench.refused(messages.Jog(0.2, 0.0, bench.now))
    jog_for(bench, 0.5, -0.8)
    assert bench.rig.plant.theta_l < 1.58


@pytest.mark.parametrize(("link", "stiffness"), [(0.81, 0.0), (-0.81, 0.0), (0.0, 401.0), (NAN, 0.0), (0.0, NAN)])
def test_a_jog_above_the_rigs_speed_is_refused_in_words(bench: RigBench, link: float, stiffness: float) -> None:
    assert "expected" in bench.refused(messages.Jog(link, stiffness, bench.now))
    assert bench.state == "armed"


def test_a_stiffness_jog_changes_the_stiffness_at_its_rate_and_stays_there(bench: RigBench) -> None:
    begun = bench.channel("stiffness")[-1]
    jog_for(bench, 1.0, 0.0, 200.0)
    bench.jog(0.0, 0.0)
    assert bench.until("armed", most_s=0.1) < 0.1
    bench.pass_s(0.5)
    reached = bench.channel("stiffness")[-1]
    assert reached == pytest.approx(begun + 200.0, abs=15.0)
    bench.pass_s(0.5)
    assert bench.channel("stiffness")[-1] == pytest.approx(reached, rel=0.01)
    assert moved(bench)[-1] == ("stiffness_reference", "jog")


def test_a_stiffness_jog_ends_at_the_rigs_range(bench: RigBench) -> None:
    jog_for(bench, 3.0, 0.0, 400.0)
    assert bench.channel("stiffness")[-1] == pytest.approx(900.0, rel=0.02)
    assert bench.report().faults == ()


def test_a_stiffness_jog_that_is_not_renewed_ends(bench: RigBench) -> None:
    bench.jog(0.0, 200.0)
    assert bench.until("armed", most_s=1.0) == pytest.approx(0.3, abs=3 * T)


@pytest.mark.parametrize("target", [0.5, -0.004, 1.59])
def test_go_to_arrives_within_its_speed_and_holds(bench: RigBench, target: float) -> None:
    bench.do(messages.GoTo(target, 0.6))
    first = bench.reader.written
    assert bench.state == "running"
    assert bench.report().motion == f"going to {target:.3f} rad"
    bench.until("armed", most_s=6.0)
    bench.pass_s(0.5)
    samples = bench.channel("reference")[first:]
    assert samples[-1] == pytest.approx(target, abs=1e-3)
    assert np.abs(np.diff(samples)).max() / T < 0.6 * 1.01
    assert bench.rig.plant.theta_l == pytest.approx(target, abs=5e-3)


@pytest.mark.parametrize(("target", "speed"), [(1.7, 0.5), (-1.61, 0.5), (0.5, 0.0), (0.5, 0.9), (0.5, float("nan"))])
def test_go_to_outside_the_rigs_limits_is_refused_in_words(bench: RigBench, target: float, speed: float) -> None:
    assert "expected" in bench.refused(messages.GoTo(target, speed))
    assert bench.state == "armed"


def test_follow_starts_what_was_set_and_hold_ends_it(bench: RigBench) -> None:
    bench.do(messages.SetReference(SineReference(amplitude=0.2, frequency_hz=0.5)))
    assert bench.state == "armed"
    bench.follow()
    bench.pass_s(3.0)
    assert (bench.state, bench.report().motion) == ("running", "tracking")
    assert np.abs(bench.channel("link_position")[-500:]).max() == pytest.approx(0.2, abs=0.01)
    bench.do(messages.Hold())
    bench.until("armed", most_s=2.0)
    bench.pass_s(0.5)
    assert abs(bench.rig.plant.omega_l) < 0.01
    assert moved(bench)[-2:] == [("reference", "follow"), ("reference", "hold")]


def test_a_reference_that_starts_elsewhere_is_refused_with_where_to_go(bench: RigBench) -> None:
    bench.do(messages.SetReference(MoveReference(origin=0.5, target=0.8)))
    sentence = bench.refused(messages.Follow())
    assert "go to 0.500 rad first" in sentence
    assert bench.state == "armed"
    bench.do(messages.GoTo(0.5, 0.5))
    bench.until("armed", most_s=4.0)
    bench.follow()


def test_a_raw_step_is_looked_at_where_it_begins(bench: RigBench) -> None:
    bench.do(messages.SetReference(StepReference(origin=0.4, target=0.5)))
    assert "go to 0.400 rad first" in bench.refused(messages.Follow())


def test_while_following_another_reference_is_live_and_continuous(bench: RigBench) -> None:
    bench.follow()
    bench.pass_s(2.3)
    before = bench.reader.written
    bench.do(messages.SetReference(SineReference(amplitude=0.1, frequency_hz=1.0)))
    bench.pass_s(2.0)
    reference = bench.channel("reference")[before - 50 :]
    assert np.abs(np.diff(reference)).max() / T < 3.0
    assert np.abs(reference[-400:]).max() == pytest.approx(0.1, abs=0.005)


def test_a_link_jog_waits_for_the_end_of_what_is_followed(bench: RigBench) -> None:
    bench.follow()
    assert "hold it first" in bench.refused(messages.Jog(0.3, 0.0, bench.now))
    bench.do(messages.Jog(0.0, 100.0, bench.now))  # the stiffness may be jogged meanwhile
    assert bench.report().motion == "tracking"


def test_stiffness_is_live_while_armed_and_continuous(bench: RigBench) -> None:
    bench.do(messages.SetStiffness(ConstantStiffness(stiffness=300.0)))
    bench.pass_s(1.0)
    assert bench.channel("stiffness")[-1] == pytest.approx(300.0, rel=0.02)
    assert bench.state == "armed"


def test_a_tuning_swapped_while_following_and_swapped_back_is_bumpless(bench: RigBench) -> None:
    bench.follow()
    bench.pass_s(3.0)
    usual = np.abs(np.diff(bench.channel("motor_torque")[-1000:])).max()
    mine = bench.scenario.tuning
    other = mine.model_copy(update={"controller": StateFeedback(natural_frequency=16.0)})
    bench.do(messages.Install(other, prepared(other), 2))
    bench.pass_s(1.0)
    assert bench.channel("tuning_id")[-1] == 2.0
    bench.do(messages.Install(mine, prepared(mine), 3))
    bench.pass_s(1.0)
    assert np.abs(np.diff(bench.channel("motor_torque")[-1000:])).max() < 2.5 * usual + 0.5
    assert np.abs(bench.channel("error")[-250:]).max() < 0.01


def test_a_tuning_of_another_rate_is_refused_and_the_old_one_goes_on(bench: RigBench) -> None:
    tuning = bench.scenario.tuning
    assert "cycles of 1 ms" in bench.refused(messages.Install(tuning, prepared(tuning, 1e-3), 2))
    bench.pass_s(0.2)
    assert bench.channel("tuning_id")[-1] == 1.0
    assert bench.state == "armed"


def test_every_change_of_what_is_held_is_told(bench: RigBench) -> None:
    assert moved(bench)[:2] == [("reference", "armed"), ("stiffness_reference", "armed")]
    bench.do(messages.GoTo(0.2, 0.5))
    assert moved(bench)[-1] == ("reference", "go to")
    last = [report for report in bench.pipe.outbox if isinstance(report, Moved)][-1]
    assert last.scenario.reference.kind == "jog"


def test_limits_act_last_whatever_tuning_and_reference_ask(bench: RigBench) -> None:
    stiff = bench.scenario.tuning.model_copy(update={"controller": StateFeedback(natural_frequency=40.0)})
    bench.do(messages.Install(stiff, prepared(stiff), 2))
    bench.do(messages.SetReference(FilteredStepReference(origin=0.0, target=1.5, start_s=0.0, bandwidth=60.0)))
    first = len(bench.rig.asked)
    bench.follow()
    bench.pass_s(1.0)
    asked = np.array(bench.rig.asked[first:])[:, 0]
    limits = np.bitwise_or.reduce(bench.channel("limits")[-500:].astype(int))
    assert np.abs(asked).max() <= 70.0
    grown = np.abs(asked[1:]) - np.abs(asked[:-1])
    assert grown.max() <= 20000.0 * T + 1e-9
    assert limits & (256 | 512 | 1024 | 2048 | 4096)
    assert bench.rig.plant.theta_l < 1.65


def torque_with_late_cycles(late: int) -> float:
    """Follow a sine while the loop is `late` whole cycles late, ten times; return the largest change of torque [N m]."""
    bench = RigBench()
    try:
        bench.armed()
        bench.follow()
        bench.pass_s(1.5)
        first = len(bench.rig.asked)
        for _ in range(10):
            bench.turns(40)
            for _ in range(late):
                SimulatedRig.exchange(bench.rig, *bench.rig.asked[-1])  # the drives hold, time passes
                bench.now += T
            bench.turn(missed=late)
        assert bench.state == "running"
        assert np.allclose(np.diff(bench.channel("time")), T)
        return float(np.abs(np.diff(np.array(bench.rig.asked[first:])[:, 0])).max())
    finally:
        bench.close()


def test_a_loop_that_was_late_by_whole_cycles_does_not_kick() -> None:
    usual = torque_with_late_cycles(0)
    assert torque_with_late_cycles(1) < usual + 3.0
    assert torque_with_late_cycles(3) < usual + 6.0
