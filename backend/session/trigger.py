"""The trigger: armed on an event or a level, it marks what lies around the instant at which it fires."""

import logging
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from backend.problem import Problem
from backend.session.arguments import Nothing
from backend.session.events import Event
from backend.session.trigger_source import Arming, Crossing, EventSource
from backend.telemetry.ring import EPOCH
from vssea_core.channels import INDEX

if TYPE_CHECKING:
    from backend.session.session import Session

logger = logging.getLogger(__name__)
Message = dict[str, Any]
State = Literal["off", "armed", "fired", "captured"]


@dataclass(frozen=True)
class Fired:
    """When it fired, and why."""

    epoch: int
    at_s: float
    cause: str


class Trigger:
    """One for the session. `watch` is called ten times a second and reads every sample once, so no crossing is lost."""

    def __init__(self, session: "Session") -> None:
        self._session = session
        self._state: State = "off"
        self._sentence = "Off."
        self._armed: Arming | None = None
        self._by = ""
        self._fired: Fired | None = None
        self._excerpt: Message | None = None
        self._crossing: Crossing | None = None
        self._next = 0
        self._armed_at: tuple[int, float] = (0, 0.0)

    def message(self) -> Message:
        """Return how it stands, as docs/protocol.md has it."""
        return {
            "type": "trigger", "state": self._state, "sentence": self._sentence, "by": self._by,
            "trigger": self._armed.model_dump(mode="json") if self._armed else None, "excerpt": self._excerpt,
        }  # fmt: skip

    async def arm(self, asked: Arming, by: str) -> Message:
        """Wait for what is asked from now on, in place of what was waited for."""
        session = self._session
        self._armed, self._by, self._excerpt = asked, by, None
        self._crossing = Crossing(asked.source) if asked.source.kind == "level" else None
        self._next = max(0, session.ring.written - 1)  # the newest sample is where the level is looked at first
        self._wait(session.status.epoch, session.status.time_s)
        return {}

    async def disarm(self, _: Nothing, by: str) -> Message:
        """Wait no longer; what was captured stays."""
        self._armed = self._crossing = self._fired = None
        self._become("off", "Off.")
        return {}

    def hear(self, event: Event) -> None:
        """Take an event of the log."""
        armed = self._armed
        if self._state != "armed" or armed is None or not isinstance(armed.source, EventSource):
            return
        if armed.source.fires_at(event) and (event.epoch, event.time_s) >= self._armed_at:
            self._fire(Fired(event.epoch, event.time_s, event.text))

    def watch(self) -> None:
        """Read on from where it stopped, and see whether it fires or has seen enough."""
        if self._state == "armed" and self._crossing is not None:
            self._look_for_crossing()
        if self._state == "fired":
            self._look_for_end()

    def _look_for_crossing(self) -> None:
        crossing, armed = self._crossing, self._armed
        if crossing is None or armed is None:
            return
        piece = self._session.ring.since(self._next)
        if piece.lost:
            crossing.forget()
        self._next = piece.first + len(piece.samples)
        found = crossing.first(piece.samples)
        if found is not None:
            sample = piece.samples[found]
            self._fire(Fired(int(sample[EPOCH]), float(sample[INDEX["time"]]), armed.source.words()))

    def _look_for_end(self) -> None:
        """Capture once the time after the instant is over, or the run is."""
        fired, armed = self._fired, self._armed
        newest = self._session.ring.latest()
        if fired is None or armed is None or newest is None:
            return
        now_s = float(newest[INDEX["time"]])
        is_over = int(newest[EPOCH]) != fired.epoch or self._run_has_ended()
        to_s = fired.at_s + armed.after_s
        if now_s < to_s and not is_over:
            return
        if is_over:
            to_s = min(to_s, self._end_of(fired.epoch, fired.at_s))
        self._state = "captured"
        self._session.spawn(self._capture(fired, armed, to_s))

    def _run_has_ended(self) -> bool:
        """Return whether no more samples come: a simulation ends at a fault, a rig is measured on."""
        return self._session.status.state == "fault" and not self._session.rig.connected

    def _end_of(self, epoch: int, at_least_s: float) -> float:
        """Return the time of the last sample of a run that the ring still has."""
        samples = self._session.ring.since(0).samples
        times = samples[samples[:, EPOCH] == epoch, INDEX["time"]]
        return float(times[-1]) if len(times) else at_least_s

    async def _capture(self, fired: Fired, armed: Arming, to_s: float) -> None:
        label = f"{fired.cause} at {fired.at_s:.3f} s"
        from_s = max(0.0, fired.at_s - armed.before_s)
        try:
            kept = await self._session.pins.keep_capture(label, self._by, fired.epoch, from_s, to_s, fired.at_s)
        except Problem as problem:
            excerpt, sentence = None, f"Fired: {label}; not kept: {problem.detail}"
        else:
            excerpt, sentence = kept.document() | {"epoch": fired.epoch}, f"Captured: {label}."
            self._session.log.add("trigger", f"captured: {label}", self._by, fired.epoch, fired.at_s)
        if self._armed is not armed:
            return  # armed anew or disarmed meanwhile: what was captured is kept all the same
        self._excerpt = excerpt
        self._become("captured", sentence)
        if armed.repeat:
            self._next = max(self._next, self._session.ring.written - 1)
            if self._crossing is not None:
                self._crossing.forget()
            self._wait(fired.epoch, to_s)

    def _wait(self, epoch: int, from_s: float) -> None:
        self._fired = None
        self._armed_at = (epoch, from_s)
        waits_for = self._armed.source.words() if self._armed else ""
        self._become("armed", f"Armed: waits for {waits_for}.")

    def _fire(self, fired: Fired) -> None:
        self._fired = fired
        self._become("fired", f"Fired at {fired.at_s:.3f} s: {fired.cause}.")

    def _become(self, state: State, sentence: str) -> None:
        self._state, self._sentence = state, sentence
        self._session.tell(self.message())
