"""The cyclic exchange: torques, then SYNC, then the answers of this SYNC or the deadline; frames only, no physics.

Loss shows as the age of the answers: a bus that is gone raises nothing here.
"""

from collections.abc import Callable

import can
import canopen

from backend.rigs.canopen.answer import Answer
from backend.rigs.canopen.nodes import hand_on
from backend.rigs.canopen.objects import HEARTBEAT_ID, OPERATIONAL, OWN_NODE, SYNC_ID

MOST_FRAMES = 200
"""Frames handled in a cycle; a bus that babbles must not hold the loop."""
CORRUPTED_AT_ONCE, FORGIVEN_A_CYCLE = 3.0, 0.01
"""More malformed frames than this are a fault; one is forgiven every 100 cycles."""
UNSENT_AT_ONCE = 3
"""Cycles in a row in which the interface took nothing that are a fault."""
BUS_OFF_CLASS, CONTROLLER_CLASS, ACTIVE_AGAIN = 0x40, 0x04, 0x40
_CLASSES = {
    0x001: "transmission timeout",
    0x002: "lost arbitration",
    0x004: "controller error",
    0x008: "protocol violation",
    0x010: "transceiver error",
    0x020: "no node acknowledges",
    0x040: "bus-off",
    0x080: "bus error",
    0x100: "restarted after bus-off",
}


class Cycle:
    """The exchange of one bus: `commands` go out in order before the SYNC, each of `answers` is expected once after it."""

    def __init__(
        self,
        network: canopen.Network,
        bus: can.BusABC,
        commands: tuple[can.Message, ...],
        answers: tuple[Answer, ...],
        period_s: float,
        answer_share: float,
        heartbeat_s: float,
        clock: Callable[[], float],
    ) -> None:
        self._network, self._bus, self._clock = network, bus, clock
        self._commands, self._answers = commands, answers
        self._by_id = {answer.can_id: answer for answer in answers}
        self._window_s = answer_share * period_s
        self._sync = can.Message(arbitration_id=SYNC_ID, is_extended_id=False)
        self._heartbeat = can.Message(
            arbitration_id=HEARTBEAT_ID + OWN_NODE, is_extended_id=False, data=bytearray((OPERATIONAL,))
        )
        self._heartbeat_every = max(1, round(heartbeat_s / period_s))
        self._unsent = 0
        self._corrupted = 0.0
        self._errors: list[str] = []
        self._reason = ""
        self._was_late = False
        self._asked_s = 0.0
        self._probing = False
        self.cycles = self.late = 0
        self.round_trip_s = 0.0

    def turn(self) -> bool:
        """Run one cycle; return whether the drives took their commands over."""
        began = self._clock()
        self._was_late = False
        self._drain()
        probing = self._probing = self._wants_probe()
        sent = self._send(with_sync=not probing)
        self._asked_s = self._clock()
        asked = sent and not probing
        for answer in self._answers:
            answer.begin(asked)
        if sent:
            self._receive(began + self._window_s, asked)
        self._settle(probing)
        self.cycles += 1
        self._corrupted = max(0.0, self._corrupted - FORGIVEN_A_CYCLE)
        if self.cycles % self._heartbeat_every == 1 % self._heartbeat_every:
            self._send_one(self._heartbeat)
        return asked

    def take_errors(self) -> list[str]:
        """Return what the interface reported since the last call, in words."""
        if self._unsent >= UNSENT_AT_ONCE:
            self._errors.append(f"frames cannot be sent: {self._reason}")
            self._unsent = 0
        errors, self._errors = self._errors, []
        return errors

    def take_corrupted(self) -> bool:
        """Return whether too many frames were malformed of late."""
        if self._corrupted <= CORRUPTED_AT_ONCE:
            return False
        self._corrupted = 0.0
        return True

    def _drain(self) -> None:
        for _ in range(MOST_FRAMES):
            message = self._next(0.0)
            if message is None:
                return
            if self._handle(message):
                self._was_late = True

    def _wants_probe(self) -> bool:
        """Return whether to leave SYNC out this time; not on top of a missed cycle, unless that is what ails."""
        if not any(answer.wants_probe for answer in self._answers):
            return False
        return self._probing or all(answer.age == 0 or answer.is_late for answer in self._answers)

    def _settle(self, probing: bool) -> None:
        was_late = self._was_late
        for answer in self._answers:
            if probing:
                was_late = answer.probe() or was_late
            else:
                was_late = was_late or answer.came_late
                answer.settle()
        if was_late:
            self.late += 1

    def _send(self, with_sync: bool) -> bool:
        for message in (*self._commands, self._sync) if with_sync else self._commands:
            if not self._send_one(message):
                self._unsent += 1
                return False
        self._unsent = 0
        return True

    def _send_one(self, message: can.Message) -> bool:
        try:
            self._bus.send(message)
        except (can.CanError, OSError) as error:
            self._reason = str(error)
            return False
        return True

    def _receive(self, deadline: float, asked: bool) -> None:
        for _ in range(MOST_FRAMES):
            left = deadline - self._clock()
            message = self._next(left if left > 0.0 else 0.0)
            if message is None:
                if left <= 0.0:
                    return
                continue
            if self._handle(message) and asked and not any(answer.is_expected for answer in self._answers):
                self.round_trip_s = self._clock() - self._asked_s
                return

    def _next(self, wait_s: float) -> can.Message | None:
        try:
            return self._bus.recv(wait_s)
        except (can.CanError, OSError) as error:
            self._reason = str(error)
            return None

    def _handle(self, message: can.Message) -> bool:
        """Take one frame over; return whether it is an expected TPDO."""
        if message.is_error_frame:
            self._error_frame(message)
            return False
        answer = self._by_id.get(message.arbitration_id)
        if answer is None or message.is_extended_id or message.is_remote_frame:
            if not hand_on(self._network, message):
                self._corrupted += 1.0
            return False
        if not answer.take(message.data):
            self._corrupted += 1.0
        return True

    def _error_frame(self, message: can.Message) -> None:
        kind, details = message.arbitration_id, message.data
        if kind & 0x1FF == CONTROLLER_CLASS and len(details) > 1 and details[1] == ACTIVE_AGAIN:
            return  # the controller is well again
        words = [word for bit, word in _CLASSES.items() if kind & bit]
        if len(self._errors) < MOST_FRAMES:
            self._errors.append(", ".join(words) or "error frame")
