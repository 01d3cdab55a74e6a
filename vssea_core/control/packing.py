"""The tick's parameters and memory as flat arrays: what is swapped, kept and shared are plain numbers.

Gains that follow the stiffness stand in a table of rows, evenly spaced in log k; the tick interpolates between them.
"""

import math
from typing import NamedTuple

import numpy as np
from numba.np.unsafe.ndarray import to_fixed_tuple
from numpy.typing import NDArray

from vssea_core.compiled import inlined
from vssea_core.control.law import GAINS, Law
from vssea_core.control.observer import Channel, Memory, ObserverGains, Spring

OBSERVER, CHANNEL, SPRING = len(ObserverGains._fields), len(Channel._fields), len(Spring._fields)
FIXED = len(Law._fields) - GAINS  # what of the law does not follow the stiffness
SPRING_CONSTANT_AT = Law._fields.index("spring_constant") - GAINS
STIFFNESS_AT = FIXED
TABLE_AT = STIFFNESS_AT + OBSERVER  # number of rows, log of the lowest stiffness, rows a unit of log k
ROWS_AT = TABLE_AT + 3
ROW = GAINS + 2 * OBSERVER
TWISTING_AT = 3 * CHANNEL + SPRING
MEMORY_SIZE = TWISTING_AT + 1


class Prepared(NamedTuple):
    """A tuning as the tick takes it."""

    law: Law
    link: ObserverGains
    motor: ObserverGains
    stiffness: ObserverGains


def law_of(values: NDArray[np.float64]) -> Law:
    """Return the Law of an array made by `prepare`, with the gains of its first row, for reading."""
    return Law(*values[ROWS_AT : ROWS_AT + GAINS], *values[:FIXED])


@inlined
def is_scheduled(values):
    """Return whether an array made by `prepare` holds gains that follow the stiffness."""
    return values[TABLE_AT] > 1.0


@inlined
def take_row(values, theta_ms, row):
    """Write into `row` (ROW) the gains at a stiffness motor position [rad]: through the four nearest rows of the table.

    Outside the table its ends hold.
    """
    rows = int(values[TABLE_AT])
    if rows == 1:
        row[:] = values[ROWS_AT : ROWS_AT + ROW]
        return
    spring_constant = values[SPRING_CONSTANT_AT]
    place = (math.log(0.5 * spring_constant / (theta_ms * theta_ms * theta_ms)) - values[TABLE_AT + 1]) * values[
        TABLE_AT + 2
    ]
    place = min(max(place, 0.0), rows - 1.0)
    first = min(max(int(place) - 1, 0), rows - 4)
    x = place - first
    w0 = -(x - 1.0) * (x - 2.0) * (x - 3.0) / 6.0
    w1 = x * (x - 2.0) * (x - 3.0) / 2.0
    w2 = -x * (x - 1.0) * (x - 3.0) / 2.0
    w3 = x * (x - 1.0) * (x - 2.0) / 6.0
    at = ROWS_AT + first * ROW
    for i in range(ROW):
        row[i] = (
            w0 * values[at + i]
            + w1 * values[at + ROW + i]
            + w2 * values[at + 2 * ROW + i]
            + w3 * values[at + 3 * ROW + i]
        )


@inlined
def loaded_prepared(values, row):
    """Return the Prepared of an array made by `prepare`, with the gains of `row` (see take_row)."""
    return Prepared(
        Law(*(to_fixed_tuple(row[:GAINS], GAINS) + to_fixed_tuple(values[:FIXED], FIXED))),
        ObserverGains(*to_fixed_tuple(row[GAINS : GAINS + OBSERVER], OBSERVER)),
        ObserverGains(*to_fixed_tuple(row[GAINS + OBSERVER : ROW], OBSERVER)),
        ObserverGains(*to_fixed_tuple(values[STIFFNESS_AT:TABLE_AT], OBSERVER)),
    )


@inlined
def loaded_memory(values):
    """Return the Memory kept in an array of MEMORY_SIZE numbers; all zeros is a controller that has not started."""
    return Memory(
        Channel(*to_fixed_tuple(values[:CHANNEL], CHANNEL)),
        Channel(*to_fixed_tuple(values[CHANNEL : 2 * CHANNEL], CHANNEL)),
        Channel(*to_fixed_tuple(values[2 * CHANNEL : 3 * CHANNEL], CHANNEL)),
        Spring(*to_fixed_tuple(values[3 * CHANNEL : TWISTING_AT], SPRING)),
        values[TWISTING_AT],
    )


@inlined
def keep_memory(values, memory):
    """Write `memory` into an array of MEMORY_SIZE numbers."""
    for i in range(CHANNEL):
        values[i] = memory.link[i]
        values[CHANNEL + i] = memory.motor[i]
        values[2 * CHANNEL + i] = memory.stiffness[i]
    for i in range(SPRING):
        values[3 * CHANNEL + i] = memory.spring[i]
    values[TWISTING_AT] = memory.twisting
