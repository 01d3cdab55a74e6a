"""A 1 kHz loop that does nothing: what this machine gives to any program, for comparison."""

import contextlib
import ctypes
import os
import time

import numpy as np

PERIOD_S = 1e-3


def lateness_us(duration_s: float) -> np.ndarray:
    """Return how late [us] each wake-up of an idle loop was; real-time scheduling is asked for, as the product does."""
    with contextlib.suppress(OSError):
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(20))
        ctypes.CDLL(None).mlockall(3)
    late = np.zeros(round(duration_s / PERIOD_S))
    due = time.monotonic()
    for turn in range(len(late)):
        due += PERIOD_S
        time.sleep(max(0.0, due - time.monotonic()))
        late[turn] = time.monotonic() - due
        due += int(late[turn] / PERIOD_S) * PERIOD_S
    return late * 1e6
