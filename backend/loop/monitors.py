"""What must never be true of a rig that runs, looked at once a cycle: measurements against what physics and limits allow.

Each check needs no more than what was measured and what the observer says; those that can be a flicker have to last.
"""

import math
from typing import NamedTuple

from backend.loop.axes import Found
from backend.loop.travel import Jump, Speed, Stillness
from backend.rigs.faults import (
    DEFLECTION,
    DISTURBANCE,
    END_STOP,
    FOLLOWING,
    LEAF_TORQUE,
    LINK_FROZEN,
    LINK_JUMP,
    LINK_OVERSPEED,
    MOTOR_FROZEN,
    MOTOR_JUMP,
    NOT_A_NUMBER,
    OUTSIDE,
    OVERSPEED,
    STIFFNESS_ASTRAY,
    STIFFNESS_JUMP,
    TORQUE_NOT_GIVEN,
)  # fmt: skip
from backend.rigs.rig import Measured
from backend.rigs.rig_file import Homing, Limits
from vssea_core.actuator.parameters import Actuator
from vssea_core.actuator.spring import stiffness_motor_position

TOO_MUCH = 1.25
"""Times a limit of speed or deflection that is a fault."""
OUTSIDE_RAD = 0.05
"""rad beyond the link's limits that braking may take."""
STOP_SHARE = 0.25
"""Share of the way from the permitted range to the end stop that is as good as the stop."""
FOLLOWING_S, MISMATCH_S, NOT_GIVEN_S, LEAF_S = 0.2, 0.05, 0.1, 0.02
FOLLOWING_LEAK = 0.25
FROZEN_S, FROZEN_MOTOR_RAD, FROZEN_LINK_RAD = 0.1, 0.03, 0.06
ASTRAY_S, ASTRAY_TORQUE = 0.03, 2.0
"""A disturbance of this many times the homing torque, which overcomes the screw's friction, is no friction."""
SPEED_S, TORQUE_S = 0.01, 0.03
"""Time constants over which the encoder's speed and the torques are averaged before they are judged."""


class Seen(NamedTuple):
    """One cycle as the monitors look at it; torques N m, angles rad."""

    measured: Measured
    error: float  # reference minus link
    spring_torque: float
    stiffness: float
    link_disturbance: float
    motor_disturbance: float
    stiffness_disturbance: float
    homed: bool
    driven: bool  # an axis is enabled
    closed: bool  # the loops are closed and the torque is blended in
    obeying: tuple[bool, bool]
    """Motor and stiffness drive give what the loop asks, not what they brake with by themselves."""
    cycles: float = 1.0
    """Cycles since the last look, by the clock: a loop that was late finds an axis farther on."""


class Monitors:
    """All of them, with what they remember from one cycle to the next."""

    def __init__(self, limits: Limits, homing: Homing, actuator: Actuator, period_s: float) -> None:
        self._limits, self._actuator, self._period_s = limits, actuator, period_s
        self._astray_from = ASTRAY_TORQUE * homing.torque
        mechanism = actuator.stiffness
        constant = mechanism.spring_constant
        stiff, soft = (stiffness_motor_position(k, constant) for k in (mechanism.stiffest, mechanism.softest))
        self._stiff = stiff + STOP_SHARE * (stiffness_motor_position(limits.stiffness_high, constant) - stiff)
        self._soft = soft - STOP_SHARE * (soft - stiffness_motor_position(limits.stiffness_low, constant))
        self._following = Lasting(FOLLOWING_S, period_s, FOLLOWING_LEAK)
        self._mismatch = Lasting(MISMATCH_S, period_s)
        self._leaf = Lasting(LEAF_S, period_s)
        self._astray = Lasting(ASTRAY_S, period_s)
        self._not_given = {"motor": Lasting(NOT_GIVEN_S, period_s), "stiffness": Lasting(NOT_GIVEN_S, period_s)}
        self.restart()

    def restart(self) -> None:
        """Forget what was seen, as after homing and before arming."""
        spring = TOO_MUCH * self._limits.deflection * self._limits.stiffness_high / self._actuator.link.inertia
        motor = 2.0 * self._limits.motor_torque / self._actuator.motor.inertia
        stiffness = 2.5 * self._limits.stiffness_speed  # a stop throws it back at once
        self._link_jump = Jump(5.0, spring, self._period_s)
        self._motor_jump = Jump(0.5 * self._limits.motor_speed, motor, self._period_s)
        self._stiffness_jump = Jump(stiffness, 0.0, self._period_s)
        self._link_still = Stillness(FROZEN_S, self._period_s)
        self._motor_still = Stillness(FROZEN_S, self._period_s)
        self._motor, self._link = (Speed(SPEED_S, self._period_s) for _ in range(2))
        self._torques = [0.0, 0.0, 0.0, 0.0]  # taken and seen of motor and stiffness axis, averaged
        for lasting in (self._following, self._mismatch, self._leaf, self._astray, *self._not_given.values()):
            lasting.restart()

    def look(self, seen: Seen) -> Found:
        """Return every fault whose condition is fulfilled in this cycle, with its figures."""
        found: Found = []
        self._look_at_jumps(seen, found)
        self._look_at_speeds(seen, found)
        if seen.homed:
            self._look_at_positions(seen, found)
        self._look_at_torques(seen, found)
        self._look_at_loop(seen, found)
        return found

    def _look_at_jumps(self, seen: Seen, found: Found) -> None:
        m = seen.measured
        jumps = (
            (LINK_JUMP, self._link_jump, m.link_position, m.link_age),
            (MOTOR_JUMP, self._motor_jump, m.motor_position, m.motor_age),
            (STIFFNESS_JUMP, self._stiffness_jump, m.stiffness_position, m.stiffness_age),
        )
        for fault, jump, position, age in jumps:
            if age == 0:
                if position != position:
                    found.append((NOT_A_NUMBER, f"{fault.name.split('_')[0]} encoder"))
                elif jump.happened(position, seen.cycles):
                    found.append((fault, f"by {jump.by:.3g} rad, at most {jump.most:.3g}"))
            else:
                jump.miss(seen.cycles)

    def _look_at_speeds(self, seen: Seen, found: Found) -> None:
        m, limits = seen.measured, self._limits
        self._motor.take(m.motor_position, m.motor_age, seen.cycles)
        if any(fault is LINK_JUMP for fault, _ in found):
            self._link = Speed(SPEED_S, self._period_s)  # a jump of the encoder is no speed of the link
        self._link.take(m.link_position, m.link_age, seen.cycles)
        if seen.driven and abs(self._motor.value) > TOO_MUCH * limits.motor_speed:
            found.append((OVERSPEED, f"{self._motor.value:.2f} rad/s, limit {limits.motor_speed:g}"))
        if seen.closed and abs(self._link.value) > limits.link_speed:
            found.append((LINK_OVERSPEED, f"{self._link.value:.2f} rad/s, limit {limits.link_speed:g}"))

    @property
    def motor_speed(self) -> float:
        """Speed of the motor [rad/s] by its encoder alone, averaged."""
        return self._motor.value

    def _look_at_positions(self, seen: Seen, found: Found) -> None:
        m, limits = seen.measured, self._limits
        if not limits.link_low - OUTSIDE_RAD <= m.link_position <= limits.link_high + OUTSIDE_RAD:
            found.append(
                (OUTSIDE, f"link at {m.link_position:.3f} rad, limits {limits.link_low:g} to {limits.link_high:g}")
            )
        deflection = m.motor_position - m.link_position
        if abs(deflection) > TOO_MUCH * limits.deflection:
            found.append((DEFLECTION, f"{deflection:.3f} rad, limit {limits.deflection:g}"))
        bears = self._actuator.stiffness.leaf_torque * (max(seen.stiffness, 0.0) / 1000.0) ** (1.0 / 3.0)
        if self._leaf(abs(seen.spring_torque) > bears):
            found.append((LEAF_TORQUE, f"{seen.spring_torque:.1f} N·m, {bears:.1f} at {seen.stiffness:.0f} N·m/rad"))
        if seen.driven and not self._stiff <= m.stiffness_position <= self._soft:
            found.append((END_STOP, f"θ_ms at {m.stiffness_position:.1f} rad"))

    def _look_at_torques(self, seen: Seen, found: Found) -> None:
        m = seen.measured
        share = min(1.0, self._period_s / TORQUE_S)
        values = (m.motor_torque, m.motor_torque_seen, m.stiffness_torque, m.stiffness_torque_seen)
        for place, value in enumerate(values):
            if value == value:  # a drive that does not say what it gives says NaN
                self._torques[place] += share * (value - self._torques[place])
        asked_e, given_e, asked_ms, given_ms = self._torques
        axes = (
            ("motor", asked_e, given_e, self._limits.motor_torque, seen.obeying[0], m.motor_torque_seen),
            ("stiffness", asked_ms, given_ms, self._limits.stiffness_torque, seen.obeying[1], m.stiffness_torque_seen),
        )
        for axis, asked, given, limit, obeying, told in axes:
            short = obeying and told == told and abs(asked - given) > 0.04 * limit + 0.15 * abs(asked)
            if self._not_given[axis](short):
                found.append((TORQUE_NOT_GIVEN, f"{axis} drive: asked {asked:.3g} N·m, given {given:.3g}"))

    def _look_at_loop(self, seen: Seen, found: Found) -> None:
        limits = self._limits
        if self._following(seen.closed and abs(seen.error) > limits.following_error):
            found.append((FOLLOWING, f"{seen.error:.3f} rad, allowed {limits.following_error:g} for {FOLLOWING_S:g} s"))
        most = max(abs(seen.link_disturbance), abs(seen.motor_disturbance))
        if self._mismatch(seen.closed and most > limits.motor_torque):
            found.append((DISTURBANCE, f"{most:.0f} N·m, limit {limits.motor_torque:g}"))
        if self._astray(seen.closed and abs(seen.stiffness_disturbance) > self._astray_from):
            words = f"{seen.stiffness_disturbance:.2f} N·m are missing, allowed {self._astray_from:.2g}"
            found.append((STIFFNESS_ASTRAY, words))
        self._look_at_stillness(seen, found)

    def _look_at_stillness(self, seen: Seen, found: Found) -> None:
        m = seen.measured
        if not seen.closed:
            self._link_still.restart()
            self._motor_still.restart()
        elif m.link_age == 0 and m.motor_age == 0:
            moved = self._link_still.other_moved(m.link_position, m.motor_position)
            if moved > FROZEN_MOTOR_RAD:
                found.append((LINK_FROZEN, f"for {FROZEN_S:g} s or more; the motor moved {moved:.3f} rad"))
            moved = self._motor_still.other_moved(m.motor_position, m.link_position)
            if moved > FROZEN_LINK_RAD:
                found.append((MOTOR_FROZEN, f"for {FROZEN_S:g} s or more; the link moved {moved:.3f} rad"))


class Lasting:
    """Whether a condition has been fulfilled for some time, without a break; or, with a `leak`, most of the time.

    With a leak the time runs back by that share while the condition is not fulfilled, so that an oscillation counts too.
    """

    def __init__(self, for_s: float, period_s: float, leak: float = math.inf) -> None:
        self._needed, self._leak = max(1, round(for_s / period_s)), leak
        self._cycles = 0.0

    def __call__(self, condition: bool) -> bool:
        self._cycles = self._cycles + 1.0 if condition else max(0.0, self._cycles - self._leak)
        return self._cycles >= self._needed

    def restart(self) -> None:
        """Start counting anew."""
        self._cycles = 0.0
