"""A TCP line between page and server that can be cut without anybody being told, as an unplugged cable is."""

import selectors
import socket
import threading


class Line:
    """Passes bytes on to a port until it is cut; then both sides wait for ever."""

    def __init__(self, port: int) -> None:
        self._to = port
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port = self._listener.getsockname()[1]
        self._cut = threading.Event()
        self._sockets: list[socket.socket] = []
        threading.Thread(target=self._accept, daemon=True).start()

    def cut(self) -> None:
        """Pass nothing on from now on; the connections stay."""
        self._cut.set()

    def close(self) -> None:
        """End all connections."""
        for each in (self._listener, *self._sockets):
            each.close()

    def _accept(self) -> None:
        while True:
            try:
                near, _ = self._listener.accept()
            except OSError:
                return
            far = socket.create_connection(("127.0.0.1", self._to))
            self._sockets += [near, far]
            threading.Thread(target=self._pass, args=(near, far), daemon=True).start()

    def _pass(self, near: socket.socket, far: socket.socket) -> None:
        with selectors.DefaultSelector() as selector:
            selector.register(near, selectors.EVENT_READ, far)
            selector.register(far, selectors.EVENT_READ, near)
            while not self._cut.is_set():
                for key, _ in selector.select(0.05):
                    try:
                        content = key.fileobj.recv(65536)  # type: ignore[union-attr]
                        if not content:
                            near.close()
                            far.close()
                            return
                        key.data.sendall(content)
                    except OSError:
                        return
