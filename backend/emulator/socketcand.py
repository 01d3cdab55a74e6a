"""A socketcand server in raw mode, without threads: lines of text over TCP, as python-can's backend speaks them."""

import selectors
import socket
import struct
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import suppress

from backend.emulator.listening import Listening

HELD_BACK_S = 0.05
"""How long a client gets no frames after its handshake: its last answer has to arrive alone."""
MOST_WAITING = 1 << 20  # bytes; a client that reads so little is let go
QUICK_ACK = getattr(socket, "TCP_QUICKACK", None)
STAMPS = getattr(socket, "SO_TIMESTAMPNS", 35 if sys.platform == "linux" else None)
"""Asks the kernel when data arrived, so that a drive latches at SYNC however late this process is woken."""
STAMP = struct.Struct("qq")
OLDEST_S = 0.1
Receive = Callable[[int, bytes, float], None]


def frame_text(can_id: int, data: bytes) -> bytes:
    """Return a frame as socketcand says it."""
    return f"< frame {can_id:03X} {time.time():.6f} {data.hex()} >".encode("ascii")


def error_text(flags: int) -> bytes:
    """Return an error frame as socketcand says it; `flags` as in linux/can/error.h."""
    return f"< error {0x20000000 | flags:08X} {time.time():.6f} >".encode("ascii")


def parsed_send(words: list[str]) -> tuple[int, bytes] | None:
    """Return identifier and data of `send id length byte byte ...`, or None if that is no frame."""
    try:
        can_id, length = int(words[1], 16), int(words[2], 16)
        data = bytes(int(word, 16) for word in words[3:])
    except (ValueError, IndexError):
        return None
    return (can_id, data) if len(data) == length <= 8 and len(words[1]) == 3 else None


class Client:
    """One connection."""

    def __init__(self, connection: socket.socket) -> None:
        self.connection = connection
        self.raw = False
        self.frames_from = 0.0
        self.early = bytearray()  # frames until then
        self.waiting = bytearray()
        self.arrived = 0.0  # when the newest data came, by time.monotonic
        self._text = ""
        self._stamped = False
        if STAMPS is not None:
            with suppress(OSError):
                connection.setsockopt(socket.SOL_SOCKET, STAMPS, 1)
                self._stamped = True

    def lines(self) -> Iterator[list[str]]:
        """Yield the words of each message that has come. Raises ConnectionError at the end, OSError."""
        stamps: list[tuple[int, int, bytes]] = []
        if self._stamped:
            data, stamps, _, _ = self.connection.recvmsg(65536, 64)
        else:
            data = self.connection.recv(65536)
        if not data:
            raise ConnectionError
        self.arrived = time.monotonic()
        for _, kind, content in stamps:
            if kind == STAMPS and len(content) == STAMP.size:
                seconds, nanoseconds = STAMP.unpack(content)
                self.arrived -= min(OLDEST_S, max(0.0, time.time() - seconds - 1e-9 * nanoseconds))
        if QUICK_ACK is not None:  # small writes of a client without TCP_NODELAY wait for the acknowledgement
            self.connection.setsockopt(socket.IPPROTO_TCP, QUICK_ACK, 1)
        *messages, self._text = (self._text + data.decode("ascii", "replace")).split(">")
        self._text = self._text[-200:]
        for message in messages:
            yield message.replace("<", " ").split()


class SocketcandServer:
    """Serves one CAN bus on 127.0.0.1; every client gets the frames of the nodes and of the other clients."""

    def __init__(self, port: int, selector: selectors.BaseSelector, receive: Receive) -> None:
        self._selector, self._receive = selector, receive
        self._listening = Listening(port, selector, self._take_client)
        self.port = self._listening.port
        self._clients: list[Client] = []
        self._outgoing = bytearray()
        self._held: set[Client] = set()  # shortly after their handshake

    def send(self, can_id: int, data: bytes) -> None:
        """Send a frame to every client, with the next `flush`."""
        if self._clients:
            self._outgoing += frame_text(can_id, data)

    def send_error(self, flags: int) -> None:
        """Send an error frame to every client, with the next `flush`."""
        self._outgoing += error_text(flags)

    def flush(self) -> None:
        """Write what was sent since the last time."""
        if not self._outgoing and not self._held:
            return
        for client in tuple(self._clients):
            self._show(client, self._outgoing)
        self._outgoing.clear()

    def close(self) -> None:
        """Let all clients go."""
        for client in tuple(self._clients):
            self._let_go(client)
        self._listening.close()

    def _take_client(self, connection: socket.socket) -> None:
        client = Client(connection)
        self._clients.append(client)
        self._selector.register(connection, selectors.EVENT_READ, lambda events: self._ready(client, events))
        self._write(client, b"< hi >")

    def _ready(self, client: Client, events: int) -> None:
        if events & selectors.EVENT_WRITE:
            self._write(client, b"")
        if not events & selectors.EVENT_READ:
            return
        try:
            for words in client.lines():
                self._take(client, words)
        except BlockingIOError:
            return
        except OSError:
            self._let_go(client)

    def _take(self, client: Client, words: list[str]) -> None:
        match words:
            case ["send", *_] if client.raw:
                frame = parsed_send(words)
                if frame is not None:
                    client.frames_from = 0.0
                    for other in tuple(self._clients):
                        if other is not client:
                            self._show(other, frame_text(*frame))
                    self._receive(*frame, client.arrived)
            case ["open", _]:
                self._write(client, b"< ok >")
            case ["rawmode"]:
                client.raw, client.frames_from = True, time.monotonic() + HELD_BACK_S
                self._held.add(client)
                self._write(client, b"< ok >")
            case ["echo"]:
                self._write(client, b"< echo >")
            case _ if not client.raw:
                self._write(client, b"< error unknown command >")

    def _show(self, client: Client, text: bytes | bytearray) -> None:
        if client in self._held:
            client.early += text
            if time.monotonic() < client.frames_from:
                return
            self._held.discard(client)
            text = client.early
        if client.raw and text:
            self._write(client, text)

    def _write(self, client: Client, data: bytes | bytearray) -> None:
        if client not in self._clients:
            return
        client.waiting += data
        try:
            sent = client.connection.send(client.waiting)
        except BlockingIOError:
            sent = 0
        except OSError:
            self._let_go(client)
            return
        had = len(client.waiting) > len(data)
        del client.waiting[:sent]
        if len(client.waiting) > MOST_WAITING:
            self._let_go(client)
        elif client.waiting or had:
            events = selectors.EVENT_READ | (selectors.EVENT_WRITE if client.waiting else 0)
            self._selector.modify(client.connection, events, self._selector.get_key(client.connection).data)

    def _let_go(self, client: Client) -> None:
        if client in self._clients:
            self._clients.remove(client)
            self._held.discard(client)
            self._selector.unregister(client.connection)
            client.connection.close()
