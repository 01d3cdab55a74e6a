"""Opening the CAN bus that a rig's file names, with a sentence where that fails."""

import socket
from typing import Any

import can

from backend.rigs.faults import NO_BUS
from backend.rigs.rig import RigError
from backend.rigs.rig_file import Bus

LISTENING_TIME_LIMIT_S = 1.0


def open_bus(bus: Bus) -> can.BusABC:
    """Return the open bus. Raises RigError where it cannot be opened."""
    config: dict[str, Any] = {"interface": bus.interface, "channel": bus.channel, **bus.options}
    if bus.bitrate is not None:
        config["bitrate"] = bus.bitrate
    if bus.interface == "socketcand":
        _refuse_unless_listening(config.get("host"), config.get("port"))
        # Without it the second small write of a cycle waits until the first one is acknowledged.
        config.setdefault("tcp_tune", True)
    try:
        return can.Bus(ignore_config=True, **config)
    except (can.CanError, OSError, ValueError, TypeError, NotImplementedError, ImportError) as error:
        raise RigError(NO_BUS, f"{bus.interface}, channel {bus.channel}: {error}") from error


def _refuse_unless_listening(host: object, port: object) -> None:
    """Python-can would try for 10 s where nobody listens."""
    if not isinstance(host, str) or not isinstance(port, int):
        raise RigError(NO_BUS, "socketcand needs bus.options host and port")
    try:
        socket.create_connection((host, port), LISTENING_TIME_LIMIT_S).close()
    except OSError as error:
        raise RigError(NO_BUS, f"nothing listens on {host}:{port}, {error.strerror or error}") from error
