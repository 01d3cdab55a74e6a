"""What a connected rig does: its state, what each command and each fault makes of it, and the torques of every cycle."""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backend.loop.arming import BLEND_S
from backend.loop.connected_rig import ConnectedRig
from backend.loop.freshness import FAULTS, STOPS, oldest, silence, stop_sentence
from backend.loop.homing import HomingLaw
from backend.loop.latch import Latch
from backend.loop.messages import Changed, Done, Refused, Report, State
from backend.loop.monitors import Monitors, Seen
from backend.loop.motion import Motion
from backend.loop.reactions import LOST, ONLY_DRIVEN, UNHOMES
from backend.loop.rig_states import CLOSED, DRIVEN, WATCHED
from backend.loop.stopping import Moment, Release, Stopping
from backend.loop.watchdogs import Watchdogs
from backend.rigs.faults import ENABLE_TIMEOUT, HOMING, NOT_A_NUMBER, Fault
from backend.rigs.rig import AXES, Axis, RigError
from vssea_core.channels import INDEX
from vssea_core.tick import controller as law


class Conduct:
    """The state machine of a connected rig; `tell` takes its reports, `clock` is the loop's [s]."""

    def __init__(
        self,
        on: ConnectedRig,
        watchdogs: Watchdogs,
        clock: Callable[[], float],
        tell: Callable[[Report], None],
        epoch: int,
    ) -> None:
        self.on, self.watchdogs, self.clock, self._tell, self._epoch = on, watchdogs, clock, tell, epoch
        self.state: State = "starting"
        self.latch = Latch()
        self.motion = Motion(on.controller, on.limits)
        self.monitors = Monitors(on.limits, on.file.homing, on.actuator, on.period_s)
        self.homing: HomingLaw | None = None
        self.stopping: Stopping | None = None
        self.release: Release | None = None
        self.goal: State = "stopped"
        self._reason: str | None = None
        self.rest_until: float | None = None
        self.arming: tuple[int, float] | None = None
        self.resetting: tuple[int, float] | None = None
        self.enable_until = self._armed_s = 0.0
        self._error = 0.0
        self._looked_s = clock()
        self.become("connected", None)

    def stop(self, reason: str) -> None:
        """Take the rig to rest and off, from whatever state; a rig that is off or at fault stays so."""
        if self.state in ("stopped", "fault"):
            return
        self._reason = reason
        self.goal = "stopped"
        self._to_safety()

    def guard(self, late_in_a_row: bool, late: Fault) -> None:
        """Look whether operator, server and clock are as they have to be."""
        if self.state in WATCHED or self.closed or self.arming is not None:
            silent = self.watchdogs.expired()
            if silent is not None:
                self.stop(silent.sentence())
        if late_in_a_row and self.closed:
            self._note(late, "")

    def cycle(self, row: NDArray[np.float64]) -> None:
        """Exchange, look for faults, and decide the torques of the next exchange; fill `row`."""
        on, now = self.on, self.clock()
        found = on.exchange()
        found += on.axes.look()
        silent = silence(on.measured) if oldest(on.measured) >= FAULTS else None
        if silent is not None:
            found.append((silent, ""))
        found += self.monitors.look(self._seen(now))
        for fault, detail in found:
            if fault not in ONLY_DRIVEN or self.state in DRIVEN or fault in self.latch:
                self._note(fault, detail)
        if oldest(on.measured) >= STOPS and (self.state in WATCHED or self.closed or self.arming is not None):
            self.stop(stop_sentence(on.measured))
        self._go_on_arming(now)
        self._go_on_resetting(now)
        motor_torque, stiffness_torque = self._torques(row, now)
        on.motor_torque, on.stiffness_torque = motor_torque, stiffness_torque
        if not on.controller.finite and on.axes.any_on:
            if self.stopping is not None:  # not even holding can be computed
                self._leave("stiffness")
            self._note(NOT_A_NUMBER, "")
        self._error = row[INDEX["error"]]
        self.match_motion()

    @property
    def closed(self) -> bool:
        """Whether the loops are closed: armed, running, or coming to rest before they are opened."""
        return self.state in CLOSED or self.rest_until is not None

    def match_motion(self) -> None:
        """Be armed while the link is held, running while it moves."""
        for moved in self.motion.moved:
            self._tell(moved)
        self.motion.moved.clear()
        if self.state in CLOSED:
            state: State = "running" if self.motion.moving else "armed"
            if state != self.state:
                self.become(state, None)

    def _seen(self, now: float) -> Seen:
        on, controller = self.on, self.on.controller
        closed = self.closed and now - self._armed_s >= BLEND_S
        return Seen(
            on.measured, self._error, controller.spring_torque, controller.stiffness, controller.link_disturbance_estimate,
            controller.motor_disturbance_estimate, controller.stiffness_disturbance_estimate, on.homed, on.axes.any_on, closed,
            (on.axes.enabled("motor"), on.axes.enabled("stiffness")), self._cycles(now),
        )  # fmt: skip

    def _cycles(self, now: float) -> float:
        """Return how many cycles long the one that ends now was; one at least, since a loop that was late catches up."""
        before, self._looked_s = self._looked_s, now
        return max(1.0, (now - before) / self.on.period_s)

    def _torques(self, row: NDArray[np.float64], now: float) -> tuple[float, float]:
        on = self.on
        if self.homing is not None:
            on.tick(law.READING, 0.0, row)
            return 0.0, self._home_on(self.homing, now)
        if self.release is not None:
            on.tick(law.READING, 0.0, row)
            torque = self.release.torque(now)
            if self.release.over(now):
                self.release = None
                self._end_stop()
            return 0.0, torque
        if self.closed:
            self.motion.advance(now)
            if self.rest_until is not None and (not self.motion.moving or now >= self.rest_until):
                self._to_safety()
            else:
                return on.tick(law.CLOSED, min(1.0, (now - self._armed_s) / BLEND_S), row)
        if self.stopping is not None:
            return self._stop_on(self.stopping, row, now)
        on.tick(law.READING, 0.0, row)
        return 0.0, 0.0

    def _stop_on(self, stopping: Stopping, row: NDArray[np.float64], now: float) -> tuple[float, float]:
        on = self.on
        for axis, age in (("motor", on.measured.motor_age), ("stiffness", on.measured.stiffness_age)):
            if age >= STOPS:
                self._leave(axis)  # type: ignore[arg-type]
        if self.arming is not None:
            course_mode, share, brakes, holds = law.STIFFNESS_HOLDS, 0.0, False, on.axes.enabled("stiffness")
        else:
            known = oldest(on.measured) < STOPS
            torque = on.controller.spring_torque if known else math.nan
            course = stopping.step(Moment(now, self.monitors.motor_speed, torque))
            brakes, share, holds = course
            course_mode = law.BRAKING if brakes else law.STIFFNESS_HOLDS if holds else law.READING
        motor_torque, stiffness_torque = on.tick(course_mode, 1.0, row)
        if self.state in ("stopping", "homing") and stopping.over(now):
            self._end_stop()
        if stopping.off:
            self.stopping = None
        return share * motor_torque if brakes else 0.0, stiffness_torque if holds else 0.0

    def _home_on(self, homing: HomingLaw, now: float) -> float:
        on = self.on
        if not on.axes.enabled("stiffness"):
            if now >= self.enable_until:
                self._note(ENABLE_TIMEOUT, f"stiffness drive: {on.axes.status['stiffness'].words}")
            return 0.0
        if on.measured.stiffness_age != 0:
            return on.stiffness_torque
        phase = homing.phase
        torque = homing.step(on.measured.stiffness_position)
        if (phase, homing.phase) == ("stiff", "soft") and on.file.homing.align_motor:
            on.align_motor()
            self.monitors.restart()
        if homing.phase == "failed":
            self._note(HOMING, homing.failure)
            return on.stiffness_torque
        if homing.phase == "homed":
            try:
                on.take_home(homing.offset, homing.span_found)
            except RigError as error:
                self._note(error.fault, error.detail)
                return on.stiffness_torque
            self.monitors.restart()
            self.homing, self.goal, self.stopping = None, "ready", Stopping(on.axes, now)
            return on.stiffness_torque
        return torque

    def _go_on_arming(self, now: float) -> None:
        on = self.on
        if self.arming is None:
            return
        number, until = self.arming
        if on.axes.enabled(*AXES) and oldest(on.measured) == 0:
            self.arming = self.stopping = None
            on.begin()
            self.monitors.restart()
            self._armed_s, self._error = now, 0.0
            self.motion.begin()
            self.become("armed", None)
            self._tell(Done(number, on.controller.time_s))
        elif now >= until:
            late = [axis for axis in AXES if not on.axes.enabled(axis)] or list(AXES)
            self._note(ENABLE_TIMEOUT, f"{late[0]} drive: {on.axes.status[late[0]].words}")

    def _go_on_resetting(self, now: float) -> None:
        if self.resetting is None:
            return
        number, until = self.resetting
        stands = self.stands()
        if stands is None:
            self.resetting = None
            self.finish_reset()
            self._tell(Done(number, self.on.controller.time_s))
        elif now >= until:
            self.resetting = None
            self._tell(Refused(number, stands))

    def stands(self) -> str | None:
        """Return why a reset would be refused: in words, what has not gone away."""
        drive = self.on.axes.at_fault()
        if drive is not None:
            return f"{drive}; clear its cause"
        standing = self.latch.standing(self.clock())
        if standing is None and oldest(self.on.measured) >= STOPS:
            standing = stop_sentence(self.on.measured)
        return None if standing is None else f"the cause still stands: {standing.rstrip('.')}"

    def finish_reset(self) -> None:
        """Be ready, or connected if the rig has to be homed again, with the drives off and the faults forgotten."""
        if any(fault in self.latch for fault in UNHOMES):
            self.on.homed = False
            self.on.axes.disarm("stiffness")  # it can hold no place that is not known
        self.latch.clear()
        self.monitors.restart()
        self.become("ready" if self.on.homed else "connected", None)

    def _note(self, fault: Fault, detail: str) -> None:
        now = self.clock()
        if not self.latch.note(fault, detail, self.on.controller.time_s, now):
            return
        if self.state != "fault":
            self._reason = self.latch.first
            self._to_safety()
        for axis in LOST.get(fault, ()):
            self._leave(axis)

    def _leave(self, axis: Axis) -> None:
        if self.stopping is not None:
            self.stopping.leave_to_drive(axis, self.clock())
        elif self.on.axes.on(axis):
            self.on.axes.stop(axis)

    def _to_safety(self) -> None:
        """Begin the stop that suits the state; what is off already is stopped, or at fault, at once."""
        on, now = self.on, self.clock()
        self.rest_until = None
        self.motion.end()
        if self.arming is not None:
            number, self.arming = self.arming[0], None
            self._tell(
                Refused(number, f"the rig was stopped while it was being armed: {(self._reason or '').rstrip('.')}")
            )
            self.stopping = self.stopping or Stopping(on.axes, now)
            on.axes.disarm("motor")
            if self.state == "ready":
                self.become("stopping", self._reason)
        elif self.homing is not None:
            self.release, self.homing = Release(on.axes, on.stiffness_torque, now), None
            self.become("stopping", self._reason)
        elif self.state in DRIVEN:
            if self.stopping is None and self.release is None:
                self.stopping = Stopping(on.axes, now)
            if self.state != "stopping":
                self.become("stopping", self._reason)
        else:
            self._end_stop()

    def _end_stop(self) -> None:
        """Become what the stop was for; a fault that latched on the way goes first."""
        if self.on.running and not (self.stopping is not None and self.stopping.holding):
            self.on.begin()  # what was followed ends here: the reference is where the link is
        if self.latch:
            self.become("fault", self.latch.first)
        elif self.goal == "ready":
            self.become("ready", None)
        else:
            self.become("stopped", self._reason)

    def become(self, state: State, reason: str | None) -> None:
        """Change the state and say so."""
        self.state = state
        self._tell(Changed(state, reason, self._epoch, self.on.controller.time_s))
