"""What real-time loops want of an operating system: kernels compiled before, no garbage collection, priority, locked memory."""

import ctypes
import gc
import os
import sys

MCL_CURRENT_AND_FUTURE = 3
PRIORITY = 20


def compile_first() -> None:
    """Compile the kernels of a loop, or load them; who comes second finds the machine code ready."""
    from filelock import FileLock

    from vssea_core.compiled import cache_folder

    folder = cache_folder()
    folder.mkdir(parents=True, exist_ok=True)
    with FileLock(folder / "compiling.lock"):
        from backend.loop.warm import compile_kernels

        compile_kernels()


def settle_down() -> bool:
    """Switch garbage collection off and ask for real time; return whether it was granted."""
    gc.collect()
    gc.freeze()
    gc.disable()
    return _ask_for_real_time()


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
