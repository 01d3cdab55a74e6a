"""Killing a child of the server by the name that it has given itself."""

import os
import signal
from pathlib import Path

from benchmarks.live_server import Server, children


def kill(server: Server, name: str) -> None:
    """End a child as a crash does."""
    for child in children(server.process.pid):
        if Path(f"/proc/{child}/comm").read_text().strip() == name[:15]:
            os.kill(child, signal.SIGKILL)
