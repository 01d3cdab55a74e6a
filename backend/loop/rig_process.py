"""Entry of the control process of a rig."""

import signal
from multiprocessing.connection import Connection

from backend.loop.real_time import compile_first, settle_down
from backend.rigs.rig import Rig
from backend.rigs.rig_file import SIMULATED, RigFile
from backend.telemetry.beats import Beats
from backend.telemetry.ring import REAL_TIME, RingWriter
from backend.telemetry.stop_flag import StopFlag
from vssea_core.scenario import Scenario

SWITCHED_ON_AT = 20.0
"""rad that a simulated rig's stiffness encoder is off until it is homed."""


def rig_of(file: RigFile, scenario: Scenario) -> Rig:
    """Return the rig that a file describes, not yet connected."""
    if file.bus.interface == SIMULATED:
        from backend.rigs.simulated import SimulatedRig

        return SimulatedRig(scenario, SWITCHED_ON_AT)
    from backend.rigs.canopen.rig import CanopenRig

    return CanopenRig(file, scenario.actuator.motor.gear_ratio)


def run_rig_process(ring_name: str, flag_name: str, beats_name: str, epoch: int, pipe: Connection) -> None:
    """Turn the loop of a rig until `pipe` closes, Disconnect or SIGTERM; the rig is stopped, disabled and closed first."""
    for number in (signal.SIGINT, signal.SIGHUP):  # Ctrl+C is the web process's to handle
        signal.signal(number, signal.SIG_IGN)
    compile_first()
    from backend.loop.messages import Ready
    from backend.loop.rig_loop import RigLoop

    ring, flag, beats = RingWriter(ring_name), StopFlag(flag_name), Beats(beats_name)
    loop = RigLoop(ring, flag, beats, pipe, rig_of)
    loop.epoch = epoch
    for number in (
        signal.SIGTERM,
        signal.SIGHUP,
        signal.SIGQUIT,
    ):  # also the end of a terminal is no reason to drop a load
        signal.signal(number, lambda number, frame: loop.end())
    ring.header[REAL_TIME] = settle_down()
    pipe.send(Ready())
    loop.run()
