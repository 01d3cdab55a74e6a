"""An operator without a browser: the live websocket, the lease renewed every 100 ms, and ways to go silent."""

import json
import threading
import time
from collections.abc import Callable
from typing import Any, Self

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect
from websockets.typing import Subprotocol

RENEW_S = 0.1
LIMIT_S = 40.0


class Refused(Exception):
    """A command that was refused, with the sentence of the problem."""


class Operator:
    """One page that holds the lease; `present` and `jogging` are what its timer keeps up."""

    def __init__(self, port: int) -> None:
        self._socket = connect(
            f"ws://127.0.0.1:{port}/api/live?history_s=0", subprotocols=[Subprotocol("vssea-1")],
            compression=None, max_size=None, proxy=None,
        )  # fmt: skip
        self.snapshot: dict[str, Any] = {}
        self.state_at_s: dict[str, float] = {}
        self.present = False
        self.jogging: dict[str, float] | None = None
        self._replies: dict[int, dict[str, Any]] = {}
        self._news = threading.Condition()
        self._number = 0
        self._sending = threading.Lock()
        self._open = True
        for work in (self._receive, self._renew):
            threading.Thread(target=work, daemon=True).start()
        self.wait(lambda: bool(self.snapshot), "hello")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Go, as a closed tab does."""
        self._open = False
        self._socket.close()

    @property
    def state(self) -> str:
        """The session's state as last told."""
        return str(self.snapshot["state"])

    def send(self, command: str, **arguments: Any) -> int:
        """Send a command and return its number."""
        with self._sending:
            self._number += 1
            self._socket.send(json.dumps({"id": self._number, "command": command, "arguments": arguments}))
            return self._number

    def ask(self, command: str, **arguments: Any) -> Any:
        """Return the result of a command. Raises Refused."""
        number = self.send(command, **arguments)
        self.wait(lambda: number in self._replies, command)
        reply = self._replies.pop(number)
        if not reply["ok"]:
            raise Refused(reply["problem"]["detail"])
        return reply["result"]

    def wait_for(self, *states: str, limit_s: float = LIMIT_S) -> str:
        """Return the first of these states that the session is in."""
        self.wait(lambda: self.state in states, " or ".join(states), limit_s)
        return self.state

    def wait(self, look: Callable[[], bool], what: str, limit_s: float = LIMIT_S) -> None:
        """Return when `look` finds what it looks for. Raises TimeoutError."""
        with self._news:
            if not self._news.wait_for(look, limit_s):
                raise TimeoutError(f"no {what} within {limit_s:g} s; {self.snapshot.get('sentence')}")

    def _receive(self) -> None:
        try:
            for content in self._socket:
                if isinstance(content, str):
                    with self._news:
                        self._take(json.loads(content))
                        self._news.notify_all()
        except (ConnectionClosed, OSError):
            return

    def _take(self, message: dict[str, Any]) -> None:
        if message["type"] in ("hello", "state"):
            self.snapshot = message["snapshot"]
            self.state_at_s[self.state] = time.monotonic()
        elif message["type"] == "reply" and message["id"] is not None:
            self._replies[message["id"]] = message

    def _renew(self) -> None:
        while self._open:
            time.sleep(RENEW_S)
            try:
                if self.present:
                    self.send("renew_control")
                if self.jogging is not None:
                    self.send("jog", **self.jogging)
            except (ConnectionClosed, OSError):
                return
            with self._news:  # nobody asks for these replies
                while len(self._replies) > 50:
                    self._replies.pop(next(iter(self._replies)))
