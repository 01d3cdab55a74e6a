"""An emulated rig on a CAN interface of the system, such as vcan0, through python-can."""

import selectors
import time
from collections.abc import Callable

import can

Receive = Callable[[int, bytes, float], None]


class CanInterface:
    """Frames of `can.Bus(interface=..., channel=...)`, which must have a file to wait for, as socketcan has. Raises OSError."""

    def __init__(self, interface: str, channel: str, selector: selectors.BaseSelector, receive: Receive) -> None:
        self._selector, self._receive = selector, receive
        try:
            self._bus = can.Bus(interface=interface, channel=channel)
        except can.CanError as error:
            raise OSError(str(error)) from error
        try:
            selector.register(self._bus.fileno(), selectors.EVENT_READ, self._ready)
        except NotImplementedError as error:
            self._bus.shutdown()
            raise OSError(f"{interface} cannot be waited for; expected an interface such as socketcan") from error

    def send(self, can_id: int, data: bytes) -> None:
        """Send a frame."""
        self._bus.send(can.Message(arbitration_id=can_id, data=data, is_extended_id=False))

    def send_error(self, flags: int) -> None:
        """An error frame cannot be sent by an interface that works; the nodes only fall silent."""

    def flush(self) -> None:
        """Everything has been sent already."""

    def close(self) -> None:
        """Close the interface."""
        self._selector.unregister(self._bus.fileno())
        self._bus.shutdown()

    def _ready(self, _events: int) -> None:
        message = self._bus.recv(0.0)
        if message is not None and not message.is_error_frame and not message.is_extended_id:
            age = min(0.1, max(0.0, time.time() - message.timestamp))
            self._receive(message.arbitration_id, bytes(message.data), time.monotonic() - age)
