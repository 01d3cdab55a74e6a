"""The nodes of a bus: object dictionary by SDO, network management, emergencies and heartbeats, without a thread.

An SDO client that waits for its answer reads the bus itself and hands on what else comes, so everything happens in the
caller's own thread, in order.
"""

import logging
import struct
import time
from collections.abc import Callable
from typing import Any, Literal

import can
import canopen
from canopen.sdo.client import SdoClient
from canopen.sdo.exceptions import SdoCommunicationError, SdoError

Clock = Callable[[], float]
ANSWER_TIME_LIMIT_S = 0.5

# A library logs only where somebody listens; else Python prints its errors to standard error.
for _name in ("canopen", "can"):
    logging.getLogger(_name).addHandler(logging.NullHandler())


class NodeError(Exception):
    """An object that a node did not read or write, in words."""


class _Client(SdoClient):
    """An SDO client that reads the bus while it waits."""

    clock: Clock = time.monotonic

    def read_response(self) -> bytes:
        limit = self.clock() + ANSWER_TIME_LIMIT_S
        while self.responses.empty():
            left = limit - self.clock()
            if left <= 0.0:
                raise SdoCommunicationError("no answer")
            message = self.network.bus.recv(left) if self.network.bus else None
            if message is not None:
                hand_on(self.network, message)
        self.RESPONSE_TIMEOUT = 0.0  # it is there
        return super().read_response()


class _RemoteNode(canopen.RemoteNode):
    def add_sdo(self, rx_cobid: int, tx_cobid: int) -> SdoClient:
        client = _Client(rx_cobid, tx_cobid, self.object_dictionary)
        self.sdo_channels.append(client)
        return client


def hand_on(network: canopen.Network, message: can.Message) -> bool:
    """Give a frame to who waits for it; return False where it is malformed."""
    if message.is_error_frame or message.is_remote_frame:
        return True
    try:
        network.notify(message.arbitration_id, message.data, message.timestamp)
    except struct.error:
        return False
    return True


class Node:
    """One node, by its number."""

    def __init__(self, network: canopen.Network, number: int, clock: Clock = time.monotonic) -> None:
        self.number = number
        self._node: Any = _RemoteNode(number, canopen.ObjectDictionary())
        self._node.sdo.clock = clock
        network.add_node(self._node)
        self.error_code = 0
        self.restarted = False
        self._node.emcy.add_callback(self._emergency)
        self._node.nmt.add_heartbeat_callback(self._heartbeat)
        self._new_errors: list[int] = []

    def manage(self, state: Literal["OPERATIONAL", "PRE-OPERATIONAL"]) -> None:
        """Tell the node to go to a state of network management. Raises can.CanError, OSError."""
        self._node.nmt.state = state

    def forget(self) -> None:
        """Take what has happened so far for seen."""
        self.restarted = False
        self._new_errors = []

    def read(self, index: int, subindex: int, form: str) -> int:
        """Return an integer object of struct `form` such as "<H". Raises NodeError."""
        data = self.read_bytes(index, subindex)
        size = struct.calcsize(form)
        if len(data) < size:
            raise NodeError(f"0x{index:04X}:{subindex:02X} has {len(data)} bytes, expected {size}")
        return struct.unpack_from(form, data)[0]

    def read_bytes(self, index: int, subindex: int) -> bytes:
        """Return an object's bytes. Raises NodeError."""
        try:
            return bytes(self._node.sdo.upload(index, subindex))
        except (SdoError, can.CanError, OSError) as error:
            raise NodeError(f"0x{index:04X}:{subindex:02X}: {_worded(error)}") from error

    def read_text(self, index: int, subindex: int = 0) -> str:
        """Return a text object, "" where the node has none."""
        try:
            return self.read_bytes(index, subindex).decode("utf-8", "replace").strip("\0 ")
        except NodeError:
            return ""

    def write(self, index: int, subindex: int, form: str, value: int) -> None:
        """Write an integer object of struct `form`. Raises NodeError."""
        try:
            self._node.sdo.download(index, subindex, struct.pack(form, value))
        except (SdoError, can.CanError, OSError) as error:
            raise NodeError(f"0x{index:04X}:{subindex:02X} = {value}: {_worded(error)}") from error

    def take_errors(self) -> list[int]:
        """Return the error codes that came since the last call."""
        new, self._new_errors = self._new_errors, []
        return new

    def _emergency(self, error: Any) -> None:
        self._node.emcy.reset()  # its own log would grow for ever
        self.error_code = error.code
        if error.code & 0xFF00:
            self._new_errors.append(error.code)

    def _heartbeat(self, state: int) -> None:
        if state == 0:
            self.restarted = True


def _worded(error: Exception) -> str:
    text = str(error)
    return text.split(", ", 1)[-1].lower() if text.startswith("Code 0x") else text or type(error).__name__
