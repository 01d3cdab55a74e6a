"""The same scenario on the emulated rig and in simulation: RMS differences of link position and motor torque.

The rig follows a sine; its recording says from which instant on, and the simulation starts there.
"""

import io
import time
import urllib.request
from dataclasses import dataclass

import numpy as np

from backend.emulator.plant import default_actuator
from benchmarks.live_server import Server
from benchmarks.rigs.activities import SINE
from benchmarks.rigs.emulated import armed, emulated_rig
from benchmarks.rigs.operator import Operator
from vssea_core.channels import INDEX
from vssea_core.scenario import Scenario
from vssea_core.signals.documents import ConstantStiffness, SineReference
from vssea_core.simulation.run import simulate

TRACKED_S = 14.0
COMPARED_S = (4.0, 12.0)  # after the fade-in
CHANNELS = ("time", "reference", "link_position", "motor_torque", "stiffness", "error")


@dataclass(frozen=True)
class Span:
    """Samples (n,) of each channel by name, of a span of the newest recording."""

    channels: dict[str, np.ndarray]

    def __getitem__(self, name: str) -> np.ndarray:
        return self.channels[name]


def recorded(server: Server, from_s: float, to_s: float) -> Span:
    """Return a span of the newest recording."""
    newest = server.get("/api/recordings?limit=1")["recordings"][0]["id"]
    asked = f"form=csv&channels={','.join(CHANNELS)}&from_s={from_s}&to_s={to_s}"
    address = f"http://127.0.0.1:{server.port}/api/recordings/{newest}/export?{asked}"
    with urllib.request.urlopen(address, timeout=60) as answer:
        lines = [line for line in answer.read().decode().splitlines() if not line.startswith("#")]
    values = np.genfromtxt(io.StringIO("\n".join(lines[1:])), delimiter=",")
    return Span(dict(zip(CHANNELS, values.T, strict=True)))


def compare(rate_hz: int) -> None:
    """Print the differences at one rate."""
    with emulated_rig(rate_hz) as (server, _), Operator(server.port) as operator:
        armed(operator)
        scenario = Scenario.model_validate(server.get("/api/session")["scenario"])
        operator.ask("set_reference", replace=SINE)
        begun_s = operator.ask("follow")["time_s"]
        time.sleep(TRACKED_S)
        span = recorded(server, begun_s + COMPARED_S[0], begun_s + COMPARED_S[1])
    same = {
        "actuator": default_actuator(),  # the emulated one: with friction and lag
        "reference": SineReference.model_validate(SINE),
        "stiffness_reference": ConstantStiffness(stiffness=float(np.mean(span["stiffness"]))),
        "duration_s": COMPARED_S[1] + 1.0,
    }
    alone = simulate(scenario.model_copy(update=same), 1)
    rows = alone.rows[np.rint((span["time"] - begun_s) / scenario.timing.sample_time_s).astype(int)]
    for name, unit, scale in (("link_position", "mrad", 1e3), ("motor_torque", "N m", 1.0)):
        difference = scale * (span[name] - rows[:, INDEX[name]])
        size = scale * np.sqrt(np.mean(rows[:, INDEX[name]] ** 2))
        print(
            f"{rate_hz} Hz  {name:14} RMS difference {np.sqrt(np.mean(difference**2)):.3g} {unit} of {size:.3g} {unit} RMS"
        )
    for where, error in (("rig", span["error"]), ("simulation", rows[:, INDEX["error"]])):
        print(f"{rate_hz} Hz  tracking error on the {where:10} {1e3 * np.sqrt(np.mean(error**2)):.3g} mrad RMS")


def main() -> None:
    """Print both rates."""
    for rate_hz in (500, 1000):
        compare(rate_hz)
