"""Entry of the control process: what real-time loops want of an operating system, then the loop."""

import ctypes
import gc
import os
import signal
import sys
from multiprocessing.connection import Connection

from backend.telemetry.ring import REAL_TIME, RingWriter
from backend.telemetry.stop_flag import StopFlag

MCL_CURRENT_AND_FUTURE = 3
PRIORITY = 20


def run_control_process(ring_name: str, flag_name: str, epoch: int, pipe: Connection) -> None:
    """Turn the loop of one session until `pipe` closes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl+C is the web process's to handle
    from filelock import FileLock

    from vssea_core.compiled import cache_folder

    folder = cache_folder()
    folder.mkdir(parents=True, exist_ok=True)
    with FileLock(folder / "compiling.lock"):  # who comes second finds the machine code ready
        from backend.loop.warm import compile_kernels

        compile_kernels()
    from backend.loop.control_loop import ControlLoop
    from backend.loop.messages import Ready

    ring, flag = RingWriter(ring_name), StopFlag(flag_name)
    loop = ControlLoop(ring, flag, pipe)
    loop.epoch = epoch
    gc.collect()
    gc.freeze()
    gc.disable()
    ring.header[REAL_TIME] = _ask_for_real_time()
    pipe.send(Ready())
    loop.run()


def _ask_for_real_time() -> bool:
    """Ask for real-time scheduling and locked memory; both need privileges, and the loop does its best without."""
    if not sys.platform.startswith("linux"):
        return False
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
    except OSError:
        return False
    ctypes.CDLL(None).mlockall(MCL_CURRENT_AND_FUTURE)
    return True
