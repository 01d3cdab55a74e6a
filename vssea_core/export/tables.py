"""What a scenario's controller consists of, taken apart from the flat array of the tick."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vssea_core.control.law import GAINS, Law
from vssea_core.control.packing import OBSERVER, ROW, ROWS_AT, STIFFNESS_AT, TABLE_AT, law_of
from vssea_core.control.prepared import prepare
from vssea_core.scenario import Scenario

Numbers = NDArray[np.float64]
VELOCITY_NUMBERS = slice(0, 18)
"""A by rows, h, b0, b1 of the velocity form among ObserverGains."""
POSITION_NUMBERS = slice(18, 35)
"""What is not fixed in A, B0, B1, then M, of the position form among ObserverGains."""


class Tables(NamedTuple):
    """The numbers of one controller; n rows over the stiffness, 1 where no gain follows it."""

    prepared: Numbers  # the flat array itself
    law: Law
    stiffnesses: Numbers  # (n,) [N m/rad], evenly spaced in ln k
    first_ln_k: float
    rows_per_ln_k: float
    gains: Numbers  # (n, GAINS)
    link: Numbers  # (n, OBSERVER)
    motor: Numbers  # (n, OBSERVER)
    stiffness: Numbers  # (OBSERVER,)
    predicts: bool  # the law acts on the state one sample ahead


def tables_of(scenario: Scenario) -> Tables:
    """Return the numbers of the scenario's tuning, as a run of it uses them.

    Raises ValueError if a design has no solution.
    """
    mechanism = scenario.actuator.stiffness
    prepared = prepare(scenario.tuning, scenario.timing.sample_time_s, (mechanism.softest, mechanism.stiffest))
    count, first, per_ln_k = prepared[TABLE_AT:ROWS_AT].tolist()
    rows = prepared[ROWS_AT:].reshape(int(count), ROW)
    stiffnesses = np.array([scenario.tuning.schedule.reference_stiffness])
    if count > 1.0:
        stiffnesses = np.exp(first + np.arange(count) / per_ln_k)
    return Tables(
        prepared,
        law_of(prepared),
        stiffnesses,
        first,
        per_ln_k,
        rows[:, :GAINS],
        rows[:, GAINS : GAINS + OBSERVER],
        rows[:, GAINS + OBSERVER :],
        prepared[STIFFNESS_AT:TABLE_AT],
        scenario.tuning.observer.predict and scenario.timing.compute_delay_samples > 0,
    )
