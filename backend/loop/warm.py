"""Compiling the kernels before they are needed: the very calls of a session, on one sample."""

import numpy as np

from backend.telemetry.ring import COLUMNS
from vssea_core.control.packing import ROW, ROWS_AT
from vssea_core.scenarios import NOMINAL
from vssea_core.simulation.closed_loop import ClosedLoop
from vssea_core.simulation.plan import PreparedRun


def compile_kernels() -> None:
    """Compile, or load from the cache, everything that the loop calls."""
    numbers = np.ones(ROWS_AT + ROW)
    loop = ClosedLoop(NOMINAL, PreparedRun(numbers), 0)
    loop.set_reference(NOMINAL.reference)
    loop.advance(np.empty((1, COLUMNS)))
