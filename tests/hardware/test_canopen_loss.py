"""What counts as this cycle's answer, and how loss and delay show: as ages."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from backend.rigs.canopen.answer import NEVER
from tests.hardware.fake_bus import ANSWER_DELAY_S
from tests.hardware.fake_rig import MOTOR_UNIT, RIG_FILE, FakeRig, ages, faults


def test_before_the_first_answer_nothing_is_fresh() -> None:
    fake = FakeRig().ready()
    fake.motor.silent = True
    measured = fake.turn()
    assert measured.motor_age > NEVER
    assert (measured.link_age, measured.stiffness_age) == (0, 0)
    assert fake.rig.axis("motor").state == "unknown"


def test_silence_counts_up_cycle_by_cycle_and_the_last_values_stand() -> None:
    fake = FakeRig().armed()
    fake.link.position = 5000
    before = fake.turn()
    fake.link.silent = fake.motor.silent = True
    for cycle in range(1, 13):
        began = fake.clock.now
        measured = fake.rig.exchange(0.0, 0.0)
        assert fake.clock.now - began == pytest.approx(RIG_FILE.answer_share * fake.rig.period_s)
        fake.clock.now = began + fake.rig.period_s
        assert ages(measured) == (cycle, cycle, 0)
        assert measured.link_position == before.link_position
    assert fake.rig.axis("motor").state == "unknown"
    assert faults(fake) == [], "loss is an age; what follows from it is the loop's"
    fake.link.silent = fake.motor.silent = False
    assert ages(fake.turn()) == (0, 0, 0)


def test_an_answer_after_the_deadline_is_late_and_not_taken_for_the_next_cycles() -> None:
    fake = FakeRig().ready()
    fake.turn(cycles=60)
    fake.link.delay_s = lambda place: 1.5e-3  # later than 1.2 ms, before the next cycle
    for cycle in range(1, 6):
        fake.link.position += 100
        assert fake.turn().link_age == cycle
    assert fake.rig.health().late_answers == 4
    fake.link.delay_s = lambda place: ANSWER_DELAY_S
    measured = fake.turn()
    assert measured.link_age == 0
    assert measured.link_position == pytest.approx(500 * math.tau / 131072)


def test_of_two_answers_in_one_cycle_the_newer_is_this_cycles() -> None:
    fake = FakeRig().ready()
    fake.turn(cycles=60)
    fake.link.delay_s = lambda place: 2.2e-3  # into the next cycle, ahead of that one's answer
    fake.link.position = 100
    assert fake.turn().link_age == 1
    fake.link.delay_s = lambda place: ANSWER_DELAY_S
    fake.link.position = 200
    measured = fake.turn()
    assert measured.link_age == 0
    assert measured.link_position == pytest.approx(200 * math.tau / 131072)
    assert fake.rig.health().late_answers == 1


def test_answers_that_are_always_more_than_a_cycle_late_are_found_out_and_never_fresh_again() -> None:
    fake = FakeRig().ready()
    fake.turn(cycles=10)
    fake.link.delay_s = lambda place: 2.1e-3  # as quick after the next SYNC as any answer
    ages = [fake.turn().link_age for _ in range(60)]
    assert ages[:4] == [1, 0, 0, 0], "taken for new until the cycle without SYNC"
    assert ages[4:] == list(range(1, 57))
    assert fake.rig.health().late_answers > 10
    fake.link.delay_s = lambda place: ANSWER_DELAY_S
    fake.turn(cycles=6)
    assert fake.turn().link_age == 0
    fake.link.delay_s = lambda place: None
    fake.turn()
    fake.link.delay_s = lambda place: ANSWER_DELAY_S
    assert fake.turn().link_age == 0, "trusted again"


def test_a_late_answer_that_is_lost_on_the_way_is_not_waited_for_for_ever() -> None:
    fake = FakeRig().ready()
    for _ in range(3):
        fake.turn(cycles=10)
        fake.link.delay_s = lambda place: 2.1e-3
        while fake.turn().link_age < 3:
            pass
        fake.link.delay_s = lambda place: None
        fake.turn(cycles=3)
        fake.link.delay_s = lambda place: 2.1e-3
        fake.turn(cycles=3)
        fake.link.delay_s = lambda place: ANSWER_DELAY_S
        fake.turn(cycles=20)
        assert fake.turn().link_age == 0


@given(st.floats(1.25e-3, 20e-3))
def test_whatever_the_delay_beyond_the_deadline_nothing_is_fresh_after_some_cycles(delay_s: float) -> None:
    fake = FakeRig().ready()
    fake.turn(cycles=10)
    fake.link.delay_s = lambda place: delay_s
    fake.turn(cycles=60)
    assert all(fake.turn().link_age > 0 for _ in range(40))
    assert fake.rig.health().late_answers > 0
    fake.link.delay_s = lambda place: ANSWER_DELAY_S
    fake.turn(cycles=40)
    assert all(fake.turn().link_age == 0 for _ in range(10))


@given(st.lists(st.sampled_from([None, 1e-4, 1.1e-3, 1.5e-3, 1.9e-3]), min_size=1, max_size=60))
def test_what_is_called_fresh_was_measured_in_this_cycle(delays: list[float | None]) -> None:
    fake = FakeRig().ready()
    for delay in delays:  # lost, early, just in time, or late by less than a cycle
        fake.link.delay_s = lambda place, delay=delay: delay
        fake.link.position += 10
        measured = fake.turn()
        if measured.link_age == 0:
            assert measured.link_position == pytest.approx(fake.link.position * math.tau / 131072)


def test_a_stalled_node_that_makes_up_for_its_answers_at_once_is_fresh_with_the_last() -> None:
    fake = FakeRig().ready()
    fake.turn(cycles=10)
    for missing in range(10, 0, -1):
        fake.link.position += 10
        fake.link.delay_s = lambda place, delay=missing * fake.rig.period_s + 2e-4: delay
        fake.turn()
    fake.link.delay_s = lambda place: 3e-4
    fake.link.position += 10
    measured = fake.turn()
    assert measured.link_age == 0
    assert measured.link_position == pytest.approx(fake.link.position * math.tau / 131072)


@pytest.mark.parametrize("slow_s", [ANSWER_DELAY_S, 1.1e-3])
def test_a_lost_answer_costs_two_cycles_and_never_two_in_a_row(slow_s: float) -> None:
    fake = FakeRig().ready()
    fake.turn(cycles=10)
    for _ in range(20):
        fake.link.delay_s = lambda place: None
        assert fake.turn().link_age == 1
        fake.link.delay_s = lambda place: slow_s
        assert [fake.turn().link_age for _ in range(20)] == [0, 0, 0, 1, *[0] * 16]
    assert fake.rig.health().late_answers == 0


def test_the_cycle_that_settles_a_doubt_is_without_sync_but_not_without_torques() -> None:
    fake = FakeRig().armed()
    fake.turn(10.0)
    fake.link.delay_s = lambda place: None
    fake.turn(10.0)
    fake.link.delay_s = lambda place: ANSWER_DELAY_S
    fake.turn(10.0, cycles=3)
    fake.bus.sent.clear()
    measured = fake.turn(30.0)
    assert [m.arbitration_id for m in fake.bus.sent if m.arbitration_id < 0x700] == [0x201, 0x202]
    assert measured.motor_torque == pytest.approx(10.0, abs=MOTOR_UNIT), "not taken over without SYNC"
    assert fake.turn(30.0).motor_torque == pytest.approx(30.0, abs=MOTOR_UNIT)


def test_a_doubt_waits_for_a_cycle_in_which_nothing_is_missing() -> None:
    fake = FakeRig().ready()
    fake.turn(cycles=10)
    fake.link.delay_s = lambda place: None
    fake.turn()
    fake.link.delay_s = lambda place: ANSWER_DELAY_S
    fake.turn()
    fake.stiffness.delay_s = lambda place: None
    fake.bus.sent.clear()
    fake.turn(cycles=5)
    assert len(fake.bus.sent_to(0x080)) == 5


def test_a_lost_torque_alone_ages_the_axis_only_when_it_stays_away() -> None:
    fake = FakeRig().ready()
    fake.turn()
    fake.motor.delay_s = lambda place: None if place == 1 else ANSWER_DELAY_S
    assert [fake.turn().motor_age for _ in range(12)] == [0] * 9 + [10, 11, 12]
