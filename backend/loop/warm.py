"""Compiling the kernels before they are needed: the very calls of a session, on one sample."""

import numpy as np
from numpy.typing import NDArray

from backend.telemetry.ring import COLUMNS
from vssea_core.control.packing import ROW, ROWS_AT
from vssea_core.scenarios import NOMINAL, REALISTIC
from vssea_core.simulation.closed_loop import ClosedLoop
from vssea_core.simulation.plan import PreparedRun
from vssea_core.tick.controller import CLOSED, Controller, RigLimits


def compile_kernels() -> None:
    """Compile, or load from the cache, everything that the loop calls."""
    numbers = np.ones(ROWS_AT + ROW)
    loop = ClosedLoop(NOMINAL, PreparedRun(numbers), 0)
    loop.set_reference(NOMINAL.reference)
    loop.advance(np.empty((1, COLUMNS)))
    compile_rig_kernels(numbers)


def compile_rig_kernels(numbers: NDArray[np.float64]) -> None:
    """Compile, or load from the cache, what a controller on a rig calls."""
    wide = RigLimits(1.0, 1.0, 1.0, 1.0, 1.0, -1.0, 1.0, 1.0, 1.0, 30.0, 120.0)
    controller = Controller(REALISTIC, numbers, wide, 0)
    controller.begin(0.0, 0.0, 60.0)
    controller.hold()
    controller.reference_now()
    row = np.empty((1, COLUMNS))[0]
    controller.tick(0.0, 0.0, 60.0, 0.0, 0.0, CLOSED, 1.0, row)
    controller.missed(row, CLOSED, 1.0)
