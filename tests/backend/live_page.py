"""A page of the live websocket as tests see it."""

import json
import time
from collections import deque
from collections.abc import Callable
from types import TracebackType
from typing import Any, Self

from websockets.sync.client import ClientConnection, connect
from websockets.typing import Subprotocol

from tests.backend.frame_decoder import Decoded, decoded
from tests.backend.server import Server

LIMIT_S = 30.0  # for any one thing that a test waits for


class LivePage:
    """One connection; messages that were passed over while looking for another stay for later."""

    def __init__(self, server: Server, history_s: float = 0.0, **options: Any) -> None:
        address = f"ws://127.0.0.1:{server.port}/api/live?history_s={history_s}"
        self.socket: ClientConnection = connect(
            address, subprotocols=[Subprotocol("vssea-1")], compression=None, max_size=None, proxy=None, **options
        )
        self._messages: deque[dict[str, Any]] = deque()
        self._frames: deque[bytes] = deque()
        self._number = 0
        self.hello = self.next_message("hello")

    def _receive(self, deadline: float) -> None:
        content = self.socket.recv(max(0.0, deadline - time.monotonic()))
        if isinstance(content, bytes):
            self._frames.append(content)
        else:
            self._messages.append(json.loads(content, parse_constant=_no_constant))

    def next_message(self, kind: str, fits: Callable[[dict[str, Any]], bool] = lambda message: True) -> dict[str, Any]:
        """The next message of a kind that fits; others are kept."""
        deadline = time.monotonic() + LIMIT_S
        while True:
            for message in self._messages:
                if message["type"] == kind and fits(message):
                    self._messages.remove(message)
                    return message
            self._receive(deadline)

    def passed_over(self, kind: str) -> list[dict[str, Any]]:
        """Messages of a kind that came by while looking for something else."""
        return [message for message in self._messages if message["type"] == kind]

    def next_frame(self) -> bytes:
        deadline = time.monotonic() + LIMIT_S
        while not self._frames:
            self._receive(deadline)
        return self._frames.popleft()

    def next_sample_after(self, fits: Callable[[Decoded], bool]) -> Decoded:
        """The next frame that fits."""
        deadline = time.monotonic() + LIMIT_S
        while not fits(frame := decoded(self.next_frame())):
            if time.monotonic() > deadline:
                raise TimeoutError("no frame that fits")
        return frame

    def send(self, command: str, **arguments: Any) -> int:
        self._number += 1
        self.socket.send(json.dumps({"id": self._number, "command": command, "arguments": arguments}))
        return self._number

    def ask(self, command: str, **arguments: Any) -> dict[str, Any]:
        """Send a command and return its reply."""
        number = self.send(command, **arguments)
        return self.next_message("reply", lambda reply: reply["id"] == number)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.socket.close()


def _no_constant(literal: str) -> None:
    raise AssertionError(f"{literal} is not JSON")
