"""Reference of the stiffness motor: commanded stiffness, slewed at its permitted rate, through a third-order filter.

The filter works on theta_ms, so theta_ms'' is continuous; the torque map needs it.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vssea_core.actuator.parameters import StiffnessMechanism
from vssea_core.actuator.spring import stiffness_motor_position
from vssea_core.compiled import inlined
from vssea_core.control.law import StiffnessTarget
from vssea_core.control.tuning import Tuning
from vssea_core.signals.documents import StiffnessReference
from vssea_core.signals.smooth_step import moved

CONSTANT, MOVE = 0.0, 1.0
MAX_STIFFNESS_RATE = 3000.0  # N m/rad/s
SPEED_SHARE = 0.95  # share of the stiffness motor's speed that the slew may ask for, so that the loop keeps some
FILTER_PEAK = 2.0 * math.exp(-2.0)  # largest theta'' of the filter a unit of ramp rate and bandwidth


class Slew(NamedTuple):
    """What bounds the stiffness reference; angles of the stiffness motor [rad]."""

    kind: float
    theta_from: float
    theta_to: float
    start_s: float
    duration_s: float
    set_at_s: float
    bandwidth: float  # of the filter
    shrink: float  # exp(-bandwidth T)
    speed: float  # largest slew of theta_ms [rad/s]
    torque_reserve: float
    motor_inertia: float
    spring_constant: float


class Slewed(NamedTuple):
    """The stiffness motor's reference between two ticks: slewed command, filter output [rad], its rate and acceleration."""

    command: float
    theta: float
    rate: float
    acceleration: float


SLEW_SIZE, SLEWED_SIZE = len(Slew._fields), len(Slewed._fields)


def slew_row(
    reference: StiffnessReference,
    tuning: Tuning,
    mechanism: StiffnessMechanism,
    sample_time_s: float,
    set_at_s: float = 0.0,
) -> NDArray[np.float64]:
    """Return the numbers of a Slew for the kernel."""
    constant = tuning.model.spring_constant
    start = stiffness_motor_position(reference.stiffness, constant)
    timing = (CONSTANT, start, start, 0.0, 1.0)
    if reference.kind == "move":
        timing = (
            MOVE,
            start,
            stiffness_motor_position(reference.target, constant),
            reference.start_s,
            reference.duration_s,
        )
    return np.array(
        Slew(
            *timing,
            set_at_s,
            tuning.stiffness_loop.reference_bandwidth,
            math.exp(-tuning.stiffness_loop.reference_bandwidth * sample_time_s),
            SPEED_SHARE * mechanism.speed_limit,
            tuning.stiffness_loop.torque_reserve,
            tuning.model.motor_inertia,
            constant,
        )
    )


@inlined
def commanded(slew, now):
    """Return the commanded stiffness motor position [rad] at scenario time `now` [s]."""
    if slew.kind == CONSTANT:
        return slew.theta_to
    return moved(slew.theta_from, slew.theta_to, now - slew.set_at_s - slew.start_s, slew.duration_s).r


@inlined
def fastest_slew(slew, theta, tau_s):
    """Return the largest |d theta_ms/dt| [rad/s] at `theta` [rad] under a spring torque `tau_s` [N m]."""
    k = slew.spring_constant / (2.0 * theta * theta * theta)
    fastest = min(slew.speed, MAX_STIFFNESS_RATE * theta / (3.0 * k))
    if tau_s == 0.0:
        return fastest
    bearable = slew.torque_reserve * k * theta / (3.0 * slew.motor_inertia * abs(tau_s))
    return min(fastest, bearable / (FILTER_PEAK * slew.bandwidth))


@inlined
def advance_stiffness(slew, slewed, moves, command, tau_s, sample_time_s):
    """Return the StiffnessTarget of this tick, the Slewed of the next one, and whether the slew to `command` [rad] was limited.

    Where the command is known never to move, `moves` is False, and only what is left in the filter goes on.

    The slew obeys |dk/dt| <= 3000 N m/rad/s, the motor's speed, and, under a spring torque `tau_s` [N m], the motor torque
    3 J_e tau_s theta_ms'' / (k theta_ms) that a change costs.
    """
    target = StiffnessTarget(slewed.theta, slewed.rate, slewed.acceleration)
    w, t = slew.bandwidth, sample_time_s
    theta_0, gap = slewed.command, command - slewed.command
    limited = False
    if moves and gap != 0.0:
        farthest = t * fastest_slew(slew, theta_0, tau_s)
        limited = abs(gap) > farthest * (1.0 + 1e-9)
        if limited:
            gap = math.copysign(farthest, gap)
        theta_0 += gap

    shrink = slew.shrink
    y0 = slewed.theta - theta_0
    y1 = slewed.rate + w * y0
    y2 = slewed.acceleration + w * (2.0 * slewed.rate + w * y0)
    y0, y1, y2 = shrink * (y0 + t * (y1 + 0.5 * t * y2)), shrink * (y1 + t * y2), shrink * y2
    rate = y1 - w * y0
    return target, Slewed(theta_0, theta_0 + y0, rate, y2 - w * (2.0 * rate + w * y0)), limited
