"""Entry of the control process of a simulated session."""

import signal
from multiprocessing.connection import Connection

from backend.loop.real_time import compile_first, settle_down
from backend.telemetry.ring import REAL_TIME, RingWriter
from backend.telemetry.stop_flag import StopFlag


def run_control_process(ring_name: str, flag_name: str, epoch: int, pipe: Connection) -> None:
    """Turn the loop of one session until `pipe` closes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl+C is the web process's to handle
    compile_first()
    from backend.loop.control_loop import ControlLoop
    from backend.loop.messages import Ready

    ring, flag = RingWriter(ring_name), StopFlag(flag_name)
    loop = ControlLoop(ring, flag, pipe)
    loop.epoch = epoch
    ring.header[REAL_TIME] = settle_down()
    pipe.send(Ready())
    loop.run()
