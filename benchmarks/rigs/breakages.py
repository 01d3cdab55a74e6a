"""Every way in which the campaign breaks the rig, the program, or the line between them."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from backend.emulator.start import EmulatorHandle
from benchmarks.live_server import Server
from benchmarks.rigs.line import Line
from benchmarks.rigs.operator import Operator
from benchmarks.rigs.processes import kill


@dataclass(frozen=True)
class Case:
    """What a breakage may take hold of."""

    emulator: EmulatorHandle
    server: Server
    line: Line
    operator: Operator


@dataclass(frozen=True)
class Breakage:
    """One way to break it; `harmless` ones may leave the rig running."""

    name: str
    break_it: Callable[[Case], Any]
    harmless: bool = False
    server_survives: bool = True


def _fault(name: str, **arguments: Any) -> Callable[[Case], Any]:
    return lambda case: case.emulator.control({"do": "fault", "name": name, **arguments})


def _silent(case: Case) -> None:
    case.operator.present = False
    case.operator.jogging = None


BREAKAGES = (
    Breakage("frames dropped, 5 %", _fault("frames_dropped", value=0.05), harmless=True),
    Breakage("frames dropped, half", _fault("frames_dropped", value=0.5)),
    Breakage("frames delayed 5 ms", _fault("frames_delayed", value=5.0)),
    Breakage("frames corrupted, 20 %", _fault("frames_corrupted", value=0.2)),
    Breakage("link encoder frozen", _fault("encoder_frozen", axis="link"), harmless=True),  # at rest nobody can tell
    Breakage("motor encoder frozen", _fault("encoder_frozen", axis="motor"), harmless=True),
    Breakage("stiffness encoder frozen", _fault("encoder_frozen", axis="stiffness"), harmless=True),
    Breakage("link encoder jumps 0.3 rad", _fault("encoder_jump", axis="link", value=0.3)),
    Breakage("motor encoder jumps 0.3 rad", _fault("encoder_jump", axis="motor", value=0.3)),
    Breakage("motor drive fault", _fault("drive_fault", node=1, value=0x2310)),
    Breakage("stiffness drive fault", _fault("drive_fault", node=2, value=0x2310)),
    Breakage("over-temperature", _fault("over_temperature", node=1)),
    Breakage("bus off", _fault("bus_off")),
    Breakage("link lost", _fault("link_lost")),
    Breakage("motor drive reboots", _fault("node_reboot", node=1)),
    Breakage("encoder reboots", _fault("node_reboot", node=3)),
    Breakage("motor torque saturated", _fault("torque_saturated", node=1, value=0.1), harmless=True),
    Breakage("link inertia x 4", _fault("wrong_inertia", value=4.0), harmless=True),
    Breakage("stiffness end stop hit", _fault("end_stop")),
    Breakage("control process killed", lambda case: kill(case.server, "vssea control")),
    Breakage("web process killed", lambda case: case.server.process.kill(), server_survives=False),
    Breakage("browser gone", lambda case: case.operator.close()),
    Breakage("tab hidden", _silent),
    Breakage("network cut", lambda case: case.line.cut()),
)
