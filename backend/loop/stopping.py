"""The controlled stop of a rig whose spring stores energy (decision 15), and what is left of it afterwards.

The motor is braked by damping while the stiffness axis holds; when it is slow, or after 0.6 s, its torque goes to zero within
50 ms and the motor is disabled. The stiffness axis goes on holding for as long as the spring is loaded. An axis that cannot be
controlled any more is left to its drive's own quick stop.
"""

from typing import NamedTuple

from backend.loop.axes import Axes
from backend.rigs.rig import AXES, Axis

BRAKES_S, RAMP_S = 0.6, 0.05
SLOW_RAD_S, SLOW_S = 0.02, 0.02
UNLOADED_NM, UNLOADED_S = 1.0, 0.1
"""Spring torque below which, for so long, the stiffness axis need not hold."""
QUICK_STOP_S = 0.5
HOLDS_ON_S = 1.0
"""A stop is over this long after the motor is off even if the stiffness axis goes on holding."""

LONGEST_S = 2.5
"""A stop is over after this time whatever the drives say: they have been told to be off."""


class Moment(NamedTuple):
    """What a stop looks at in one cycle; a spring torque [N m] that nobody knows is NaN."""

    now: float
    motor_speed: float
    spring_torque: float


class Course(NamedTuple):
    """What a cycle of a stop asks for: brake the motor (with a share of it), hold the stiffness axis."""

    brakes: bool
    share: float
    holds: bool


class Stopping:
    """One stop, from when it is asked for until both axes are off."""

    def __init__(self, axes: Axes, now: float) -> None:
        self._axes = axes
        self._began = now
        self._slow_since: float | None = None
        self._ramp_from: float | None = None
        self._unloaded_since: float | None = None
        self._left_s: dict[Axis, float] = {}  # since when an axis is left to its drive
        self._motor_off_s: float | None = None
        self._watch_drives(now)
        for axis in AXES:
            if not axes.enabled(axis) and axis not in self._left_s:
                axes.disarm(axis)

    def leave_to_drive(self, axis: Axis, now: float) -> None:
        """Let the drive stop an axis by itself: what it measures or gives can be trusted no more."""
        if self._axes.on(axis) and axis not in self._left_s:
            self._left_s[axis] = now
            self._axes.stop(axis)

    def _watch_drives(self, now: float) -> None:
        """Let a drive go on that has begun to stop its axis by itself, as after a silence of this computer."""
        for axis in AXES:
            if self._axes.status[axis].state == "stopping":
                self.leave_to_drive(axis, now)

    def step(self, moment: Moment) -> Course:
        """Go on by one cycle and return what it asks for."""
        now = moment.now
        self._watch_drives(now)
        if now - self._left_s.get("motor", now) >= QUICK_STOP_S:
            del self._left_s["motor"]
            self._axes.disarm("motor")
        brakes, share = self._brake(moment)
        if self._motor_off_s is None and not self._axes.on("motor") and "motor" not in self._left_s:
            self._motor_off_s = now
        unloaded = self._unloaded(moment)
        if unloaded and now - self._left_s.get("stiffness", now) >= QUICK_STOP_S:
            del self._left_s["stiffness"]
            self._axes.disarm("stiffness")
        if unloaded and self._axes.enabled("stiffness"):
            self._axes.disarm("stiffness")
        return Course(brakes, share, self._axes.enabled("stiffness"))

    def _unloaded(self, moment: Moment) -> bool:
        """Return whether the motor is off and the spring has been known to carry nothing for a while."""
        if not abs(moment.spring_torque) <= UNLOADED_NM:  # not a number: nobody knows
            self._unloaded_since = None
        elif self._unloaded_since is None:
            self._unloaded_since = moment.now
        since = self._unloaded_since
        return self._motor_off_s is not None and since is not None and moment.now - since >= UNLOADED_S

    def _brake(self, moment: Moment) -> tuple[bool, float]:
        if not self._axes.enabled("motor"):
            return False, 0.0
        now = moment.now
        if abs(moment.motor_speed) > SLOW_RAD_S:
            self._slow_since = None
        elif self._slow_since is None:
            self._slow_since = now
        slow = self._slow_since is not None and now - self._slow_since >= SLOW_S
        if self._ramp_from is None and (slow or now - self._began >= BRAKES_S):
            self._ramp_from = now
        share = 1.0 if self._ramp_from is None else max(0.0, 1.0 - (now - self._ramp_from) / RAMP_S)
        if share == 0.0:
            self._axes.disarm("motor")
        return share > 0.0, share

    @property
    def holding(self) -> bool:
        """Whether the stiffness axis holds, by the loop or by its drive."""
        return self._axes.enabled("stiffness") or "stiffness" in self._left_s

    @property
    def off(self) -> bool:
        """Whether both axes are off."""
        return not self._axes.any_on and not self._left_s

    def over(self, now: float) -> bool:
        """Return whether the stop is over: both axes off, or the motor off and the spring loaded for good."""
        if self.off or now - self._began >= LONGEST_S:
            return True
        return self._motor_off_s is not None and now - self._motor_off_s >= HOLDS_ON_S


class Release:
    """The end of a homing that was broken off: its torque goes to zero within RAMP_S, then the axis is disabled."""

    def __init__(self, axes: Axes, torque: float, now: float) -> None:
        self._axes, self._torque, self._began = axes, torque, now
        self._told = False
        if not axes.enabled("stiffness"):
            axes.disarm("stiffness")

    def torque(self, now: float) -> float:
        """Return the torque [N m] of this cycle."""
        share = max(0.0, 1.0 - (now - self._began) / RAMP_S)
        if share == 0.0 and not self._told:
            self._told = True
            self._axes.disarm("stiffness")
        return self._torque * share if self._axes.enabled("stiffness") else 0.0

    def over(self, now: float) -> bool:
        """Return whether the axis is off, or was told so long ago."""
        return self._told and (not self._axes.any_on or now - self._began >= HOLDS_ON_S)
