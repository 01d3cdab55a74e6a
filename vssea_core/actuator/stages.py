"""Stage arguments of the Runge-Kutta step: y + h (w1 k1 + ... + wn kn) on the six states of the plant, written out.

A loop over the stages would spill the tuples to memory; written out they stay in registers.
"""

from vssea_core.compiled import inlined


@inlined
def shifted_1(y, h, w1, k1):
    """Return y + h times the weighted sum of 1 slope."""
    return (
        y[0] + h * (w1 * k1[0]),
        y[1] + h * (w1 * k1[1]),
        y[2] + h * (w1 * k1[2]),
        y[3] + h * (w1 * k1[3]),
        y[4] + h * (w1 * k1[4]),
        y[5] + h * (w1 * k1[5]),
    )


@inlined
def shifted_2(y, h, w1, k1, w2, k2):
    """Return y + h times the weighted sum of 2 slopes."""
    return (
        y[0] + h * (w1 * k1[0] + w2 * k2[0]),
        y[1] + h * (w1 * k1[1] + w2 * k2[1]),
        y[2] + h * (w1 * k1[2] + w2 * k2[2]),
        y[3] + h * (w1 * k1[3] + w2 * k2[3]),
        y[4] + h * (w1 * k1[4] + w2 * k2[4]),
        y[5] + h * (w1 * k1[5] + w2 * k2[5]),
    )


@inlined
def shifted_3(y, h, w1, k1, w2, k2, w3, k3):
    """Return y + h times the weighted sum of 3 slopes."""
    return (
        y[0] + h * (w1 * k1[0] + w2 * k2[0] + w3 * k3[0]),
        y[1] + h * (w1 * k1[1] + w2 * k2[1] + w3 * k3[1]),
        y[2] + h * (w1 * k1[2] + w2 * k2[2] + w3 * k3[2]),
        y[3] + h * (w1 * k1[3] + w2 * k2[3] + w3 * k3[3]),
        y[4] + h * (w1 * k1[4] + w2 * k2[4] + w3 * k3[4]),
        y[5] + h * (w1 * k1[5] + w2 * k2[5] + w3 * k3[5]),
    )


@inlined
def shifted_4(y, h, w1, k1, w2, k2, w3, k3, w4, k4):
    """Return y + h times the weighted sum of 4 slopes."""
    return (
        y[0] + h * (w1 * k1[0] + w2 * k2[0] + w3 * k3[0] + w4 * k4[0]),
        y[1] + h * (w1 * k1[1] + w2 * k2[1] + w3 * k3[1] + w4 * k4[1]),
        y[2] + h * (w1 * k1[2] + w2 * k2[2] + w3 * k3[2] + w4 * k4[2]),
        y[3] + h * (w1 * k1[3] + w2 * k2[3] + w3 * k3[3] + w4 * k4[3]),
        y[4] + h * (w1 * k1[4] + w2 * k2[4] + w3 * k3[4] + w4 * k4[4]),
        y[5] + h * (w1 * k1[5] + w2 * k2[5] + w3 * k3[5] + w4 * k4[5]),
    )


@inlined
def shifted_5(y, h, w1, k1, w2, k2, w3, k3, w4, k4, w5, k5):
    """Return y + h times the weighted sum of 5 slopes."""
    return (
        y[0] + h * (w1 * k1[0] + w2 * k2[0] + w3 * k3[0] + w4 * k4[0] + w5 * k5[0]),
        y[1] + h * (w1 * k1[1] + w2 * k2[1] + w3 * k3[1] + w4 * k4[1] + w5 * k5[1]),
        y[2] + h * (w1 * k1[2] + w2 * k2[2] + w3 * k3[2] + w4 * k4[2] + w5 * k5[2]),
        y[3] + h * (w1 * k1[3] + w2 * k2[3] + w3 * k3[3] + w4 * k4[3] + w5 * k5[3]),
        y[4] + h * (w1 * k1[4] + w2 * k2[4] + w3 * k3[4] + w4 * k4[4] + w5 * k5[4]),
        y[5] + h * (w1 * k1[5] + w2 * k2[5] + w3 * k3[5] + w4 * k4[5] + w5 * k5[5]),
    )
