"""Whether a rig may be armed: every check with its sentence, so that the page can say beforehand what would refuse it."""

from typing import NamedTuple

from backend.loop.axes import NAMES, Axes
from backend.loop.freshness import BRIDGED, missing, oldest
from backend.loop.latch import Latch
from backend.rigs.rig import AXES, Measured
from backend.rigs.rig_file import Limits

BLEND_S = 0.1
"""Time [s] over which the motor's torque is blended in."""
ENABLE_S = 1.0
"""Time [s] in which both drives have to come into operation."""
MOVING_LINK, MOVING_MOTOR, MOVING_STIFFNESS = 0.2, 0.05, 5.0
"""rad/s above which link, motor and stiffness motor count as moving."""


class Situation(NamedTuple):
    """What the checks look at."""

    measured: Measured
    homed: bool
    speeds: tuple[float, float, float]  # link, motor, stiffness motor [rad/s]
    theta_ms: tuple[float, float]  # permitted, stiff and soft [rad]
    tuning_period_s: float
    period_s: float
    lease_left_s: float


def reasons(situation: Situation, limits: Limits, axes: Axes, latch: Latch) -> tuple[str, ...]:
    """Return why the rig cannot be armed now, each in a clause; empty = it can."""
    return tuple(_reasons(situation, limits, axes, latch))


def _reasons(now: Situation, limits: Limits, axes: Axes, latch: Latch) -> list[str]:
    found = []
    if latch:
        found.append("a fault is latched; clear its cause and reset it")
    if not now.homed:
        found.append("the stiffness axis is not homed; home it")
    if oldest(now.measured) >= BRIDGED:
        found.append(f"{missing(now.measured, BRIDGED)} did not answer in this cycle; check the bus")
    found += [
        f"the {NAMES[axis]} is not ready ({axes.status[axis].words}); look at its status"
        for axis in AXES
        if axes.status[axis].state not in ("disabled", "enabled", "stopping")
    ]
    found += _outside(now, limits)
    for name, speed, most in zip(
        ("link", "motor", "stiffness motor"), now.speeds, (MOVING_LINK, MOVING_MOTOR, MOVING_STIFFNESS), strict=True
    ):
        if abs(speed) > most:
            found.append(f"the {name} moves at {speed:.2f} rad/s, expected less than {most:g}; let it come to rest")
    if abs(now.tuning_period_s - now.period_s) > 1e-9:
        found.append(
            f"the tuning is made for cycles of {now.tuning_period_s * 1e3:g} ms and the rig runs at "
            f"{now.period_s * 1e3:g} ms; try a tuning of the rig's rate"
        )
    if now.lease_left_s <= 0.0:
        found.append("nobody is in control; take control")
    return found


def _outside(now: Situation, limits: Limits) -> list[str]:
    if not now.homed:
        return []
    found = []
    m = now.measured
    if not limits.link_low <= m.link_position <= limits.link_high:
        found.append(
            f"the link is at {m.link_position:.3f} rad, expected {limits.link_low:g} to {limits.link_high:g}; move it by hand"
        )
    deflection = m.motor_position - m.link_position
    if abs(deflection) > limits.deflection:
        found.append(f"the spring is deflected by {deflection:.3f} rad, limit {limits.deflection:g}; take the load off")
    stiff, soft = now.theta_ms
    slack = 0.01 * (soft - stiff)
    if not stiff - slack <= m.stiffness_position <= soft + slack:
        found.append(
            f"the stiffness motor is at {m.stiffness_position:.1f} rad, expected {stiff:.1f} to {soft:.1f}; home it again"
        )
    return found
