"""Disturbance torques over time, as rows of numbers for the kernel.

A term is active over whole sample periods: from the first tick at or after its start to the first at or after its end.
Its value still varies inside the period: the integrator asks for it at the six instants of its step.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vssea_core.compiled import entry, inlined
from vssea_core.signals.documents import Disturbance

CONSTANT, SINE = 0.0, 1.0
TIME_SLACK_S = 1e-9  # tick times are k T in floating point
INSTANTS = (0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0)
"""Instants of the integrator's step, as shares of its length (Dormand-Prince, order 5)."""
C2, C3, C4, C5, C6 = INSTANTS[1:]


def disturbance_rows(terms: Sequence[Disturbance], sample_time_s: float) -> NDArray[np.float64]:
    """Return the terms as an array (n, 16).

    Columns: kind, amplitude [N m], angular frequency [rad/s], phase [rad], start, end [s], then cosine and sine of the
    angle that passes from a tick to each of the five later instants of a whole period.
    """
    rows = np.zeros((len(terms), 16))
    for row, term in zip(rows, terms, strict=True):
        end = math.inf if term.end_s is None else term.end_s
        if term.kind == "constant":
            row[:6] = CONSTANT, term.torque, 0.0, 0.0, term.start_s, end
        else:
            frequency = 2.0 * math.pi * term.frequency_hz
            row[:6] = SINE, term.amplitude, frequency, term.phase, term.start_s, end
            angles = frequency * sample_time_s * np.array(INSTANTS[1:])
            row[6:11], row[11:16] = np.cos(angles), np.sin(angles)
    return rows


@inlined
def active(rows, i, tick_time):
    """Return whether term `i` acts over the period that starts at `tick_time` [s]."""
    return rows[i, 4] <= tick_time + TIME_SLACK_S and tick_time + TIME_SLACK_S < rows[i, 5]


@inlined
def load(rows, tick_time, time):
    """Return the sum [N m] at `time` [s] of the terms that are active in the period starting at `tick_time`."""
    total = 0.0
    for i in range(rows.shape[0]):
        if active(rows, i, tick_time):
            if rows[i, 0] == CONSTANT:
                total += rows[i, 1]
            else:
                total += rows[i, 1] * math.sin(rows[i, 2] * time + rows[i, 3])
    return total


@inlined
def loads_of_step(rows, tick_time, time, h, whole):
    """Return the torques [N m] at the six instants of a step of `h` [s] from `time`, in the period starting at `tick_time`.

    If the step is the `whole` period, the angles of a sine are turned by precomputed ones, which saves four sines.
    """
    a = b = c = d = e = f = 0.0
    for i in range(rows.shape[0]):
        if active(rows, i, tick_time):
            size = rows[i, 1]
            angle = rows[i, 2] * time + rows[i, 3]
            if rows[i, 0] == CONSTANT:
                a, b, c, d, e, f = a + size, b + size, c + size, d + size, e + size, f + size
            elif whole:
                sine, cosine = size * math.sin(angle), size * math.cos(angle)
                a += sine
                b += sine * rows[i, 6] + cosine * rows[i, 11]
                c += sine * rows[i, 7] + cosine * rows[i, 12]
                d += sine * rows[i, 8] + cosine * rows[i, 13]
                e += sine * rows[i, 9] + cosine * rows[i, 14]
                f += sine * rows[i, 10] + cosine * rows[i, 15]
            else:
                turn = rows[i, 2] * h
                a += size * math.sin(angle)
                b += size * math.sin(angle + C2 * turn)
                c += size * math.sin(angle + C3 * turn)
                d += size * math.sin(angle + C4 * turn)
                e += size * math.sin(angle + C5 * turn)
                f += size * math.sin(angle + C6 * turn)
    return a, b, c, d, e, f


@entry
def load_at(rows, time):
    """Return the torque [N m] of the terms at a tick at `time` [s]."""
    return load(rows, time, time)
