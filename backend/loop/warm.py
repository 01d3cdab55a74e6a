"""Compiling the kernels before they are needed: the very calls of a session, on no samples."""

import numpy as np

from backend.loop.engine import Engine
from backend.telemetry.ring import COLUMNS
from vssea_core.control.packing import GAINS, LAW
from vssea_core.scenarios import NOMINAL


def compile_kernels() -> None:
    """Compile, or load from the cache, everything that the loop calls."""
    engine = Engine(NOMINAL, np.ones(LAW + 3 * GAINS), 0)
    engine.set_reference(NOMINAL.reference)
    engine.advance(np.empty((0, COLUMNS)))
