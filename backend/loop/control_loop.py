"""The loop of the control process, one turn at a time: STOP first, then commands, then samples."""

import time
from multiprocessing.connection import Connection

from backend.loop.messages import (
    Changed,
    Command,
    Done,
    Followed,
    Install,
    Load,
    Pause,
    Plan,
    Refused,
    Report,
    Reset,
    Resume,
    SetDisturbances,
    SetPace,
    SetReference,
    SetStiffness,
    State,
    Step,
)  # fmt: skip
from backend.loop.pacer import Pacer
from backend.loop.pipe_end import PipeEnd
from backend.loop.stamps import stamp
from backend.telemetry.ring import OVERRUNS, RUNS, RingWriter
from backend.telemetry.stop_flag import StopFlag
from vssea_core.simulation.closed_loop import ClosedLoop

SHORTEST_TURN_S = 1e-3
"""A turn lasts at least this long: faster sample times and paces advance several samples a turn."""
IDLE_TURN_S = 2e-3
TICKING: tuple[State, ...] = ("running", "stopped")
STOP_REASON = "Stopped on request"


class ControlLoop:
    """Owns the closed loop; everything that can be asked of it comes through the pipe or the stop flag."""

    def __init__(self, ring: RingWriter, flag: StopFlag, pipe: Connection, pacer: Pacer | None = None) -> None:
        self._ring, self._flag, self._pipe = ring, flag, PipeEnd(pipe)
        self._pacer = pacer or Pacer()
        self._loop: ClosedLoop | None = None
        self._pace = 1.0
        self.state: State = "starting"
        self.epoch = int(ring.header[RUNS])  # goes on where a process that died left off
        self._stops_seen = flag.count if self.epoch else 0  # a STOP while the session starts counts too

    @property
    def leaving(self) -> bool:
        """Whether the web process has closed its end of the pipe."""
        return self._pipe.lost

    def turn(self, late_s: float = 0.0) -> float:
        """Do one turn that started `late_s` too late; return the length [s] of a turn."""
        if self._flag.count != self._stops_seen:
            self._stop()
        for number, command in self._pipe.commands():
            self._pipe.report(self._obey(number, command))
        length = IDLE_TURN_S
        if self._loop is not None and self.state in TICKING:
            period = self._loop.period_s / self._pace
            samples = max(1, round(SHORTEST_TURN_S / period))
            self._advance(samples, late_s)
            length = samples * period
        self._pipe.send()
        return length

    def run(self) -> None:
        """Turn until the web process closes its end of the pipe."""
        late, was_ticking = 0.0, False
        while not self.leaving:
            length = self.turn(late)
            ticking = self.state in TICKING
            if ticking != was_ticking:
                self._pacer.restart()
            was_ticking = ticking
            before = self._pacer.overruns
            late = self._pacer.wait(length)
            if ticking:
                self._ring.header[OVERRUNS] += self._pacer.overruns - before

    def _advance(self, count: int, late_s: float) -> None:
        loop = self._loop
        if loop is None:
            return
        _, rows = self._ring.room(count)
        started = time.perf_counter_ns()
        done, fault = loop.advance(rows)
        taken_us = (time.perf_counter_ns() - started) * 1e-3
        kept = min(done + 1, len(rows)) if fault else done  # the sample from which it could not go on is worth seeing
        stamp(rows[:kept], self.epoch, loop.period_s, late_s, taken_us / len(rows))
        self._ring.announce(kept)
        for follower in loop.passed:
            self._pipe.report(Followed(follower.index, follower.at_s, loop.tuning_id))
        loop.passed.clear()
        if fault is not None:
            self._become("fault", f"Diverged at t = {loop.time_s:.3f} s: {fault}. Change the tuning, then Reset.")

    def _stop(self) -> None:
        self._stops_seen = self._flag.count
        if self.state in ("stopped", "fault"):
            return
        if self._loop is not None:
            self._loop.enabled = False
        self._become("stopped", STOP_REASON)

    def _obey(self, number: int, command: Command) -> Report:
        try:
            self._apply(command)
        except ValueError as refusal:
            return Refused(number, str(refusal))
        return Done(number, self._loop.time_s if self._loop else 0.0)

    def _apply(self, command: Command) -> None:
        if isinstance(command, Load):
            self._loop = ClosedLoop(command.scenario, command.planned, command.tuning_id)
            self._begin_run()
            latched = self.state in ("stopped", "fault")
            self._become("ready" if latched or not command.run else "running", None)
            return
        loop = self._loop
        if loop is None:
            raise ValueError("the session is still starting; try again in a moment")
        match command:
            case Install(tuning, prepared, tuning_id):
                loop.install(tuning, prepared, tuning_id)
            case Plan(followers):
                loop.plan(followers)
            case SetReference(reference):
                loop.set_reference(reference)
            case SetStiffness(reference):
                loop.set_stiffness(reference)
            case SetDisturbances(disturbances):
                loop.set_disturbances(disturbances)
            case SetPace(factor):
                self._pace = factor
                self._pacer.restart()
            case Step(samples):
                self._step(samples)
            case Pause():
                self._pause()
            case Resume():
                self._resume()
            case Reset():
                self._reset(loop)

    def _pause(self) -> None:
        if self.state != "running":
            raise ValueError(f"only a running session can be paused; this one is {self.state}")
        self._become("paused", None)

    def _resume(self) -> None:
        if self.state not in ("paused", "ready"):
            raise ValueError(f"a session that is {self.state} cannot resume; {self._way_out()}")
        self._become("running", None)

    def _step(self, samples: int) -> None:
        if self.state != "paused":
            raise ValueError(f"only a paused session can be stepped; this one is {self.state}")
        left = samples
        while left > 0 and self.state == "paused":
            part = min(left, 1000)
            before = self._ring.written
            self._advance(part, 0.0)
            left -= self._ring.written - before

    def _reset(self, loop: ClosedLoop) -> None:
        loop.restart()
        self._begin_run()
        self._become("ready" if self.state in ("stopped", "fault") else self.state, None)

    def _begin_run(self) -> None:
        self.epoch += 1
        self._ring.header[RUNS] = self.epoch

    def _way_out(self) -> str:
        return "reset it first" if self.state in ("stopped", "fault") else "it needs no resuming"

    def _become(self, state: State, reason: str | None) -> None:
        self.state = state
        self._pipe.report(Changed(state, reason, self.epoch, self._loop.time_s if self._loop else 0.0))
