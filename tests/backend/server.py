"""A server of its own process for tests: started on a free port with a data folder of its own, and ended for sure."""

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import httpx

START_LIMIT_S = 120.0  # the kernels may have to be compiled first
END_LIMIT_S = 20.0
LOOK_AGAIN_S = 0.02
ROLES = (
    "control",
    "design",
    "analysis",
    "simulation",
    "recordings",
    "recorder",
    "archive",
    "tasks",
    "batch 1",
    "batch 2",
)
KEPT_OF_A_NAME = 15
Found = TypeVar("Found")


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        return int(listener.getsockname()[1])


def until(look: Callable[[], Found], limit_s: float = 20.0) -> Found:
    """Look again and again until something is found; fails after a bounded time."""
    deadline = time.monotonic() + limit_s
    while not (found := look()):
        if time.monotonic() > deadline:
            raise TimeoutError(f"not within {limit_s:g} s: {look}")
        time.sleep(LOOK_AGAIN_S)
    return found


class Server:
    """`python -m backend.cli serve` with settings from the environment."""

    def __init__(self, data_dir: Path, port: int | None = None, **settings: str) -> None:
        self.port = port or free_port()
        self.url = f"http://127.0.0.1:{self.port}"
        self.errors = data_dir / f"stderr-{self.port}"
        data_dir.mkdir(parents=True, exist_ok=True)
        own = {"VSSEA_DATA_DIR": str(data_dir), "VSSEA_SCENE": "false"} | settings
        kept = {name: value for name, value in os.environ.items() if not name.startswith("VSSEA_")}
        with self.errors.open("ab") as errors:
            self.process = subprocess.Popen(
                [sys.executable, "-m", "backend.cli", "serve", "--port", str(self.port)],
                env=kept | own, stdout=subprocess.DEVNULL, stderr=errors,
            )  # fmt: skip

    def answers(self) -> bool:
        """Whether it answers; fails if it has ended."""
        if self.process.poll() is not None:
            raise RuntimeError(f"the server ended: {self.errors.read_text()}")
        try:
            return httpx.get(self.url + "/api/health", trust_env=False).status_code in (200, 401)
        except httpx.TransportError:
            return False

    def wait_until_running(self) -> "Server":
        """Return when the session has left `starting`."""
        until(self.answers, START_LIMIT_S)
        until(lambda: self.get("/api/health").json()["session"] != "starting", START_LIMIT_S)
        return self

    def get(self, path: str) -> httpx.Response:
        return httpx.get(self.url + path, trust_env=False)

    def post(self, path: str, body: Any = None) -> httpx.Response:
        return httpx.post(self.url + path, json={} if body is None else body, trust_env=False, timeout=60.0)

    def children(self) -> dict[str, int]:
        """Process ids of the children by the entry that each runs, told from their threads of execution in /proc."""
        task = Path(f"/proc/{self.process.pid}/task")
        pids = [int(pid) for thread in task.iterdir() for pid in (thread / "children").read_text().split()]
        return {name: pid for pid in pids if (name := _role(pid))}

    def terminate(self) -> str:
        """End it as a service manager does, and return what it wrote on stderr."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
            try:
                self.process.wait(END_LIMIT_S)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
                raise
        return self.errors.read_text()

    def kill(self) -> None:
        """End it at once, as a crash does; its children follow, as their pipes close."""
        self.process.kill()
        self.process.wait()


def _role(pid: int) -> str | None:
    """What a child is for: the name that it has given itself, without the program's and as far as the system keeps it."""
    try:
        name = Path(f"/proc/{pid}/comm").read_text().strip()
    except OSError:
        return None
    return next((role for role in ROLES if f"vssea {role}"[:KEPT_OF_A_NAME] == name), None)
