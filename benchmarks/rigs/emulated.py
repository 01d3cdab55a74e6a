"""An emulator and a server that is connected to it, for a measurement."""

import tomllib
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.resources import files
from typing import Any

from backend.emulator.start import EmulatorHandle, start_emulator
from benchmarks.live_server import Server, running_server
from benchmarks.rigs.operator import Operator

RIG = "measured"
CENTRED = tuple(f"holding {position} rad" for position in ("0.000", "-0.000", "0.001", "-0.001"))
"""A way of less than a milliradian is none."""


def rig_text(bus_port: int, rate_hz: int) -> str:
    """Return the built-in rig's file with another port and rate."""
    text = files("backend.rigs").joinpath("emulator.toml").read_text("utf-8")
    built_in = tomllib.loads(text)
    text = (
        text.replace("speed = 40.0", "speed = 120.0")
        .replace('name = "emulator"', f'name = "{RIG}"')
        .replace("port = 29536", f"port = {bus_port}")
    )
    return text.replace(f"rate_hz = {built_in['rate_hz']}", f"rate_hz = {rate_hz}")


@contextmanager
def emulated_rig(rate_hz: int = 500, probed: bool = False, **settings: str) -> Iterator[tuple[Server, EmulatorHandle]]:
    """Start emulator and server, and let the server know the rig."""
    emulator = start_emulator()
    try:
        with running_server(probed=probed, VSSEA_SCENE="false", **settings) as server:
            introduce(server, emulator, rate_hz)
            yield server, emulator
    finally:
        emulator.close()


def introduce(server: Server, emulator: EmulatorHandle, rate_hz: int) -> None:
    """Give the server the emulator's rig file."""
    body = rig_text(emulator.port, rate_hz).encode()
    address = f"http://127.0.0.1:{server.port}/api/rigs/{RIG}"
    request = urllib.request.Request(address, body, {"Content-Type": "application/toml"}, method="PUT")
    urllib.request.urlopen(request, timeout=10).close()


def armed(operator: Operator, **tuning: Any) -> None:
    """Connect, home and arm; the lease is renewed from here on."""
    if operator.snapshot["rig"].get("connected"):
        operator.ask("take_control")
        operator.ask("disconnect_rig")
    operator.ask("connect_rig", rig=RIG)
    operator.present = True
    operator.wait(lambda: bool(operator.snapshot["rig"].get("connected")), "connection")
    if operator.state == "fault":  # a drive keeps its fault until it is reset
        operator.ask("reset")
        operator.wait_for("connected")
    operator.wait(lambda: operator.snapshot["rig"].get("lease_left_s", 0.0) > 0.0, "first renewal")
    if tuning:
        operator.ask("tune", changes=tuning)
    if not operator.snapshot["rig"]["homed"]:
        operator.ask("home_stiffness")
        operator.wait(lambda: bool(operator.snapshot["rig"]["homed"]) and operator.state == "ready", "homing")
    operator.wait(lambda: not operator.snapshot["rig"]["cannot_arm"], "readiness to arm")
    operator.ask("arm")
    operator.wait_for("armed")
    operator.ask("go_to", position=0.0, speed=0.6)
    operator.wait(lambda: operator.snapshot["rig"]["motion"] in CENTRED, "centre")
