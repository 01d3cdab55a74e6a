"""Gaussian noise as a smooth function of time: normal numbers at equidistant nodes, blended by cubic B-splines.

The weights are scaled so that the variance is the same between nodes as at them; two derivatives are continuous.
"""

import math

import numpy as np
from numpy.typing import NDArray

from vssea_core.compiled import called, inlined
from vssea_core.signals.noise import normal

SPACING_BANDWIDTH = 0.227483
"""Node spacing times the frequency at which the spectrum is down by 3 dB."""


@inlined
def blended(x, n0, n1, n2, n3):
    """Return the noise at the share x in [0, 1) of the way from node 1 to node 2 of four."""
    y = 1.0 - x
    a, d = y * y * y, x * x * x
    b, c = 4.0 - 3.0 * x * x * (1.0 + y), 4.0 - 3.0 * y * y * (1.0 + x)
    return (a * n0 + b * n1 + c * n2 + d * n3) / math.sqrt(a * a + b * b + c * c + d * d)


@called
def noise_at(per_spacing, seed, stream, time):
    """Return the noise of unit variance at `time` [s]."""
    x = time * per_spacing
    node = math.floor(x)
    return blended(
        x - node,
        normal(seed, stream, node - 1),
        normal(seed, stream, node),
        normal(seed, stream, node + 1),
        normal(seed, stream, node + 2),
    )


@called
def noise_of_step(per_spacing, seed, stream, time, h, instants):
    """Return the noise at the six instants of a step of `h` [s] from `time`, each node drawn once."""
    node = math.floor(time * per_spacing)
    n0, n1 = normal(seed, stream, node - 1), normal(seed, stream, node)
    n2, n3 = normal(seed, stream, node + 1), normal(seed, stream, node + 2)
    a = b = c = d = e = f = 0.0
    for i in range(6):
        x = (time + instants[i] * h) * per_spacing
        while x >= node + 1:
            node += 1
            n0, n1, n2, n3 = n1, n2, n3, normal(seed, stream, node + 2)
        a, b, c, d, e, f = b, c, d, e, f, blended(x - node, n0, n1, n2, n3)
    return a, b, c, d, e, f


def noise_and_rates(
    per_spacing: float, seed: int, stream: int, times: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return the noise of unit variance at `times` (n,) [s], its rate [1/s] and its second derivative [1/s^2]."""
    position = times * per_spacing
    node = np.floor(position)
    x = position - node
    y = 1.0 - x
    weights = np.array([y**3, 4 - 6 * x**2 + 3 * x**3, 4 - 6 * y**2 + 3 * y**3, x**3])
    first = np.array([-3 * y**2, -12 * x + 9 * x**2, 12 * y - 9 * y**2, 3 * x**2])
    second = np.array([6 * y, -12 + 18 * x, -12 + 18 * y, 6 * x])
    drawn = {k: normal(seed, stream, k) for k in range(int(node.min()) - 1, int(node.max()) + 3)}
    nodes = np.array([[drawn[int(k) + i] for k in node] for i in (-1, 0, 1, 2)])
    n0, n1, n2 = ((w * nodes).sum(axis=0) for w in (weights, first, second))
    s0, s1 = (weights**2).sum(axis=0), 2.0 * (weights * first).sum(axis=0)
    s2 = 2.0 * (first**2 + weights * second).sum(axis=0)
    value = n0 / np.sqrt(s0)
    rate = n1 / np.sqrt(s0) - 0.5 * n0 * s1 / s0**1.5
    acceleration = n2 / np.sqrt(s0) - n1 * s1 / s0**1.5 - 0.5 * n0 * s2 / s0**1.5 + 0.75 * n0 * s1**2 / s0**2.5
    return value, rate * per_spacing, acceleration * per_spacing**2
