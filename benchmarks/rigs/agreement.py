"""The same scenario on the emulated rig and in simulation, and stiffness 50 -> 800 -> 50 N m/rad while tracking.

The rig's run is read from its own recording; the simulation is of the scenario embedded there.
"""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from backend.recordings.reader import Recording
from benchmarks.live_server import Server
from benchmarks.rigs.activities import SINE
from benchmarks.rigs.emulated import armed, emulated_rig
from benchmarks.rigs.operator import Operator
from vssea_core.channels import INDEX
from vssea_core.scenario import Scenario
from vssea_core.simulation.run import simulate

TRACKED_S = 12.0
SETTLED_S = 4.0


@contextmanager
def operating(rate_hz: int = 500) -> Iterator[tuple[Server, Operator]]:
    """Give an armed rig and its operator."""
    with emulated_rig(rate_hz) as (server, _), Operator(server.port) as operator:
        armed(operator)
        yield server, operator
