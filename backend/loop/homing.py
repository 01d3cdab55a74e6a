"""The law that homes the stiffness axis: slowly into the stiff stop, then the soft one, then to the middle of the range.

Pure: a position in, a torque out, once a cycle. The axis is driven at a velocity with a torque that can do no harm; a stop is
where it stands still although that torque pushes. The stiff stop is at a smaller theta_ms than the soft one.
"""

import math
from dataclasses import dataclass

from backend.rigs.rig_file import Homing

BANDWIDTH = 60.0  # rad/s of the velocity loop, less where the cycle is long
STILL_RAD = 0.05  # rad within which the axis counts as standing
TOO_FAR = 1.5  # times the expected span without a stop is none
AT_REST_RAD, AT_REST_RAD_S = 0.3, 2.0  # rad, rad/s: near enough to the middle, and slow enough
BRAKING_SHARE = 0.4  # of the torque, that braking before the middle counts on
PUSHING = 0.99  # share of the torque from which it counts as pushing

WORDS = {
    "stiff": "looking for the stiff stop",
    "soft": "looking for the soft stop",
    "middle": "going to the middle of the range",
    "homed": "homed",
    "failed": "homing failed",
}


@dataclass(frozen=True)
class Stops:
    """Where theta_ms [rad] should be at the stiff and the soft stop, and where homing is to end."""

    stiff: float
    soft: float
    middle: float


class HomingLaw:
    """Homes one axis of `inertia` [kg m^2] and `damping` [N m s/rad], cycle by cycle of `period_s`."""

    def __init__(self, settings: Homing, stops: Stops, inertia: float, damping: float, period_s: float) -> None:
        self._settings, self._stops, self._damping, self._period_s = settings, stops, damping, period_s
        self._bandwidth = min(BANDWIDTH, 0.15 / period_s)
        self._inertia, self._gain = inertia, inertia * self._bandwidth
        self.phase = "stiff"
        self.failure = ""
        self.offset, self.span_found = 0.0, 0.0
        self._cycles = self._still = 0
        self._before: float | None = None
        self._began = self._anchor = self._stiff_at = 0.0
        self._velocity = self._integral = self._torque = 0.0

    @property
    def words(self) -> str:
        """What it does, in words."""
        return WORDS[self.phase]

    def step(self, position: float) -> float:
        """Return the torque [N m] for the next cycle at a measured position [rad]; 0 once homed or failed."""
        self._cycles += 1
        if self._before is None:
            self._before = self._began = self._anchor = position
        self._velocity += 0.5 * ((position - self._before) / self._period_s - self._velocity)
        self._before = position
        self._look(position)
        if self.phase in ("homed", "failed"):
            return 0.0
        if self._cycles * self._period_s > self._settings.time_limit_s:
            return self._fail(f"not done within {self._settings.time_limit_s:g} s, still {self.words}")
        self._torque = self._drive(self._wanted_velocity(position))
        return self._torque

    def _look(self, position: float) -> None:
        if self.phase == "middle":
            near = abs(position - self._middle) < AT_REST_RAD and abs(self._velocity) < AT_REST_RAD_S
            self._still = self._still + 1 if near else 0
            if self._long_still:
                self.phase = "homed"
            return
        pushing = abs(self._torque) >= PUSHING * self._settings.torque
        if abs(position - self._anchor) > STILL_RAD or not pushing:
            self._anchor, self._still = position, 0
        else:
            self._still += 1
        if self._long_still:
            self._found(position)
        elif abs(position - self._began) > TOO_FAR * self._expected:
            self._fail(
                f"no stop within {abs(position - self._began):.1f} rad, expected a span of {self._expected:.1f} rad"
            )

    def _found(self, position: float) -> None:
        if self.phase == "stiff":
            self.phase, self._stiff_at = "soft", position
            self._began = position
        else:
            self.span_found = position - self._stiff_at
            self.offset = self._stiff_at - self._stops.stiff
            allowed = self._settings.span_tolerance * self._expected
            if abs(self.span_found - self._expected) > allowed:
                self._fail(
                    f"the stops are {self.span_found:.1f} rad apart, expected {self._expected:.1f} ± {allowed:.1f} rad"
                )
                return
            self.phase = "middle"
        self._still, self._integral, self._anchor = 0, 0.0, position

    @property
    def _expected(self) -> float:
        return self._stops.soft - self._stops.stiff

    @property
    def _middle(self) -> float:
        return self._stops.middle + self.offset

    @property
    def _long_still(self) -> bool:
        return self._still * self._period_s >= self._settings.still_s

    def _wanted_velocity(self, position: float) -> float:
        speed = self._settings.speed
        if self.phase == "middle":
            way = self._middle - position
            brakes = math.sqrt(2.0 * BRAKING_SHARE * self._settings.torque / self._inertia * abs(way))
            return math.copysign(min(speed, brakes, 0.25 * self._bandwidth * abs(way)), way)
        return -speed if self.phase == "stiff" else speed

    def _drive(self, wanted: float) -> float:
        most = self._settings.torque
        error = wanted - self._velocity
        step = 0.25 * self._gain * self._bandwidth * self._period_s * error
        self._integral = max(-most, min(most, self._integral + step))
        return max(-most, min(most, self._gain * error + self._damping * self._velocity + self._integral))

    def _fail(self, why: str) -> float:
        self.phase, self.failure = "failed", why
        return 0.0
