"""A run as it is planned: the numbers of its tuning, and of every change that its sequence will make. Imports no numba."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vssea_core.scenario import Scenario

Numbers = NDArray[np.float64]


@dataclass(frozen=True)
class Follower:
    """The scenario after the change `index` of the sequence, and the numbers of its tuning."""

    at_s: float
    index: int
    scenario: Scenario
    prepared: Numbers


@dataclass(frozen=True)
class PreparedRun:
    """What `prepare_run` makes of a scenario: the numbers of its tuning, and its followers in order of time."""

    prepared: Numbers
    followers: tuple[Follower, ...] = ()
