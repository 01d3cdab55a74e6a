"""What the link is told to do: hold, jog, go to a position, follow a reference; and the words for it."""

from typing import Literal, Protocol

import numpy as np

from backend.loop.messages import JOG_LASTS_S, Moved
from backend.rigs.rig_file import Limits
from vssea_core.control.law import Target
from vssea_core.scenario import Scenario
from vssea_core.signals.documents import ConstantStiffness, JogReference, MoveReference, Reference, StiffnessReference
from vssea_core.signals.references import TRANSITION_SIZE, change_reference, reference_row

STIFFNESS_STEP_S = 0.02
"""A jogged stiffness is commanded anew this often; the reference filter behind it makes it smooth."""
NEAR_ENOUGH = 0.2
"""rad that a reference may start away from where the link is held."""
CHANGE_WITHIN = 0.5
"""rad that a reference set while another is followed may be away; the transition then asks for 1.2 rad/s at most."""
SHORTEST = 1e-3
"""rad below which a way is none."""
AT_REST = Target(1e-3, 1e-3, 0.05, 1.0, 50.0)
"""Distance and derivatives of a reference below which it rests."""
EDGE = 0.01
"""rad before the link's limit at which a jog comes to rest."""
TORQUE_SHARE = 0.4
"""Share of the motor's torque that acceleration and snap of a jog may each cost."""

Kind = Literal["holding", "following", "jogging", "going", "halting"]


class Moving(Protocol):
    """What of a Controller a motion needs."""

    scenario: Scenario

    @property
    def time_s(self) -> float: ...
    def set_reference(self, reference: Reference) -> None: ...
    def set_stiffness(self, reference: StiffnessReference) -> None: ...
    def hold(self) -> None: ...
    def reference_now(self) -> Target: ...


class Motion:
    """The motion in force and what ends it; `now` is the loop's clock [s]."""

    def __init__(self, controller: Moving, limits: Limits) -> None:
        self._controller, self._limits = controller, limits
        self.kind: Kind = "holding"
        self.wanted: Reference = controller.scenario.reference
        self._velocity = 0.0
        self._target = 0.0
        self._ends_s = 0.0
        self._stiffness_rate = 0.0
        self._stiffness = 0.0
        self._stepped_s = 0.0
        self.moved: list[Moved] = []

    @property
    def moving(self) -> bool:
        """Whether anything but holding is going on."""
        return self.kind != "holding" or self._stiffness_rate != 0.0

    @property
    def words(self) -> str:
        """What the link does, in words."""
        if self.kind == "jogging":
            return f"jogging {self._velocity:.2f} rad/s"
        if self.kind == "going":
            return f"going to {self._target:.3f} rad"
        if self.kind == "following":
            return "tracking"
        if self.kind == "halting":
            return "coming to rest"
        if self._stiffness_rate != 0.0:
            return f"stiffness changing by {self._stiffness_rate:.0f} N·m/rad a second"
        return f"holding {self._controller.reference_now().r:.3f} rad"

    def begin(self) -> None:
        """Hold, because the loops have just been closed where the rig was."""
        self.kind, self._stiffness_rate = "holding", 0.0
        self._tell("reference", "armed")
        self._tell("stiffness_reference", "armed")

    def end(self) -> None:
        """Forget what was going on, because the loops are open."""
        self.kind, self._stiffness_rate = "holding", 0.0

    def hold(self, why: str = "hold") -> None:
        """Come to rest within acceleration, jerk and snap."""
        self._release_stiffness(why)
        if self.kind != "holding":
            self._controller.hold()
            self.kind = "halting"
            self._tell("reference", why)

    def set_reference(self, reference: Reference) -> None:
        """Keep a reference for `follow`; while following, change to it at once. Raises ValueError if it is too far away then."""
        if self.kind == "following":
            self._check_start(reference, CHANGE_WITHIN, "hold, go")
            self._controller.set_reference(reference)
        self.wanted = reference

    def set_stiffness(self, reference: StiffnessReference) -> None:
        """Command another stiffness; it ends a stiffness jog."""
        self._stiffness_rate = 0.0
        self._controller.set_stiffness(reference)

    def follow(self) -> None:
        """Follow the reference that was set. Raises ValueError if it starts elsewhere."""
        self._check_start(self.wanted, NEAR_ENOUGH, "go")
        self._controller.set_reference(self.wanted)
        self.kind = "following"
        self._tell("reference", "follow")

    def _check_start(self, reference: Reference, most: float, do: str) -> None:
        if reference.kind == "step" and abs(reference.target - reference.origin) > NEAR_ENOUGH:
            raise ValueError(
                f"a raw step of {abs(reference.target - reference.origin):.2f} rad is too hard for a rig, expected at most "
                f"{NEAR_ENOUGH:g} rad; take a filtered step or a move"
            )
        start = self._start_of(reference)
        away = abs(start - self._controller.reference_now().r)
        most = NEAR_ENOUGH if reference.kind == "step" else most
        if away > most:
            raise ValueError(
                f"the reference starts {away:.2f} rad from where the link is, expected at most {most:g} rad; "
                f"{do} to {start:.3f} rad first"
            )

    def go_to(self, position: float, speed: float) -> None:
        """Go to a position [rad] within `speed` [rad/s]. Raises ValueError outside the rig's limits."""
        limits = self._limits
        if not limits.link_low <= position <= limits.link_high:
            raise ValueError(
                f"{position:.3f} rad is outside the rig's limits; expected {limits.link_low:g} to {limits.link_high:g} rad"
            )
        _check_speed(speed, limits.jog_speed, "speed", least=0.001)
        way = position - self._controller.reference_now().r
        if abs(way) < SHORTEST:
            return
        self._set_jog(speed if way > 0.0 else -speed, abs(way))
        self.kind, self._target = "going", position
        self._tell("reference", "go to")

    def jog(self, link: float, stiffness: float, sent_s: float, now: float) -> None:
        """Move for as long as this is renewed; 0, 0 lets go. Raises ValueError if it is old, too fast or out of turn."""
        if not now - sent_s < JOG_LASTS_S:
            raise ValueError(
                f"this jog is {now - sent_s:.2f} s old, expected less than {JOG_LASTS_S:g} s; it is dropped"
            )
        _check_speed(abs(link), self._limits.jog_speed, "jog")
        if not abs(stiffness) <= self._limits.stiffness_jog:
            raise ValueError(
                f"a stiffness jog of {stiffness:g} N·m/rad a second is too fast; "
                f"expected at most {self._limits.stiffness_jog:g}"
            )
        if link != 0.0 and self.kind in ("following", "going"):
            raise ValueError(f"the link is {self.words}; hold it first, then jog")
        self._ends_s = min(sent_s, now) + JOG_LASTS_S
        if stiffness != self._stiffness_rate:
            if stiffness == 0.0:
                self._release_stiffness("jog")
            else:
                self._start_stiffness(stiffness, now)
        if link != 0.0 and (self.kind != "jogging" or link != self._velocity):
            self._start_jog(link)
        elif link == 0.0 and self.kind == "jogging":
            self._let_go()

    def advance(self, now: float) -> None:
        """Go on by one cycle: jogs that were not renewed run down, what has arrived holds."""
        if now >= self._ends_s:
            if self.kind == "jogging":
                self._let_go()
            self._release_stiffness("jog")
        if self._stiffness_rate != 0.0 and now - self._stepped_s >= STIFFNESS_STEP_S:
            self._step_stiffness(now)
        if self.kind in ("halting", "going") and self._rests():
            self.kind = "holding"

    def _start_jog(self, velocity: float) -> None:
        limits = self._limits
        at = self._controller.reference_now().r
        left = limits.link_high - at if velocity > 0.0 else at - limits.link_low
        if left - EDGE < SHORTEST:
            raise ValueError(f"the link is at the rig's limit, {at:.3f} rad; jog the other way")
        self._set_jog(velocity, left - EDGE)
        self.kind, self._velocity = "jogging", velocity
        self._tell("reference", "jog")

    def _let_go(self) -> None:
        self._controller.hold()
        self.kind = "halting"
        self._tell("reference", "jog")

    def _set_jog(self, velocity: float, distance: float) -> None:
        self._controller.set_reference(
            gentle_jog(velocity, distance, self._controller.scenario, self._limits, self._stiffness_now())
        )

    def _stiffness_now(self) -> float:
        reference = self._controller.scenario.stiffness_reference
        return reference.target if reference.kind == "move" else reference.stiffness

    def _start_stiffness(self, rate: float, now: float) -> None:
        if self._stiffness_rate == 0.0:
            self._stiffness, self._stepped_s = self._stiffness_now(), now
        self._stiffness_rate = rate

    def _step_stiffness(self, now: float) -> None:
        limits = self._limits
        wanted = self._stiffness + self._stiffness_rate * (now - self._stepped_s)
        wanted = min(max(wanted, limits.stiffness_low), limits.stiffness_high)
        self._stepped_s = now
        if wanted != self._stiffness:
            self._stiffness = wanted
            self._controller.set_stiffness(ConstantStiffness(stiffness=wanted))

    def _release_stiffness(self, why: str) -> None:
        if self._stiffness_rate != 0.0:
            self._stiffness_rate = 0.0
            self._tell("stiffness_reference", why)

    def _rests(self) -> bool:
        at = self._controller.reference_now()
        if self.kind == "going" and abs(at.r - self._target) > AT_REST.r:
            return False
        return (
            abs(at.r1) < AT_REST.r1 and abs(at.r2) < AT_REST.r2 and abs(at.r3) < AT_REST.r3 and abs(at.r4) < AT_REST.r4
        )

    def _start_of(self, reference: Reference) -> float:
        """Return where a reference would start [rad] if it were set now."""
        if reference.kind == "step":
            return reference.origin
        at = self._controller.reference_now().r
        gap = np.zeros(TRANSITION_SIZE)
        here = reference_row(MoveReference(origin=0.0, target=0.0, repeat=False))
        here[1] = here[2] = at
        change_reference(here, reference_row(reference), 0.0, gap)
        return at - float(gap[0])

    def _tell(self, part: Literal["reference", "stiffness_reference"], why: str) -> None:
        self.moved.append(Moved(part, self._controller.scenario, self._controller.time_s, why))


def gentle_jog(velocity: float, distance: float, scenario: Scenario, limits: Limits, stiffness: float) -> JogReference:
    """Return the jog whose acceleration the limits can brake and whose snap costs a share of the motor's torque at most."""
    model = scenario.tuning.model
    allowed = TORQUE_SHARE * limits.motor_torque
    acceleration = min(3.0, 0.5 * limits.braking, allowed / (model.motor_inertia + model.link_inertia))
    snap = min(2000.0, allowed * stiffness / (model.link_inertia * model.motor_inertia))
    return JogReference(
        velocity=velocity, acceleration=max(0.01, acceleration), jerk=50.0, snap=max(1.0, snap), distance=distance
    )


def _check_speed(speed: float, most: float, what: str, least: float = 0.0) -> None:
    if not least <= speed <= most:
        raise ValueError(f"a {what} of {speed:g} rad/s is refused; expected {least:g} to {most:g} rad/s on this rig")
