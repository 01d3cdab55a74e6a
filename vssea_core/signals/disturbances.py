"""Disturbance torques over time, as rows of numbers for the kernel.

A term is active over whole sample periods: from the first tick at or after its start to the first at or after its end.
Its value still varies inside the period.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vssea_core.compiled import entry, inlined
from vssea_core.signals.documents import Disturbance

CONSTANT, SINE = 0.0, 1.0
TIME_SLACK_S = 1e-9  # tick times are k T in floating point


def disturbance_rows(terms: Sequence[Disturbance]) -> NDArray[np.float64]:
    """Return the terms as an array (n, 6): kind, amplitude [N m], angular frequency [rad/s], phase [rad], start, end [s]."""
    rows = np.zeros((len(terms), 6))
    for row, term in zip(rows, terms, strict=True):
        end = math.inf if term.end_s is None else term.end_s
        if term.kind == "constant":
            row[:] = CONSTANT, term.torque, 0.0, 0.0, term.start_s, end
        else:
            row[:] = SINE, term.amplitude, 2.0 * math.pi * term.frequency_hz, term.phase, term.start_s, end
    return rows


@inlined
def load(rows, tick_time, time):  # type: ignore[no-untyped-def]
    """Return the sum [N m] at `time` [s] of the terms that are active in the period starting at `tick_time`."""
    total = 0.0
    for i in range(rows.shape[0]):
        if rows[i, 4] <= tick_time + TIME_SLACK_S and tick_time + TIME_SLACK_S < rows[i, 5]:
            if rows[i, 0] == CONSTANT:
                total += rows[i, 1]
            else:
                total += rows[i, 1] * math.sin(rows[i, 2] * time + rows[i, 3])
    return total


@entry
def load_at(rows, time):  # type: ignore[no-untyped-def]
    """Return the torque [N m] of the terms at a tick at `time` [s]."""
    return load(rows, time, time)
