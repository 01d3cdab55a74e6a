"""Starting another process by the name of its entry, so that the web process never imports what that process needs."""

import ctypes
import importlib
import multiprocessing
import os
import sys
from contextlib import suppress
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any

CONTEXT = multiprocessing.get_context("spawn")
MCL_CURRENT_AND_FUTURE = 3
PRIORITY = 20
ONE_THREAD = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")


def started(name: str, entry: str, *arguments: Any) -> BaseProcess:
    """Start and return a daemon process that runs `entry`, written "package.module:function"."""
    process = CONTEXT.Process(target=_enter, args=(name, entry, *arguments), name=name, daemon=True)
    process.start()
    return process


def set_niceness(niceness: int) -> None:
    """Set this process's share of a busy processor, from -20 (most) to 19; more than the usual 0 needs privileges."""
    with suppress(OSError, AttributeError):
        os.setpriority(os.PRIO_PROCESS, 0, niceness)


def ask_for_real_time() -> bool:
    """Ask for real-time scheduling and locked memory, return whether granted; both need privileges."""
    if not sys.platform.startswith("linux"):
        return False
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
    except OSError:
        return False
    ctypes.CDLL(None).mlockall(MCL_CURRENT_AND_FUTURE)
    return True


def name_this_process(name: str) -> None:
    """Give this process the name that `top` shows, where the system can."""
    with suppress(OSError):
        Path("/proc/self/comm").write_text(name)


def _enter(name: str, entry: str, *arguments: Any) -> None:
    for variable in ONE_THREAD:  # threads of their own make 5x5 matrices wait for a busy core
        os.environ.setdefault(variable, "1")
    name_this_process(name)
    set_niceness(0)  # not what the web process may have
    module, function = entry.split(":")
    getattr(importlib.import_module(module), function)(*arguments)
