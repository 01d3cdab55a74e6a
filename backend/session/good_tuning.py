"""Which tuning has proved itself on a rig: in force for 5 s with the loops closed and without a fault. The clock is injected."""

from collections.abc import Callable

from backend.loop.messages import State
from backend.loop.rig_states import CLOSED
from vssea_core.control.tuning import Tuning

PROVED_S = 5.0


class GoodTuning:
    """Knows the last good tuning, and says when a fault asks for it."""

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self.forget()

    def forget(self) -> None:
        """Begin anew, as with another rig."""
        self.last: Tuning | None = None
        self._state: State = "starting"
        self._tuning: Tuning | None = None
        self._since = 0.0
        self._tried = False

    def install(self, tuning: Tuning) -> None:
        """Hear of the tuning that is in force from now on."""
        self.watch()
        if tuning != self._tuning:
            self._tuning, self._since = tuning, self._clock()
            self._tried = self._state in CLOSED

    def enter(self, state: State, tuning: Tuning) -> bool:
        """Hear of a state; return whether it is a fault of a tuning that has not proved itself while another one has."""
        self.install(tuning)
        if state in CLOSED and self._state not in CLOSED:
            self._since, self._tried = self._clock(), True
        self._state = state
        if state == "fault":
            unproved = self._tried and self.last is not None and self.last != tuning
            self._tried = False
            return unproved
        if state in ("ready", "stopped", "connected"):
            self._tried = False  # it ended well, whether or not it ran for long enough
        return False

    def watch(self) -> None:
        """Notice that the tuning in force has proved itself."""
        if self._state in CLOSED and self._tuning is not None and self._clock() - self._since >= PROVED_S:
            self.last = self._tuning
