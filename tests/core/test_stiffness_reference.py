"""The stiffness reference obeys its limits, has a continuous second derivative and ends at the command."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vssea_core.actuator.parameters import StiffnessMechanism
from vssea_core.actuator.spring import stiffness_motor_position
from vssea_core.control.tuning import StiffnessLoop, Tuning
from vssea_core.signals.documents import ConstantStiffness, MoveStiffness
from vssea_core.signals.stiffness import MAX_STIFFNESS_RATE, Slew, Slewed, advance_stiffness, commanded, slew_row

T, MECHANISM = 1e-3, StiffnessMechanism()
stiffnesses = st.floats(20.0, 1000.0)


def course(
    first: float, reference: ConstantStiffness | MoveStiffness, tau_s: float = 0.0, tuning: Tuning | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Targets (n, 3) and slew flags over 3 s under a spring torque, from rest at stiffness `first`."""
    tuning = tuning or Tuning()
    slew = Slew(*slew_row(reference, tuning, MECHANISM, T))
    at = stiffness_motor_position(first, MECHANISM.spring_constant)
    slewed, targets, flags = Slewed(at, at, 0.0, 0.0), [], []
    for k in range(3000):
        target, slewed, limited = advance_stiffness(slew, slewed, True, commanded(slew, k * T), tau_s, T)
        targets.append(target)
        flags.append(limited)
    return np.array(targets), np.array(flags)


@given(first=stiffnesses, last=stiffnesses)
@settings(deadline=None, max_examples=25)
def test_a_command_is_reached_within_the_limits_of_rate_and_speed(first: float, last: float) -> None:
    targets, flags = course(first, ConstantStiffness(stiffness=last))
    theta = targets[:, 0]
    k = MECHANISM.spring_constant / (2.0 * theta**3)
    assert k[-1] == pytest.approx(last, rel=1e-6)
    assert np.abs(targets[:, 1]).max() < MECHANISM.speed_limit
    # the filter lags behind the slewed command, so it may follow a rate that was right a little before
    assert np.abs(np.diff(k)).max() / T <= 1.5 * MAX_STIFFNESS_RATE
    assert min(first, last) * (1.0 - 1e-9) <= k.min()
    assert k.max() <= max(first, last) * (1.0 + 1e-9)
    assert not flags[-1]


def test_the_full_range_takes_about_the_time_that_the_motors_speed_allows() -> None:
    """Section 4: about 0.42 s, and the filter's delay of 3/w behind it."""
    targets, flags = course(20.0, ConstantStiffness(stiffness=1000.0))
    assert 0.38 < flags.sum() * T < 0.48
    settled = stiffness_motor_position(1000.0, MECHANISM.spring_constant)
    late = np.argmax(np.abs(targets[:, 0] - settled) < 0.01 * settled) * T
    assert flags.sum() * T < late < flags.sum() * T + 8.0 / Tuning().stiffness_loop.reference_bandwidth


@given(first=stiffnesses, last=stiffnesses)
@settings(deadline=None, max_examples=20)
def test_rate_and_acceleration_are_the_derivatives_of_the_position(first: float, last: float) -> None:
    targets, _ = course(first, ConstantStiffness(stiffness=last))
    theta, rate, acceleration = targets.T
    assert np.allclose(theta[0] + np.cumsum((rate[1:] + rate[:-1]) * T / 2.0), theta[1:], atol=0.02)
    assert np.allclose(np.cumsum((acceleration[1:] + acceleration[:-1]) * T / 2.0), rate[1:] - rate[0], atol=2.0)
    # a jump of the ramp's rate, at most twice the speed limit, moves theta'' by w^2 T of it in a sample
    w = Tuning().stiffness_loop.reference_bandwidth
    assert np.abs(np.diff(acceleration)).max() < 2.0 * MECHANISM.speed_limit * w**2 * T


@given(tau_s=st.floats(1.0, 25.0), reserve=st.floats(1.0, 40.0), last=st.floats(30.0, 150.0))
@settings(deadline=None, max_examples=25)
def test_under_load_a_change_costs_no_more_motor_torque_than_is_reserved(
    tau_s: float, reserve: float, last: float
) -> None:
    tuning = Tuning(stiffness_loop=StiffnessLoop(torque_reserve=reserve))
    targets, flags = course(500.0, ConstantStiffness(stiffness=last), tau_s, tuning)
    theta, _, acceleration = targets.T
    k = MECHANISM.spring_constant / (2.0 * theta**3)
    cost = 3.0 * tuning.model.motor_inertia * tau_s * np.abs(acceleration) / (k * theta)
    assert flags.any()
    assert cost.max() < 1.3 * reserve


def test_a_slow_move_is_not_limited_and_follows_its_polynomial() -> None:
    targets, flags = course(200.0, MoveStiffness(stiffness=200.0, target=400.0, start_s=0.2, duration_s=1.5))
    assert not flags.any()
    ends = [stiffness_motor_position(k, MECHANISM.spring_constant) for k in (200.0, 400.0)]
    assert targets[100, 0] == ends[0]
    assert targets[-1, 0] == pytest.approx(ends[1])
    assert np.abs(targets[:, 1]).max() == pytest.approx(315.0 / 128.0 * abs(ends[1] - ends[0]) / 1.5, rel=0.02)
