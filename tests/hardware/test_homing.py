"""What the homing law promises, on a stiffness motor with two end stops and nothing else."""

import math

import pytest

from backend.loop.homing import HomingLaw, Stops
from backend.rigs.rig_file import Homing

STOPS = Stops(31.4, 115.7, 70.0)
SETTINGS = Homing(torque=0.10, speed=40.0, still_s=0.15)
INERTIA, DAMPING = 1e-4, 1e-4


class Axis:
    """A stiffness motor between two stops, switched on somewhere between them; positions count from there."""

    def __init__(
        self, period_s: float, low: float = 31.4, high: float = 115.7, at: float = 53.7, friction: float = 0.0
    ):
        self.period_s, self.low, self.high, self.at, self.friction = period_s, low, high, at, friction
        self.zero, self.omega, self.waiting = at, 0.0, 0.0
        self.fastest = self.hardest = 0.0

    def cycle(self, torque: float) -> float:
        """Take the torque of the cycle before, return the position at its end."""
        applied, self.waiting = self.waiting, torque
        self.hardest = max(self.hardest, abs(torque))
        steps = 20
        for _ in range(steps):
            dt = self.period_s / steps
            drag = self.friction * self.omega / math.hypot(self.omega, 0.5)
            self.omega += dt * (applied - DAMPING * self.omega - drag) / INERTIA
            self.at += dt * self.omega
            if not self.low < self.at < self.high:
                self.at = min(max(self.at, self.low), self.high)
                self.omega = 0.0
        self.fastest = max(self.fastest, abs(self.omega))
        return self.at - self.zero


def homed(axis: Axis, settings: Homing = SETTINGS, limit_s: float = 40.0) -> HomingLaw:
    law = HomingLaw(settings, STOPS, INERTIA, DAMPING, axis.period_s)
    torque = 0.0
    for _ in range(round(limit_s / axis.period_s)):
        torque = law.step(axis.cycle(torque))
        if law.phase in ("homed", "failed"):
            return law
    pytest.fail(f"still {law.phase}")


@pytest.mark.parametrize("rate_hz", [100, 250, 500, 1000])
@pytest.mark.parametrize("friction", [0.0, 0.04])
@pytest.mark.parametrize("at", [31.4, 53.7, 115.7])
def test_it_finds_both_stops_and_ends_at_rest_in_the_middle_of_the_range(
    rate_hz: int, friction: float, at: float
) -> None:
    axis = Axis(1.0 / rate_hz, at=at, friction=friction)
    law = homed(axis)
    assert law.failure == ""
    assert law.span_found == pytest.approx(84.3, abs=0.1)
    assert axis.at - axis.zero - law.offset == pytest.approx(axis.at, abs=0.1)  # theta_ms itself
    assert axis.at == pytest.approx(70.0, abs=0.5)
    assert abs(axis.omega) < 5.0


@pytest.mark.parametrize("speed", [5.0, 150.0, 400.0])
def test_any_speed_ends_at_rest_in_the_middle(speed: float) -> None:
    axis = Axis(0.002)
    assert homed(axis, SETTINGS.model_copy(update={"speed": speed, "time_limit_s": 60.0}), 60.0).phase == "homed"
    assert axis.at == pytest.approx(70.0, abs=0.5)
    assert abs(axis.omega) < 5.0


def test_it_stays_within_its_torque_and_near_its_speed() -> None:
    axis = Axis(0.002)
    homed(axis)
    assert axis.hardest <= 0.10
    assert 30.0 < axis.fastest < 60.0


def test_a_span_that_differs_too_much_fails_with_both_figures() -> None:
    law = homed(Axis(0.002, high=113.0))
    assert law.phase == "failed"
    assert "81.6 rad apart" in law.failure
    assert "84.3 ± 1.7 rad" in law.failure


def test_a_span_within_the_tolerance_is_taken() -> None:
    assert homed(Axis(0.002, high=114.7)).phase == "homed"


def test_an_axis_that_cannot_move_fails_by_its_span() -> None:
    law = homed(Axis(0.002, friction=0.2))
    assert law.phase == "failed"
    assert "apart" in law.failure


def test_an_axis_without_a_stop_fails_before_it_has_turned_for_ever() -> None:
    axis = Axis(0.002, low=-1e6)
    law = homed(axis)
    assert law.phase == "failed"
    assert "no stop within" in law.failure
    assert axis.zero - axis.at < 1.6 * 84.3


def test_an_axis_that_is_too_slow_fails_by_the_clock_with_what_it_was_doing() -> None:
    law = homed(Axis(0.002), SETTINGS.model_copy(update={"time_limit_s": 2.0}))
    assert law.phase == "failed"
    assert "not done within 2 s, still looking for the soft stop" in law.failure


def test_once_homed_or_failed_it_asks_for_no_torque() -> None:
    axis = Axis(0.002)
    law = homed(axis)
    assert law.step(3.0) == 0.0
    failed = homed(Axis(0.002, high=100.0))
    assert failed.step(3.0) == 0.0
