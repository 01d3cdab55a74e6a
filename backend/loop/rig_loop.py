"""The loop of a rig's control process, one turn at a time: STOP first, then commands, watchdogs, exchange, monitors, tick."""

import time
from collections.abc import Callable
from multiprocessing.connection import Connection

from backend.loop import messages
from backend.loop.conduct import Conduct
from backend.loop.connected_rig import ConnectedRig
from backend.loop.leaving import leave
from backend.loop.messages import Command, Done, Refused, State
from backend.loop.pacer import Pacer
from backend.loop.pipe_end import PipeEnd
from backend.loop.rig_commands import apply
from backend.loop.rig_reports import EVERY_S, rig_report
from backend.loop.rig_states import DRIVEN, refusal
from backend.loop.stamps import stamp
from backend.loop.watchdogs import Watchdogs
from backend.rigs.faults import LOOP_LATE, PROCESS_ENDED, STOP_REQUESTED
from backend.rigs.rig import Rig, RigError
from backend.rigs.rig_file import RigFile
from backend.telemetry.beats import WEB, Beats
from backend.telemetry.ring import OVERRUNS, RUNS, WIDTH, RingWriter
from backend.telemetry.stop_flag import StopFlag
from vssea_core.scenario import Scenario

IDLE_TURN_S = 2e-3
LATE_CYCLES = 10
UNHEARD_S = 1.0
"""Silence of the server [s] after which reports are not sent any more."""
LEAVE_S = 1.2
"""Time [s] that a controlled stop may take when the process ends."""

RigOf = Callable[[RigFile, Scenario], Rig]


class RigLoop:
    """Owns a rig from Connect to the end; everything that can be asked of it comes through the pipe or the stop flag."""

    def __init__(
        self,
        ring: RingWriter,
        flag: StopFlag,
        beats: Beats,
        pipe: Connection,
        rig_of: RigOf,
        pacer: Pacer | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._ring, self._flag, self._pipe = ring, flag, PipeEnd(pipe)
        self._rig_of, self._pacer, self._clock = rig_of, pacer or Pacer(), clock
        self._watchdogs = Watchdogs(beats, clock)
        self._stops_seen = flag.count
        self.epoch = int(ring.header[RUNS])
        self._conduct: Conduct | None = None
        self._late_cycles = self._missed_cycles = 0
        self._next_report_s = 0.0
        self._reported: State = "starting"
        self._faults_reported = 0
        self._ending = False
        self._disconnect: int | None = None

    @property
    def state(self) -> State:
        """The state of the session."""
        return self._conduct.state if self._conduct else "starting"

    @property
    def leaving(self) -> bool:
        """Whether the loop is to end: told to, or alone."""
        return self._pipe.lost or self._ending

    def end(self) -> None:
        """End after this turn; may be called by a signal."""
        self._ending = True

    def turn(self, late_s: float = 0.0, missed: int = 0) -> float:
        """Do one turn that started `late_s` too late, after `missed` cycles without one; return the length [s] of a turn."""
        conduct = self._conduct
        if self._flag.count != self._stops_seen:
            self._stops_seen = self._flag.count
            if conduct is not None:
                conduct.stop(STOP_REQUESTED.sentence())
        self._watchdogs.look()
        for number, command in self._pipe.commands():
            answer = self._obey(number, command)
            if answer is not None:
                self._pipe.report(answer)
        length = IDLE_TURN_S
        conduct = self._conduct
        if conduct is not None:
            self._late_cycles = self._late_cycles + missed if missed else 0
            self._missed_cycles += missed
            for _ in range(min(missed, LATE_CYCLES) if conduct.on.running else 0):
                self._skip(conduct, late_s)
            conduct.guard(self._late_cycles >= LATE_CYCLES, LOOP_LATE)
            self._cycle(conduct, late_s)
            self._report_when_due(conduct)
            length = conduct.on.period_s
        self._pipe.send()
        return length

    def run(self) -> None:
        """Turn until told to end or alone; then stop the rig, disable it and close it, on every way out."""
        try:
            late, missed = 0.0, 0
            while not self.leaving:
                had_rig = self._conduct is not None
                length = self.turn(late, missed)
                if had_rig != (self._conduct is not None):
                    self._pacer.restart()
                late, missed = self._wait(length)
            self._stop_for_good()
        finally:
            self._leave()

    def _wait(self, length: float) -> tuple[float, int]:
        before = self._pacer.overruns
        late = self._pacer.wait(length)
        missed = self._pacer.overruns - before
        if self._conduct is not None:
            self._ring.header[OVERRUNS] += missed
        return late, missed

    def _skip(self, conduct: Conduct, late_s: float) -> None:
        """Record a cycle that was missed, as predicted: samples stay evenly spaced, and the observers know of the time."""
        _, rows = self._ring.room(1)
        conduct.on.skip(rows[0, :WIDTH])
        stamp(rows, self.epoch, conduct.on.period_s, late_s, 0.0)
        self._ring.announce(1)

    def _cycle(self, conduct: Conduct, late_s: float) -> None:
        _, rows = self._ring.room(1)
        started = time.perf_counter_ns()
        conduct.cycle(rows[0, :WIDTH])
        stamp(rows, self.epoch, conduct.on.period_s, late_s, (time.perf_counter_ns() - started) * 1e-3)
        self._ring.announce(1)

    def _obey(self, number: int, command: Command) -> messages.Report | None:
        refused = refusal(command, self.state)
        if refused is not None:
            return Refused(number, refused)
        try:
            if isinstance(command, messages.Connect):
                self._connect(command)
            elif isinstance(command, messages.Disconnect):
                self._ending, self._disconnect = True, number
                return None
            elif self._conduct is not None and not apply(self._conduct, number, command):
                return None
        except (ValueError, RigError) as refusal_of_it:
            return Refused(number, str(refusal_of_it).rstrip("."))
        return Done(number, self._conduct.on.controller.time_s if self._conduct else 0.0)

    def _connect(self, command: messages.Connect) -> None:
        rig = self._rig_of(command.rig, command.scenario)
        try:
            rig.connect()
            rig.identify()  # another device is not configured
            rig.configure()
            on = ConnectedRig(rig, rig.identify(), command)  # now with what the devices would not take over
        except RigError as error:
            rig.close()
            raise ValueError(str(error).rstrip(".")) from error
        except BaseException:
            rig.close()
            raise
        self.epoch += 1
        self._ring.header[RUNS] = self.epoch
        self._conduct = Conduct(on, self._watchdogs, self._clock, self._pipe.report, self.epoch)

    def _report_when_due(self, conduct: Conduct) -> None:
        now = self._clock()
        if self._watchdogs.silent_s(WEB) >= UNHEARD_S:
            return  # nobody takes them: a full pipe would hold the loop up
        changed = conduct.state != self._reported or len(conduct.latch) != self._faults_reported
        if changed or now >= self._next_report_s:
            self._reported, self._faults_reported = conduct.state, len(conduct.latch)
            self._next_report_s = now + EVERY_S
            self._pipe.report(rig_report(conduct, now, self._missed_cycles, self._watchdogs.lease_left_s))

    def _stop_for_good(self) -> None:
        """Stop the rig as on STOP, for LEAVE_S at most."""
        conduct = self._conduct
        if conduct is None:
            return
        conduct.stop(PROCESS_ENDED.sentence())
        until = self._clock() + LEAVE_S
        while (conduct.state in DRIVEN or conduct.on.axes.any_on) and self._clock() < until:
            self._cycle(conduct, 0.0)
            self._report_when_due(conduct)
            self._pipe.send()
            self._wait(conduct.on.period_s)

    def _leave(self) -> None:
        conduct, self._conduct = self._conduct, None
        if conduct is not None:
            on = conduct.on
            loaded = conduct.stopping is not None and conduct.stopping.holding
            leave(on.rig, on.motor_torque, on.stiffness_torque, lambda: self._pacer.wait(on.period_s), loaded=loaded)
        if self._disconnect is not None:
            self._pipe.report(Done(self._disconnect, 0.0))
        self._pipe.send()
