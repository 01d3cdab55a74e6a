"""Frequency response of a sampled system: reduced once to Hessenberg form, then some n^2 operations a frequency.

The transposed system is solved, so one solution for an output serves all its inputs. Balanced first, since states of a loop
lie ten decades apart.
"""

import math

import numpy as np

from vssea_core.compiled import entry

LOWEST_FREQUENCY = 0.01  # rad/s
BALANCED = 0.95  # stop where a rescaling gains less than this


@entry
def balancing(A):
    """Return powers of two (n,), s, for which diag(1/s) A diag(s) has rows and columns of about equal size."""
    n = A.shape[0]
    scale = np.ones(n)
    changing = True
    while changing:
        changing = False
        for i in range(n):
            column = row = 0.0
            for j in range(n):
                if j != i:
                    column += abs(A[j, i]) * scale[i] / scale[j]
                    row += abs(A[i, j]) * scale[j] / scale[i]
            if column == 0.0 or row == 0.0 or not math.isfinite(column + row):
                continue
            factor = 2.0 ** round(0.5 * math.log2(row / column))
            if column * factor + row / factor < BALANCED * (column + row):
                scale[i] *= factor
                changing = True
    return scale


@entry
def hessenberg_form(A, B, C):
    """Return H (n, n), b (inputs, n), c (outputs, n) with C (zI - A)^-1 B = [b (zI - H)^-1 c^T]^T, H upper Hessenberg."""
    n = A.shape[0]
    scale = balancing(A)
    H, b, c = np.empty((n, n)), np.empty((B.shape[1], n)), np.empty((C.shape[0], n))
    for i in range(n):
        for j in range(n):
            H[j, i] = A[i, j] * scale[j] / scale[i]
        for j in range(B.shape[1]):
            b[j, i] = B[i, j] / scale[i]
        for j in range(C.shape[0]):
            c[j, i] = C[j, i] * scale[i]
    v = np.empty(n)
    for k in range(n - 2):
        size = 0.0
        for i in range(k + 1, n):
            size += H[i, k] * H[i, k]
        size = math.sqrt(size)
        if size == 0.0:
            continue
        for i in range(k + 1, n):
            v[i] = H[i, k]
        v[k + 1] += math.copysign(size, v[k + 1])
        square = 0.0
        for i in range(k + 1, n):
            square += v[i] * v[i]
        twice = 2.0 / square
        for j in range(n):
            total = 0.0
            for i in range(k + 1, n):
                total += v[i] * H[i, j]
            total *= twice
            for i in range(k + 1, n):
                H[i, j] -= total * v[i]
        for rows in (H, b, c):
            for i in range(rows.shape[0]):
                total = 0.0
                for j in range(k + 1, n):
                    total += v[j] * rows[i, j]
                total *= twice
                for j in range(k + 1, n):
                    rows[i, j] -= total * v[j]
        for i in range(k + 2, n):
            H[i, k] = 0.0
    return H, b, c


@entry
def respond(H, b, c, D, z, upper, solution, response):
    """Write D + C (zI - A)^-1 B to `response` (outputs, inputs), from the forms of hessenberg_form.

    `upper` (n, n) and `solution` (outputs, n), complex, are room to work in. Gaussian elimination with row exchange.
    """
    n = H.shape[0]
    outputs, inputs = c.shape[0], b.shape[0]
    for j in range(n):
        upper[0, j] = -H[0, j]
    upper[0, 0] += z
    for o in range(outputs):
        solution[o, 0] = c[o, 0]
    for k in range(n - 1):
        for j in range(k + 1, n):
            upper[k + 1, j] = -H[k + 1, j]
        upper[k + 1, k + 1] += z
        below = -H[k + 1, k]
        pivot = upper[k, k]
        for o in range(outputs):
            solution[o, k + 1] = c[o, k + 1]
        if below * below > pivot.real * pivot.real + pivot.imag * pivot.imag:
            ratio = pivot / below
            upper[k, k] = below
            for j in range(k + 1, n):
                upper[k, j], upper[k + 1, j] = upper[k + 1, j], upper[k, j] - ratio * upper[k + 1, j]
            for o in range(outputs):
                solution[o, k], solution[o, k + 1] = (
                    solution[o, k + 1], solution[o, k] - ratio * solution[o, k + 1],
                )  # fmt: skip
        elif below != 0.0:
            ratio = below / pivot
            for j in range(k + 1, n):
                upper[k + 1, j] -= ratio * upper[k, j]
            for o in range(outputs):
                solution[o, k + 1] -= ratio * solution[o, k]
    for k in range(n - 1, -1, -1):
        inverse = 1.0 / upper[k, k]
        for o in range(outputs):
            total = solution[o, k]
            for j in range(k + 1, n):
                total -= upper[k, j] * solution[o, j]
            solution[o, k] = total * inverse
    for o in range(outputs):
        for i in range(inputs):
            total = complex(D[o, i], 0.0)
            for j in range(n):
                total += b[i, j] * solution[o, j]
            response[o, i] = total


@entry
def frequency_response(A, B, C, D, period_s, frequencies):
    """Return D + C (zI - A)^-1 B, complex (frequencies, outputs, inputs), at z = exp(j w T); `frequencies` w [rad/s]."""
    H, b, c = hessenberg_form(A, B, C)
    n = A.shape[0]
    upper, solution = np.empty((n, n), np.complex128), np.empty((C.shape[0], n), np.complex128)
    response = np.empty((len(frequencies), C.shape[0], B.shape[1]), np.complex128)
    for i in range(len(frequencies)):
        angle = frequencies[i] * period_s
        respond(H, b, c, D, complex(math.cos(angle), math.sin(angle)), upper, solution, response[i])
    return response


AROUND = (-8.0, -4.0, -2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0, 4.0, 8.0)
"""Where points are added about a lightly damped pole, in half widths of its peak."""
BROAD = 0.5  # half width of a peak as share of its frequency, above which the plain grid sees it well


@entry
def frequency_grid(multipliers, period_s, per_decade):
    """Return frequencies [rad/s], ascending from 0.01 rad/s to Nyquist: logarithmic, and denser near poles that ring."""
    highest = math.pi / period_s
    decades = math.log10(highest / LOWEST_FREQUENCY)
    count = max(2, math.ceil(decades * per_decade) + 1)
    extra = 0
    grid = np.empty(count + len(AROUND) * len(multipliers))
    for i in range(count):
        grid[i] = LOWEST_FREQUENCY * 10.0 ** (decades * i / (count - 1))
    for i in range(len(multipliers)):
        z = multipliers[i]
        size = abs(z)
        if z.imag <= 0.0 or size < 1e-3:
            continue
        centre = math.atan2(z.imag, z.real) / period_s
        width = abs(math.log(size)) / period_s
        if width > BROAD * centre:
            continue
        for place in AROUND:
            w = centre + place * width
            if LOWEST_FREQUENCY < w < highest:
                grid[count + extra] = w
                extra += 1
    grid[count - 1] = highest
    return np.sort(grid[: count + extra])
