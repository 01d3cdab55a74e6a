"""Starting a server to measure, talking to it, and reading what its processes cost."""

import json
import os
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from websockets.asyncio.client import ClientConnection, connect

HEADER = struct.Struct("<4sHHIIIIQdd")
START_LIMIT_S = 120.0
CHROMIUM_FLAGS = ["--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader", "--disable-background-networking"]


@dataclass(frozen=True)
class Server:
    """A running server."""

    process: subprocess.Popen[bytes]
    port: int

    def get(self, path: str) -> Any:
        """Return the JSON answer of a GET."""
        with urllib.request.urlopen(f"http://127.0.0.1:{self.port}{path}", timeout=10) as answer:
            return json.load(answer)

    def post(self, path: str, body: Any = None, time_limit_s: float = 60.0) -> bytes:
        """Return the answer of a POST."""
        request = urllib.request.Request(
            f"http://127.0.0.1:{self.port}{path}", json.dumps(body or {}).encode(), {"Content-Type": "application/json"}
        )
        with urllib.request.urlopen(request, timeout=time_limit_s) as answer:
            content: bytes = answer.read()
        return content

    def processor_seconds(self) -> dict[str, float]:
        """Return the processor time so far of the web process and of each child, by name of its entry."""
        found = {"web": _processor_seconds(self.process.pid)}
        for child in children(self.process.pid):
            found[Path(f"/proc/{child}/comm").read_text().strip()] = _processor_seconds(child)
        return found


@contextmanager
def running_server(probed: bool = False, **settings: str) -> Iterator[Server]:
    """Start a server on a free port with an empty data folder, wait until its session runs, and end it."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    command = (
        ["-m", "benchmarks.probed_server", str(port)] if probed else ["-m", "backend.cli", "serve", "--port", str(port)]
    )
    with tempfile.TemporaryDirectory() as folder:
        environment = os.environ | {"VSSEA_DATA_DIR": folder} | settings
        process = subprocess.Popen(
            [sys.executable, *command], env=environment, cwd=Path(__file__).parent.parent, stdout=subprocess.DEVNULL
        )
        try:
            server = Server(process, port)
            _wait_until_running(server)
            yield server
        finally:
            process.send_signal(signal.SIGTERM)
            process.wait(20)


def _wait_until_running(server: Server) -> None:
    limit = time.monotonic() + START_LIMIT_S
    while time.monotonic() < limit:
        try:
            if server.get("/api/health")["session"] == "running":
                return
        except OSError:
            pass
        time.sleep(0.1)
    raise TimeoutError("the server did not start")


@contextmanager
def open_page(port: int) -> Iterator[Any]:
    """Keep the dashboard open in a headless Chromium, and give its page."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as browser:
        chromium = browser.chromium.launch(
            executable_path=os.environ.get("CHROMIUM", "/usr/bin/chromium"), args=CHROMIUM_FLAGS
        )
        page = chromium.new_page(viewport={"width": 1366, "height": 768})
        page.goto(f"http://127.0.0.1:{port}/", wait_until="load", timeout=60_000)
        yield page
        chromium.close()


class LivePage:
    """One page on the live websocket."""

    def __init__(self, socket_: ClientConnection) -> None:
        self._socket = socket_
        self._count = 0
        self.names: list[str] = []
        self.next_sample: int | None = None
        self.lost = 0

    async def message(self) -> "dict[str, Any] | np.ndarray":
        """Return the next message: a JSON document, or a frame's samples (channels, n)."""
        content = await self._socket.recv()
        if isinstance(content, str):
            message: dict[str, Any] = json.loads(content)
            if message["type"] == "hello":
                self.names = [channel["name"] for channel in message["channels"]]
            return message
        _, _, _, channels, count, _, _, first, _, _ = HEADER.unpack_from(content)
        if self.next_sample is not None:
            self.lost += max(0, first - self.next_sample)
        self.next_sample = first + count
        return np.frombuffer(content, np.float32, offset=HEADER.size).reshape(channels, count)

    async def send(self, command: str, **arguments: Any) -> int:
        """Send a command and return its number."""
        self._count += 1
        await self._socket.send(json.dumps({"id": self._count, "command": command, "arguments": arguments}))
        return self._count

    async def reply(self, number: int) -> dict[str, Any]:
        """Wait for the reply to a command."""
        while True:
            message = await self.message()
            if isinstance(message, dict) and message.get("id") == number:
                return message

    async def of_type(self, kind: str) -> dict[str, Any]:
        """Wait for the next JSON message of a type."""
        while True:
            message = await self.message()
            if isinstance(message, dict) and message.get("type") == kind:
                return message

    async def until(self, channel: str, wanted: Any) -> float:
        """Wait until a sample's channel satisfies `wanted`; return when that was seen [s]."""
        column = self.names.index(channel)
        while True:
            message = await self.message()
            if not isinstance(message, dict) and wanted(message[column]).any():
                return time.perf_counter()


def live_page(port: int) -> Any:
    """Return a connection to the live websocket."""
    return connect(f"ws://127.0.0.1:{port}/api/live?history_s=0", subprotocols=["vssea-1"], max_size=None)  # type: ignore[list-item]


def _processor_seconds(pid: int) -> float:
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def children(pid: int) -> list[int]:
    """Return the process ids of the children of a process."""
    tasks = Path(f"/proc/{pid}/task").iterdir()  # a child belongs to the thread that started it
    return [int(child) for task in tasks for child in (task / "children").read_text().split()]
