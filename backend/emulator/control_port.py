"""The emulator's control port: one JSON request a line on 127.0.0.1, one JSON reply a line."""

import json
import selectors
import socket
from collections.abc import Callable
from typing import Any

from backend.emulator.listening import Listening

Answer = Callable[[dict[str, Any]], dict[str, Any]]
PORT = 29536
"""Of the bus, unless another one is asked for; the control port is the next."""
LONGEST = 65536  # bytes of a request


class ControlPort:
    """Serves requests; `answer` says what they lead to."""

    def __init__(self, port: int, selector: selectors.BaseSelector, answer: Answer) -> None:
        self._selector, self._answer = selector, answer
        self._text: dict[socket.socket, bytes] = {}
        self._listening = Listening(port, selector, self._take)
        self.port = self._listening.port

    def close(self) -> None:
        """Let all clients go."""
        for connection in tuple(self._text):
            self._let_go(connection)
        self._listening.close()

    def _take(self, connection: socket.socket) -> None:
        self._text[connection] = b""
        self._selector.register(connection, selectors.EVENT_READ, lambda _events: self._ready(connection))

    def _ready(self, connection: socket.socket) -> None:
        try:
            data = connection.recv(LONGEST)
            *lines, rest = (self._text[connection] + data).split(b"\n")
            self._text[connection] = rest
            for line in lines:
                connection.sendall(json.dumps(self._reply(line)).encode() + b"\n")
            if not data or len(rest) > LONGEST:
                self._let_go(connection)
        except BlockingIOError:
            self._let_go(connection)  # it asks without reading
        except OSError:
            self._let_go(connection)

    def _reply(self, line: bytes) -> dict[str, Any]:
        try:
            request = json.loads(line)
        except ValueError:
            return {"error": 'a line was no JSON; expected such as {"do": "state"}'}
        if not isinstance(request, dict):
            return {"error": 'a line was no JSON object; expected such as {"do": "state"}'}
        return self._answer(request)

    def _let_go(self, connection: socket.socket) -> None:
        if connection in self._text:
            del self._text[connection]
            self._selector.unregister(connection)
            connection.close()


def ask(port: int, request: dict[str, Any], timeout_s: float = 5.0) -> dict[str, Any]:
    """Send one request to the control port of an emulator on this machine, return its reply. Raises OSError."""
    with socket.create_connection(("127.0.0.1", port), timeout_s) as connection:
        connection.sendall(json.dumps(request).encode() + b"\n")
        with connection.makefile("rb") as lines:
            line = lines.readline()
    if not line:
        raise ConnectionError("the emulator closed its control port without a reply")
    reply: dict[str, Any] = json.loads(line)
    return reply
