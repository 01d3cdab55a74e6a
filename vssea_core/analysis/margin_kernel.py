"""Margins from the sensitivity S alone, for both breaks of the loop in one pass.

With L = 1/S - 1 the Nyquist plot needs no open loop, whose poles on the unit circle would spoil it:
L is real where S is, and the gain that closes the loop on its border there is S / (S - 1); |L| = 1 where Re S = 1/2; and the
balanced disk margin is 1 / max |S - 1/2|.
"""

import math

import numpy as np

from vssea_core.analysis.frequency_response import frequency_grid, hessenberg_form, respond
from vssea_core.compiled import entry

(
    GAIN_UP, GAIN_UP_AT, GAIN_DOWN, GAIN_DOWN_AT, PHASE, PHASE_AT, DELAY, DELAY_AT, DISK, DISK_AT, PEAK, PEAK_AT, FIELDS,
) = range(13)  # fmt: skip
"""Columns of the result: gains as factors, phase [rad], delay [s], disk margin alpha, peak of |S|, each with its w [rad/s]."""
VANISHING = 1e-9
"""|S| below this is rounding: a loop gain that large has no lower margin worth telling."""
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


@entry
def crossing(H, b, c, D, low, high, period_s, delayed, place, real, upper, solution, response):
    """Return where Im S (or, with `real`, Re S - 1/2) changes sign between `low` and `high` [rad/s]: Illinois, then bisection."""
    a, d = low, high
    s = sensitivity(H, b, c, D, a, period_s, delayed, place, upper, solution, response)
    fa = s.real - 0.5 if real else s.imag
    s = sensitivity(H, b, c, D, d, period_s, delayed, place, upper, solution, response)
    fd = s.real - 0.5 if real else s.imag
    side = 0
    for step in range(STEPS):
        if d - a < CLOSE * d:
            break
        middle = (a * fd - d * fa) / (fd - fa) if step % 4 != 3 else 0.5 * (a + d)
        if not a < middle < d:
            middle = 0.5 * (a + d)
        s = sensitivity(H, b, c, D, middle, period_s, delayed, place, upper, solution, response)
        f = s.real - 0.5 if real else s.imag
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
        crossed = 0
        for i in range(count - 1):
            s, t = values[place, i], values[place, i + 1]
            # On the way to Nyquist both ends are real; the last interval's own end is rounding.
            if i < count - 2 and s.imag * t.imag < 0.0 and (abs(s) > VANISHING or abs(t) > VANISHING):
                w = crossing(
                    H, b, c, D, grid[i], grid[i + 1], period_s, delayed, place, False, upper, solution, response
                )
                at = sensitivity(H, b, c, D, w, period_s, delayed, place, upper, solution, response)
                real_axis(result, place, at.real, w)
            if (s.real - 0.5) * (t.real - 0.5) < 0.0:
                w = crossing(
                    H, b, c, D, grid[i], grid[i + 1], period_s, delayed, place, True, upper, solution, response
                )
                at = sensitivity(H, b, c, D, w, period_s, delayed, place, upper, solution, response)
                L = 1.0 / at - 1.0
                lag = math.atan2(-L.imag, -L.real)  # L exp(-j lag) = -1
                if abs(lag) < result[place, PHASE]:
                    result[place, PHASE], result[place, PHASE_AT] = abs(lag), w
                late = (lag if lag > 0.0 else lag + 2.0 * math.pi) / w
                if late < result[place, DELAY]:
                    result[place, DELAY], result[place, DELAY_AT] = late, w
                if crossed < crossovers.shape[1]:
                    crossovers[place, crossed] = w
                    crossed += 1
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
