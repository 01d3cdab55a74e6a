"""A recorded course as a spline of degree 5: four continuous derivatives, through every sample, at rest at both ends.

C. de Boor, "A Practical Guide to Splines", 1978, ch. IX-XIII. Rest at an end means five equal coefficients there; the knots
that this needs lie in the first and the last interval.
"""

import numpy as np
from numpy.typing import NDArray

from vssea_core.compiled import inlined
from vssea_core.control.law import Target
from vssea_core.signals.documents import RecordedReference

Numbers = NDArray[np.float64]
DEGREE = 5
PIECES_AT = 8  # of a row: here the pieces begin, first where each starts, then six coefficients of each


def recorded_row(reference: RecordedReference) -> list[float]:
    """Return the numbers of a recorded reference behind its kind, without when it was set."""
    times, positions = np.array(reference.times_s), np.array(reference.positions)
    starts, coefficients = spline_pieces(times, positions)
    head = [float(len(starts)), times[0], times[-1], positions[0], positions[-1], 0.0, 0.0]
    return [*head, *starts.tolist(), *coefficients.ravel().tolist()]


def spline_pieces(times: Numbers, positions: Numbers) -> tuple[Numbers, Numbers]:
    """Return where each piece starts (m,) [s], and its coefficients (m, 6) of the powers of the time since then."""
    n = len(times)
    knots = _knots(times)
    c = np.concatenate([np.full(5, positions[0]), np.zeros(n - 2), np.full(5, positions[-1])])
    if n > 2:
        inner = np.arange(1, n - 1)
        basis = _basis(knots, inner + 7, times[1:-1], DEGREE)[:, :5]
        columns = inner[:, None] + np.arange(2, 7)
        known = (columns < 5) | (columns > n + 2)
        right = positions[1:-1] - np.sum(np.where(known, basis * c[columns], 0.0), axis=1)
        c[5 : n + 3] = _solve_five_diagonals(np.where(known, 0.0, basis), right)
    spans = np.arange(DEGREE, len(knots) - DEGREE - 1)
    starts, pieces, factorial = knots[spans], np.empty((len(spans), 6)), 1.0
    for order in range(6):
        degree = DEGREE - order
        nearby = spans[:, None] + np.arange(-degree, 1)
        pieces[:, order] = np.sum(_basis(knots, spans, starts, degree) * c[nearby], axis=1) / factorial
        factorial *= order + 1.0
        if degree > 0:
            widths = np.zeros(len(c))
            widths[1:] = knots[1 + degree : len(c) + degree] - knots[1 : len(c)]
            steps = np.diff(c, prepend=c[:1])
            c = degree * np.divide(steps, widths, out=np.zeros(len(c)), where=widths > 0.0)
    return starts, pieces


def _knots(times: Numbers) -> Numbers:
    first, last = times[0], times[-1]
    if len(times) == 2:
        inner = np.linspace(first, last, 6)[1:-1]
    else:
        thirds = np.array([1.0, 2.0]) / 3.0
        begin, end = first + thirds * (times[1] - first), times[-2] + thirds * (last - times[-2])
        inner = np.concatenate([begin, times[1:-1], end])
    return np.concatenate([np.full(6, first), inner, np.full(6, last)])


def _basis(knots: Numbers, spans: NDArray[np.int_], at: Numbers, degree: int) -> Numbers:
    """Return the B-splines (n, degree + 1) that are not zero at points `at` (n,) in the intervals `spans` (n,)."""
    values = np.ones((len(at), 1))
    for p in range(1, degree + 1):
        raised = np.zeros((len(at), p + 1))
        for i in range(p):
            left, right = knots[spans + i - p + 1], knots[spans + i + 1]
            share = values[:, i] / (right - left)
            raised[:, i] += (right - at) * share
            raised[:, i + 1] += (at - left) * share
        values = raised
    return values


def _solve_five_diagonals(bands: Numbers, right: Numbers) -> Numbers:
    """Return x of A x = right; bands[i] holds A[i, i-2 .. i+2]. Without pivoting: A is totally positive."""
    a, y = bands.tolist(), right.tolist()
    n = len(y)
    for i in range(n):
        pivot = a[i]
        for below in range(i + 1, min(i + 3, n)):
            row, shift = a[below], below - i
            share = row[2 - shift] / pivot[2]
            row[3 - shift] -= share * pivot[3]
            row[4 - shift] -= share * pivot[4]
            y[below] -= share * y[i]
    for i in range(n - 1, -1, -1):
        row = a[i]
        for ahead in (1, 2):
            if i + ahead < n:
                y[i] -= row[2 + ahead] * y[i + ahead]
        y[i] /= row[2]
    return np.array(y)


@inlined
def recorded(row, time):
    """Return the spline of a recorded reference and four derivatives; at rest before the first and after the last sample."""
    if time <= row[2]:
        return Target(row[4], 0.0, 0.0, 0.0, 0.0)
    if time >= row[3]:
        return Target(row[5], 0.0, 0.0, 0.0, 0.0)
    count = int(row[1])
    low, high = 0, count
    while high - low > 1:
        middle = (low + high) // 2
        if row[PIECES_AT + middle] <= time:
            low = middle
        else:
            high = middle
    x = time - row[PIECES_AT + low]
    at = PIECES_AT + count + 6 * low
    a, b, c, d, e, f = row[at], row[at + 1], row[at + 2], row[at + 3], row[at + 4], row[at + 5]
    return Target(
        a + x * (b + x * (c + x * (d + x * (e + x * f)))),
        b + x * (2.0 * c + x * (3.0 * d + x * (4.0 * e + 5.0 * x * f))),
        2.0 * c + x * (6.0 * d + x * (12.0 * e + 20.0 * x * f)),
        6.0 * d + x * (24.0 * e + 60.0 * x * f),
        24.0 * e + 120.0 * x * f,
    )
