"""What is kept of a fault: an excerpt of the recording, from 2 s before it to 1 s after it or to where samples end."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from backend.problem import Problem
from backend.telemetry.ring import EPOCH
from vssea_core.channels import INDEX

if TYPE_CHECKING:
    from backend.session.session import Session

BEFORE_S, AFTER_S = 2.0, 1.0
STILL_S = 0.5
"""So long without a new sample, the run has ended."""


@dataclass(frozen=True)
class Fault:
    """A fault whose second afterwards is not over yet."""

    epoch: int
    at_s: float
    sentence: str


class FaultExcerpts:
    """`watch` is called ten times a second; the clock is injected."""

    def __init__(self, session: "Session", clock: Callable[[], float]) -> None:
        self._session, self._clock = session, clock
        self._fault: Fault | None = None
        self._written, self._moved_at = -1, 0.0

    def begin(self, epoch: int, at_s: float, sentence: str) -> None:
        """Hear of a fault; one that follows another within its second belongs to it."""
        if self._fault is None:
            self._fault = Fault(epoch, at_s, sentence)
            self._written, self._moved_at = self._session.ring.written, self._clock()

    def watch(self) -> None:
        """Keep the excerpt once its end is recorded, or no more samples come."""
        fault, ring = self._fault, self._session.ring
        if fault is None:
            return
        if ring.written != self._written:
            self._written, self._moved_at = ring.written, self._clock()
        newest = ring.latest()
        goes_on = newest is not None and int(newest[EPOCH]) == fault.epoch
        now_s = float(newest[INDEX["time"]]) if newest is not None and goes_on else fault.at_s
        is_over = not goes_on or self._clock() - self._moved_at >= STILL_S
        if now_s < fault.at_s + AFTER_S and not is_over:
            return
        self._fault = None
        self._session.spawn(self._keep(fault, min(now_s, fault.at_s + AFTER_S)))

    async def _keep(self, fault: Fault, to_s: float) -> None:
        session = self._session
        from_s, to_s = max(0.0, fault.at_s - BEFORE_S), max(fault.at_s, to_s)
        try:
            await session.pins.keep_capture(
                fault.sentence, "session", fault.epoch, from_s, to_s, fault.at_s, kind="fault"
            )
        except Problem as problem:
            session.note("pin", f"what led to the fault is not kept: {problem.detail}", "session", "warning")
            return
        session.note("pin", f"kept of the fault: {from_s:.3f} s to {to_s:.3f} s of this recording", "session")
