"""Noise as a function of seed, stream and index: the same in any order of evaluation, process or number of steps.

Philox4x32-10: J. K. Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", SC 2011. The key is (seed, stream), the
counter an index: of a sample for sensors, of a node in time for torques.
"""

import math

import numpy as np

from vssea_core.compiled import called, inlined

MULTIPLIER_0, MULTIPLIER_1 = np.uint64(0xD2511F53), np.uint64(0xCD9E8D57)
WEYL_0, WEYL_1 = np.uint64(0x9E3779B9), np.uint64(0xBB67AE85)
WORD, HALF = np.uint64(0xFFFFFFFF), np.uint64(32)
NOUGHT = np.uint64(0)
ROUNDS = 10
PER_WORD = 2.0**-32

SENSORS = 1.0  # stream of the sensors' noise
STREAMS_A_LIST = 256
"""Streams kept for the terms of one list of disturbances."""


@called
def philox(c0, c1, c2, c3, k0, k1):
    """Return four random words of 32 bits for a counter of four and a key of two, all as uint64."""
    for _ in range(ROUNDS):
        even, odd = MULTIPLIER_0 * c0, MULTIPLIER_1 * c2
        c0, c1, c2, c3 = (odd >> HALF) ^ c1 ^ k0, odd & WORD, (even >> HALF) ^ c3 ^ k1, even & WORD
        k0, k1 = (k0 + WEYL_0) & WORD, (k1 + WEYL_1) & WORD
    return c0, c1, c2, c3


@inlined
def words(seed, stream, index):
    """Return the four words of one index of a stream; all three arguments are whole numbers."""
    counter = np.uint64(np.int64(index))
    key = np.uint64(np.int64(seed)) & WORD, np.uint64(np.int64(stream)) & WORD
    return philox(counter & WORD, counter >> HALF, NOUGHT, NOUGHT, key[0], key[1])


@inlined
def radius(word):
    """Return the length of a Gaussian pair (Box-Muller) from a word; at most 6.8."""
    return math.sqrt(-2.0 * math.log((float(word) + 0.5) * PER_WORD))


@called
def four_normals(seed, stream, index):
    """Return four independent standard normal numbers for one index of a stream."""
    a, b, c, d = words(seed, stream, index)
    r, turn = radius(a), 2.0 * math.pi * PER_WORD * float(b)
    q, twist = radius(c), 2.0 * math.pi * PER_WORD * float(d)
    return r * math.cos(turn), r * math.sin(turn), q * math.cos(twist), q * math.sin(twist)


@called
def normal(seed, stream, index):
    """Return the first of `four_normals`, at half the work."""
    a, b, _, _ = words(seed, stream, index)
    return radius(a) * math.cos(2.0 * math.pi * PER_WORD * float(b))
