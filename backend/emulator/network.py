"""The bus as the emulated nodes see it: what they send goes out by a callback, and time is told, not read."""

import math
from collections.abc import Callable
from typing import Any

import canopen

Send = Callable[[int, bytes], None]


class PeriodicFrame:
    """A frame that is sent again and again, such as a heartbeat."""

    def __init__(self, network: "EmulatedNetwork", can_id: int, data: bytes, period_s: float) -> None:
        self._network, self._can_id, self._data, self._period_s = network, can_id, bytes(data), period_s
        self.due = network.now

    def update(self, data: Any) -> None:
        """Send other content from now on."""
        self._data = bytes(data)

    def stop(self) -> None:
        """Send no more."""
        self._network.periodic.discard(self)

    def turn(self, now: float) -> None:
        """Send if it is time."""
        if now < self.due:
            return
        self.due = max(self.due + self._period_s, now)  # a stall is not followed by a burst
        self._network.send_message(self._can_id, self._data)


class EmulatedNetwork(canopen.Network):
    """canopen's network without a bus and without threads: the owner hands frames to `notify` and time to `now`."""

    def __init__(self, send: Send) -> None:
        super().__init__()
        self.now = 0.0
        self.periodic: set[PeriodicFrame] = set()
        self._send = send

    def send_message(self, can_id: int, data: Any, remote: bool = False) -> None:
        """Send a frame."""
        self._send(can_id, bytes(data))

    def send_periodic(self, can_id: int, data: Any, period: float, remote: bool = False) -> Any:
        """Send a frame every `period` [s], from now on."""
        frame = PeriodicFrame(self, can_id, bytes(data), period)
        self.periodic.add(frame)
        return frame

    def deadline(self) -> float:
        """Return when the next periodic frame is due."""
        return min((frame.due for frame in self.periodic), default=math.inf)

    def turn(self, now: float) -> None:
        """Send the periodic frames that are due."""
        self.now = now
        for frame in tuple(self.periodic):
            frame.turn(now)
