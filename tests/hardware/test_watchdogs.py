"""What the watchdogs, the freshness of measurements and the latch promise, in injected time."""

from collections.abc import Iterator

import pytest

from backend.loop.freshness import oldest, silence, stop_sentence
from backend.loop.latch import Latch
from backend.loop.watchdogs import WEB_S, Watchdogs
from backend.rigs.faults import (
    BUS_SILENT,
    LEASE_EXPIRED,
    LINK_SILENT,
    MOTOR_SILENT,
    OVERSPEED,
    REBOOTED,
    STIFFNESS_SILENT,
    WEB_SILENT,
    Fault,
)
from backend.rigs.rig import Measured
from backend.telemetry.beats import LEASE, LEASE_S, WEB, Beats
from tests.injected_clock import Clock


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def beats() -> Iterator[Beats]:
    opened = Beats()
    yield opened
    opened.close()


def test_a_lease_that_was_never_renewed_has_expired(beats: Beats, clock: Clock) -> None:
    dogs = Watchdogs(beats, clock)
    dogs.look()
    assert dogs.lease_left_s == 0.0
    assert dogs.expired() is LEASE_EXPIRED


def test_each_silence_is_told_at_its_own_limit_and_not_before(beats: Beats, clock: Clock) -> None:
    assert (LEASE_S, WEB_S) == (0.4, 0.25)
    dogs = Watchdogs(beats, clock)
    for which, limit, fault in ((LEASE, 0.4, LEASE_EXPIRED), (WEB, 0.25, WEB_SILENT)):
        for beat in (LEASE, WEB):
            beats.beat(beat)
        dogs.look()
        begun = clock.now
        while clock.now - begun < limit - 0.0015:
            clock.now += 0.001
            beats.beat(WEB if which == LEASE else LEASE)
            dogs.look()
            assert dogs.expired() is None
        clock.now += 0.002
        beats.beat(WEB if which == LEASE else LEASE)
        dogs.look()
        assert dogs.expired() is fault


def test_looking_does_not_feed_a_watchdog(beats: Beats, clock: Clock) -> None:
    dogs = Watchdogs(beats, clock)
    beats.beat(LEASE)
    dogs.look()
    for _ in range(10):
        clock.now += 0.03
        dogs.look()
    assert dogs.lease_left_s == pytest.approx(0.1)


def measured(link: int = 0, motor: int = 0, stiffness: int = 0) -> Measured:
    return Measured(0.0, 0.0, 70.0, link, motor, stiffness, 0.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("ages", "fault"),
    [
        ((9, 9, 9), None),
        ((10, 0, 0), LINK_SILENT),
        ((0, 10, 0), MOTOR_SILENT),
        ((0, 0, 10), STIFFNESS_SILENT),
        ((10, 12, 11), BUS_SILENT),
        ((10, 10, 9), MOTOR_SILENT),
    ],
)
def test_ten_missed_cycles_are_a_fault_of_the_node_and_of_the_bus_if_all_are_silent(
    ages: tuple[int, int, int], fault: Fault | None
) -> None:
    assert silence(measured(*ages)) is fault
    assert oldest(measured(*ages)) == max(ages)


def test_a_stop_for_missing_measurements_names_the_nodes() -> None:
    assert stop_sentence(measured(motor=3, link=4)).startswith("The motor drive, the link encoder have not answered")
    assert stop_sentence(measured(stiffness=3)).startswith("The stiffness drive has not answered")


def test_a_latched_fault_keeps_its_first_time_and_stands_while_it_is_seen() -> None:
    latch = Latch()
    assert latch.note(OVERSPEED, "4.1 rad/s", at_s=2.0, now=100.0)
    assert not latch.note(OVERSPEED, "5.0 rad/s", at_s=2.5, now=100.5)
    (report,) = latch.reports(100.6)
    assert (report.number, report.at_s, report.stands) == (OVERSPEED.number, 2.0, True)
    assert "4.1 rad/s" in report.sentence
    assert latch.standing(100.79) is not None
    assert latch.standing(100.81) is None
    assert len(latch) == 1
    latch.clear()
    assert not latch


def test_what_only_another_connection_takes_away_stands_for_ever() -> None:
    latch = Latch()
    latch.note(REBOOTED, "node 1", 0.0, 100.0)
    assert latch.standing(1e6) == REBOOTED.sentence("node 1")
