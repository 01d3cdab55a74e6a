"""The loop's clock, in injected time."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from backend.loop.pacer import Pacer

INTERVAL_S = 0.25  # a power of two, so that sums of it are exact


class Time:
    """A clock that only sleeping and working move."""

    def __init__(self) -> None:
        self.now_s = 1000.0
        self.oversleep_s = 0.0

    def clock(self) -> float:
        return self.now_s

    def sleep(self, duration_s: float) -> None:
        assert duration_s > 0.0
        self.now_s += duration_s + self.oversleep_s


@pytest.fixture
def time() -> Time:
    return Time()


@pytest.fixture
def pacer(time: Time) -> Pacer:
    return Pacer(time.clock, time.sleep)


def test_lateness_does_not_add_up(time: Time, pacer: Pacer) -> None:
    time.oversleep_s = 0.125
    for tick in range(1, 50):
        assert pacer.wait(INTERVAL_S) == 0.125
        assert time.now_s == 1000.0 + tick * INTERVAL_S + 0.125
    assert pacer.overruns == 0


def test_a_late_tick_within_its_interval_is_made_up_for(time: Time, pacer: Pacer) -> None:
    time.now_s += 0.375  # work took one interval and a half
    assert pacer.wait(INTERVAL_S) == 0.125
    pacer.wait(INTERVAL_S)
    assert time.now_s == 1000.0 + 2 * INTERVAL_S
    assert pacer.overruns == 0


def test_missed_intervals_are_counted_and_never_run_back_to_back(time: Time, pacer: Pacer) -> None:
    time.now_s += 10.125  # away for 40 intervals and a half
    pacer.wait(INTERVAL_S)
    assert pacer.overruns == 39
    before = time.now_s
    assert pacer.wait(INTERVAL_S) == 0.0
    assert time.now_s == before + 0.125
    assert pacer.wait(INTERVAL_S) == 0.0
    assert time.now_s == before + 0.375


def test_after_a_restart_nothing_was_missed(time: Time, pacer: Pacer) -> None:
    time.now_s += 100.0
    pacer.restart()
    assert pacer.wait(INTERVAL_S) == 0.0
    assert (pacer.overruns, time.now_s) == (0, 1100.0 + INTERVAL_S)


@given(st.lists(st.integers(0, 64), min_size=1, max_size=60))
def test_every_interval_that_passed_is_a_tick_or_an_overrun(work: list[int]) -> None:
    time = Time()
    pacer = Pacer(time.clock, time.sleep)
    for eighths in work:
        time.now_s += eighths * 0.125
        late = pacer.wait(INTERVAL_S)
        assert late >= 0.0
    passed = math.floor((time.now_s - 1000.0) / INTERVAL_S)
    assert len(work) + pacer.overruns == passed
