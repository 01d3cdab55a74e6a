"""A port on 127.0.0.1 whose clients are taken between two steps of the emulator."""

import selectors
import socket
from collections.abc import Callable


class Listening:
    """Gives every new connection, non-blocking and without delay, to `take`. Raises OSError if the port is in use."""

    def __init__(self, port: int, selector: selectors.BaseSelector, take: Callable[[socket.socket], None]) -> None:
        self._selector, self._take = selector, take
        self._socket = socket.create_server(("127.0.0.1", port))
        self._socket.setblocking(False)
        self.port: int = self._socket.getsockname()[1]
        selector.register(self._socket, selectors.EVENT_READ, self._accept)

    def close(self) -> None:
        """Take nobody any more."""
        self._selector.unregister(self._socket)
        self._socket.close()

    def _accept(self, _events: int) -> None:
        connection, _ = self._socket.accept()
        connection.setblocking(False)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._take(connection)
