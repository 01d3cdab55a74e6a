"""The controlled stop of a rig whose spring stores energy (decision 15), and what is left of it afterwards.

The motor is braked by damping while the stiffness axis holds; when it is slow, or after 0.6 s, its torque goes to zero within
50 ms and the motor is disabled. The stiffness axis goes on holding for as long as the spring is loaded. An axis that cannot be
controlled any more is left to its drive's own quick stop.
"""

from typing import NamedTuple

from backend.loop.axes import Axes
from backend.rigs.rig import Axis

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
    """What a stop looks at in one cycle."""

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
        for axis in ("motor", "stiffness"):
            if not axes.enabled(axis):
                axes.disarm(axis)

    def leave_to_drive(self, axis: Axis, now: float) -> None:
        """Let the drive stop an axis by itself: what it measures or gives can be trusted no more."""
        if self._axes.on(axis) and axis not in self._left_s:
            self._left_s[axis] = now
            self._axes.stop(axis)

    def step(self, moment: Moment) -> Course:
        """Go on by one cycle and return what it asks for."""
        now = moment.now
        for axis in [axis for axis, since in self._left_s.items() if now - since >= QUICK_STOP_S]:
            del self._left_s[axis]
            self._axes.disarm(axis)
        brakes, share = self._brake(moment)
        if self._motor_off_s is None and not self._axes.on("motor") and "motor" not in self._left_s:
            self._motor_off_s = now
        return Course(brakes, share, self._hold(moment))

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

    def _hold(self, moment: Moment) -> bool:
        if not self._axes.enabled("stiffness"):
            return False
        if abs(moment.spring_torque) > UNLOADED_NM:
            self._unloaded_since = None
        elif self._unloaded_since is None:
            self._unloaded_since = moment.now
        unloaded = self._unloaded_since is not None and moment.now - self._unloaded_since >= UNLOADED_S
        if self._motor_off_s is not None and unloaded:
            self._axes.disarm("stiffness")
            return False
        return True

    @property
    def holding(self) -> bool:
        """Whether the stiffness axis holds."""
        return self._axes.enabled("stiffness")

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
