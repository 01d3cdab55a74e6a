"""Margins from the sensitivity S alone, for both breaks of the loop in one pass.

With L = 1/S - 1 the Nyquist plot needs no open loop, whose poles on the unit circle would spoil it:
L is real where S is, and the gain that closes the loop on its border there is S / (S - 1); |L| = 1 where Re S = 1/2; and the
balanced disk margin is 1 / max |S - 1/2|.
"""

import math

import numpy as np

from vssea_core.analysis.frequency_response import frequency_grid, hessenberg_form, respond
from vssea_core.compiled import entry, inlined

(
    GAIN_UP, GAIN_UP_AT, GAIN_DOWN, GAIN_DOWN_AT, PHASE, PHASE_AT, DELAY, DELAY_AT, DISK, DISK_AT, PEAK, PEAK_AT, FIELDS,
) = range(13)  # fmt: skip
"""Columns of the result: gains as factors, phase [rad], delay [s], disk margin alpha, peak of |S|, each with its w [rad/s]."""
VANISHING = 1e-4
"""|S| below this counts as zero: towards standstill it is rounding, and no drive loses all but a ten-thousandth of its gain."""
STEPS = 60
"""Most steps of a refinement; it ends at 1e-9 of the frequency."""
CLOSE = 1e-9
GOLDEN = 0.3819660112501051


@entry
def sensitivity(H, b, c, D, w, period_s, delayed, place, upper, solution, response):
    """Return S at `w` [rad/s]: for place 0 at the plant's input, for 1 at the limiter."""
    angle = w * period_s
    z = complex(math.cos(angle), math.sin(angle))
    respond(H, b, c, D, z, upper, solution, response)
    gain = response[0, place]
    if place == 0 and delayed:
        gain = gain * z.conjugate()
    return 1.0 + gain


@inlined
def offset(s, real):
    """Return what vanishes at a crossing: Re S - 1/2 with `real` 1, else Im S."""
    return s.real - 0.5 if real != 0 else s.imag


@entry
def crossing(H, b, c, D, low, high, period_s, delayed, place, real, upper, solution, response):
    """Return where Im S (or, with `real` 1, Re S - 1/2) changes sign between `low` and `high` [rad/s]: Illinois, then bisection."""
    a, d = low, high
    s = sensitivity(H, b, c, D, a, period_s, delayed, place, upper, solution, response)
    fa = offset(s, real)
    s = sensitivity(H, b, c, D, d, period_s, delayed, place, upper, solution, response)
    fd = offset(s, real)
    side = 0
    for step in range(STEPS):
        if d - a < CLOSE * d:
            break
        middle = (a * fd - d * fa) / (fd - fa) if step % 4 != 3 else 0.5 * (a + d)
        if not a < middle < d:
            middle = 0.5 * (a + d)
        s = sensitivity(H, b, c, D, middle, period_s, delayed, place, upper, solution, response)
        f = offset(s, real)
        if f == 0.0:
            return middle
        if (f > 0.0) == (fd > 0.0):
            d, fd = middle, f
            if side == 1:
                fa *= 0.5
            side = 1
        else:
            a, fa = middle, f
            if side == -1:
                fd *= 0.5
            side = -1
    return 0.5 * (a + d)


@entry
def dip(H, b, c, D, grid, i, f0, f1, f2, period_s, delayed, place, real, upper, solution, response):
    """Return a frequency next to grid point `i` where Im S (or Re S - 1/2) has the other sign than at three points, or NaN.

    f0, f1, f2 are its values at i - 1, i, i + 1, all of one sign, the middle one nearest to zero: two crossings may hide
    between the points. The parabola through them tells whether to look closer.
    """
    low, high = grid[i - 1], grid[i + 1]
    x0, x1, x2 = math.log(low), math.log(grid[i]), math.log(high)
    slope0, slope1 = (f1 - f0) / (x1 - x0), (f2 - f1) / (x2 - x1)
    curve = (slope1 - slope0) / (x2 - x0)
    if curve == 0.0:
        return np.nan
    vertex = 0.5 * (x0 + x1) - 0.5 * slope0 / curve
    bottom = f0 + slope0 * (vertex - x0) + curve * (vertex - x0) * (vertex - x1)
    if bottom * f1 > SHALLOW * f1 * f1:
        return np.nan
    sign = math.copysign(1.0, f1)
    a, d = low, high
    x, y = a + GOLDEN * (d - a), d - GOLDEN * (d - a)
    fx = sign * offset(sensitivity(H, b, c, D, x, period_s, delayed, place, upper, solution, response), real)
    fy = sign * offset(sensitivity(H, b, c, D, y, period_s, delayed, place, upper, solution, response), real)
    for _ in range(STEPS // 2):
        if fx < 0.0:
            return x
        if fy < 0.0:
            return y
        if fx < fy:
            d, y, fy = y, x, fx
            x = a + GOLDEN * (d - a)
            fx = sign * offset(sensitivity(H, b, c, D, x, period_s, delayed, place, upper, solution, response), real)
        else:
            a, x, fx = x, y, fy
            y = d - GOLDEN * (d - a)
            fy = sign * offset(sensitivity(H, b, c, D, y, period_s, delayed, place, upper, solution, response), real)
    return np.nan


@entry
def crossings(H, b, c, D, grid, values, period_s, delayed, place, real, upper, solution, response):
    """Return the frequencies, ascending, at which Im S (or, with `real` 1, Re S - 1/2) changes sign.

    At Nyquist S is real, so Im S is rounding at the last point of `grid`.
    """
    last = len(grid) - 1 if real != 0 else len(grid) - 2
    found = np.empty(2 * len(grid))
    count = 0
    for i in range(last):
        f, g = offset(values[place, i], real), offset(values[place, i + 1], real)
        if f * g < 0.0:
            found[count] = crossing(
                H, b, c, D, grid[i], grid[i + 1], period_s, delayed, place, real, upper, solution, response
            )
            count += 1
        elif i > 0:
            e = offset(values[place, i - 1], real)
            if e * f > 0.0 and f * g > 0.0 and abs(f) <= abs(e) and abs(f) <= abs(g):
                w = dip(H, b, c, D, grid, i, e, f, g, period_s, delayed, place, real, upper, solution, response)
                if not math.isnan(w):
                    found[count] = crossing(
                        H, b, c, D, grid[i - 1], w, period_s, delayed, place, real, upper, solution, response
                    )
                    found[count + 1] = crossing(
                        H, b, c, D, w, grid[i + 1], period_s, delayed, place, real, upper, solution, response
                    )
                    count += 2
    return found[:count]


SHALLOW = 0.5
"""Share of the nearest value above which a dip between grid points is not looked at."""


@entry
def summit(H, b, c, D, low, high, period_s, delayed, place, centre, upper, solution, response):
    """Return w and the largest |S - centre| between `low` and `high` [rad/s], by golden section."""
    a, d = low, high
    x = a + GOLDEN * (d - a)
    y = d - GOLDEN * (d - a)
    fx = abs(sensitivity(H, b, c, D, x, period_s, delayed, place, upper, solution, response) - centre)
    fy = abs(sensitivity(H, b, c, D, y, period_s, delayed, place, upper, solution, response) - centre)
    for _ in range(STEPS):
        if d - a < 1e-7 * d:  # the value is then within 1e-12
            break
        if fx > fy:
            d, y, fy = y, x, fx
            x = a + GOLDEN * (d - a)
            fx = abs(sensitivity(H, b, c, D, x, period_s, delayed, place, upper, solution, response) - centre)
        else:
            a, x, fx = x, y, fy
            y = d - GOLDEN * (d - a)
            fy = abs(sensitivity(H, b, c, D, y, period_s, delayed, place, upper, solution, response) - centre)
    return (x, fx) if fx > fy else (y, fy)


@entry
def real_axis(result, place, s, w):
    """Note what a sensitivity on the real axis means: a gain above one for S > 1, below one for S < 0."""
    if s > 1.0 + VANISHING:
        gain = s / (s - 1.0)
        if gain < result[place, GAIN_UP]:
            result[place, GAIN_UP], result[place, GAIN_UP_AT] = gain, w
    elif s < -VANISHING:
        gain = s / (s - 1.0)
        if gain > result[place, GAIN_DOWN]:
            result[place, GAIN_DOWN], result[place, GAIN_DOWN_AT] = gain, w


@entry
def margins_of(A, B, C, D, multipliers, period_s, delayed, per_decade, crossovers):
    """Return margins (2, FIELDS) of a stable closed loop at plant input and limiter; none is infinite (gain down: zero).

    B has the inputs of both breaks, C the row of the torque. `multipliers` are the eigenvalues of A. The first crossover
    frequencies of each break, as many as fit, are written to `crossovers` (2, m), the rest NaN.
    """
    H, b, c = hessenberg_form(A, B[:, :2].copy(), C[:1].copy())
    D = D[:1, :2].copy()
    n = A.shape[0]
    upper, solution = np.empty((n, n), np.complex128), np.empty((1, n), np.complex128)
    response = np.empty((1, 2), np.complex128)
    grid = frequency_grid(multipliers, period_s, per_decade)
    count = len(grid)
    values = np.empty((2, count), np.complex128)
    for i in range(count):
        angle = grid[i] * period_s
        z = complex(math.cos(angle), math.sin(angle))
        respond(H, b, c, D, z, upper, solution, response)
        values[0, i] = 1.0 + (response[0, 0] * z.conjugate() if delayed else response[0, 0])
        values[1, i] = 1.0 + response[0, 1]
    result = np.zeros((2, FIELDS))
    crossovers[:] = np.nan
    for place in range(2):
        result[place, GAIN_UP] = result[place, PHASE] = result[place, DELAY] = np.inf
        result[place, GAIN_UP_AT] = result[place, GAIN_DOWN_AT] = np.nan
        result[place, PHASE_AT] = result[place, DELAY_AT] = np.nan
        still = sensitivity(H, b, c, D, 0.0, period_s, delayed, place, upper, solution, response)
        real_axis(result, place, still.real, 0.0)
        real_axis(result, place, values[place, count - 1].real, grid[count - 1])
        for real in range(2):
            found = crossings(H, b, c, D, grid, values, period_s, delayed, place, real, upper, solution, response)
            for i in range(len(found)):
                w = found[i]
                at = sensitivity(H, b, c, D, w, period_s, delayed, place, upper, solution, response)
                if real == 0:
                    real_axis(result, place, at.real, w)
                    continue
                L = 1.0 / at - 1.0
                lag = math.atan2(-L.imag, -L.real)  # L exp(-j lag) = -1
                if abs(lag) < result[place, PHASE]:
                    result[place, PHASE], result[place, PHASE_AT] = abs(lag), w
                late = (lag if lag > 0.0 else lag + 2.0 * math.pi) / w
                if late < result[place, DELAY]:
                    result[place, DELAY], result[place, DELAY_AT] = late, w
                if i < crossovers.shape[1]:
                    crossovers[place, i] = w
        for kind in range(2):
            centre, at_field = (0.5, DISK) if kind == 0 else (0.0, PEAK)
            best, where = abs(still - centre), 0.0
            top = 0.0
            for i in range(count):
                top = max(top, abs(values[place, i] - centre))
            for i in range(count):
                here = abs(values[place, i] - centre)
                before = abs(values[place, i - 1] - centre) if i > 0 else 0.0
                behind = abs(values[place, i + 1] - centre) if i < count - 1 else 0.0
                if here < before or here < behind or here < 0.9 * top:
                    continue
                w, height = grid[i], here
                if 0 < i < count - 1:
                    w, height = summit(
                        H, b, c, D, grid[i - 1], grid[i + 1], period_s, delayed, place, centre, upper, solution, response
                    )  # fmt: skip
                if max(height, here) > best:
                    best, where = max(height, here), w
            result[place, at_field] = 1.0 / best if kind == 0 else best
            result[place, at_field + 1] = where
    return result
