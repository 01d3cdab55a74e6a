"""The weights of a Runge-Kutta step of order 5 (Dormand-Prince) for x'' = a(x, x', t), and the sums that it takes of them.

The slope of a position is a velocity, which is itself a sum of accelerations. With that put in, a stage's positions need
no velocity but the first, and not the acceleration of the stage before: less to remember, and the springs of two
successive stages can be computed at the same time. The sums are written out: a loop would put the tuples in memory.
"""

from fractions import Fraction

from vssea_core.compiled import inlined
from vssea_core.fused import fused

_STAGES = (
    (),
    ((1, 5),),
    ((3, 40), (9, 40)),
    ((44, 45), (-56, 15), (32, 9)),
    ((19372, 6561), (-25360, 2187), (64448, 6561), (-212, 729)),
    ((9017, 3168), (-355, 33), (46732, 5247), (49, 176), (-5103, 18656)),
    ((35, 384), (0, 1), (500, 1113), (125, 192), (-2187, 6784), (11, 84)),
)
_WEIGHTS = [[Fraction(*share) for share in row] + [Fraction(0)] * (6 - len(row)) for row in _STAGES]
VELOCITY_WEIGHTS = tuple(tuple(map(float, row)) for row in _WEIGHTS)
"""Of the accelerations of the six stages, in the velocities of each stage and, last, of the step's end; times h."""
POSITION_WEIGHTS = tuple(
    tuple(float(sum(row[j] * _WEIGHTS[j][i] for j in range(6))) for i in range(6)) for row in _WEIGHTS
)
"""The same in the positions, besides the share of the step that the first velocities have passed; times h^2."""


@inlined
def moved_1(x, w1, a1):
    """Return x + w1 a1, of three inertias."""
    return fused(w1, a1[0], x[0]), fused(w1, a1[1], x[1]), fused(w1, a1[2], x[2])


@inlined
def moved_2(x, w1, a1, w2, a2):
    """Return x + w1 a1 + w2 a2."""
    return moved_1(moved_1(x, w1, a1), w2, a2)


@inlined
def moved_3(x, w1, a1, w2, a2, w3, a3):
    """Return x + w1 a1 + w2 a2 + w3 a3."""
    return moved_1(moved_2(x, w1, a1, w2, a2), w3, a3)


@inlined
def moved_4(x, w1, a1, w2, a2, w3, a3, w4, a4):
    """Return x + w1 a1 + ... + w4 a4."""
    return moved_1(moved_3(x, w1, a1, w2, a2, w3, a3), w4, a4)


@inlined
def moved_5(x, w1, a1, w2, a2, w3, a3, w4, a4, w5, a5):
    """Return x + w1 a1 + ... + w5 a5."""
    return moved_1(moved_4(x, w1, a1, w2, a2, w3, a3, w4, a4), w5, a5)
