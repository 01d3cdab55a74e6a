"""References with four continuous derivatives, and the transition that keeps them continuous through any live change."""

import math

import numpy as np
from numpy.typing import NDArray

from vssea_core.compiled import entry, inlined
from vssea_core.control.law import Target
from vssea_core.signals.documents import Reference

SINE, MOVE, STEP = 0.0, 1.0, 2.0
REFERENCE_SIZE = 8
TRANSITION_SIZE = 5
TRANSITION_RATE = 12.0
"""Five-fold pole [rad/s] at which a live change of the reference is worked off."""
TIME_SLACK_S = 1e-9


def reference_row(reference: Reference, set_at_s: float = 0.0) -> NDArray[np.float64]:
    """Return the reference as 8 numbers for the kernel; the first is its kind, the last when it was set [s]."""
    if reference.kind == "sine":
        frequency = 2.0 * math.pi * reference.frequency_hz
        numbers = (SINE, reference.amplitude, frequency, reference.offset, reference.fade_in_s, 0.0, 0.0)
        return np.array([*numbers, set_at_s])
    kind, duration = (MOVE, reference.duration_s) if reference.kind == "move" else (STEP, 0.0)
    places = (reference.origin, reference.target, reference.start_s)
    return np.array([kind, *places, duration, reference.dwell_s, float(reference.repeat), set_at_s])


@inlined
def smooth_step(x):
    """Return the 9th-order polynomial from 0 to 1 over 0 <= x <= 1, flat to the fourth derivative, and four derivatives."""
    if x <= 0.0:
        return Target(0.0, 0.0, 0.0, 0.0, 0.0)
    if x >= 1.0:
        return Target(1.0, 0.0, 0.0, 0.0, 0.0)
    u = x * (1.0 - x)
    v = 1.0 - 2.0 * x
    value = x * x * x * x * x * (126.0 + x * (-420.0 + x * (540.0 + x * (-315.0 + 70.0 * x))))
    return Target(
        value,
        630.0 * u * u * u * u,
        2520.0 * u * u * u * v,
        7560.0 * u * u * v * v - 5040.0 * u * u * u,
        15120.0 * u * v * v * v - 45360.0 * u * u * v,
    )


@inlined
def moved(origin, target, time, duration):
    """Return the rest-to-rest move [rad] of `duration` [s] at `time` since its start, and four derivatives."""
    s = smooth_step(time / duration)
    rate = 1.0 / duration
    size = target - origin
    return Target(
        origin + size * s.r,
        size * rate * s.r1,
        size * rate**2 * s.r2,
        size * rate**3 * s.r3,
        size * rate**4 * s.r4,
    )


@inlined
def faded_sine(amplitude, w, offset, fade_in_s, time):
    """Return (offset + amplitude sin(w t)) times a smooth fade-in, and four derivatives by Leibniz' rule."""
    sine = amplitude * math.sin(w * time)
    cosine = amplitude * math.cos(w * time)
    f0, f1, f2, f3, f4 = offset + sine, w * cosine, -w * w * sine, -w * w * w * cosine, w * w * w * w * sine
    if time >= fade_in_s:
        return Target(f0, f1, f2, f3, f4)
    s = moved(0.0, 1.0, time, fade_in_s)
    return Target(
        s.r * f0,
        s.r * f1 + s.r1 * f0,
        s.r * f2 + 2.0 * s.r1 * f1 + s.r2 * f0,
        s.r * f3 + 3.0 * s.r1 * f2 + 3.0 * s.r2 * f1 + s.r3 * f0,
        s.r * f4 + 4.0 * s.r1 * f3 + 6.0 * s.r2 * f2 + 4.0 * s.r3 * f1 + s.r4 * f0,
    )


@inlined
def reference_at(row, now):
    """Return the Target of a reference row at scenario time `now` [s]."""
    time = now - row[7]
    if row[0] == SINE:
        return faded_sine(row[1], row[2], row[3], row[4], time)
    origin, target, since = row[1], row[2], time - row[3] + TIME_SLACK_S
    if since < 0.0:
        return Target(origin, 0.0, 0.0, 0.0, 0.0)
    if row[6] != 0.0:
        cycle = row[4] + row[5]
        turn = math.floor(since / cycle)
        since -= turn * cycle
        if turn % 2.0 != 0.0:
            origin, target = target, origin
    if row[0] == STEP:
        return Target(target, 0.0, 0.0, 0.0, 0.0)
    return moved(origin, target, since - TIME_SLACK_S, row[4])


@inlined
def with_transition(target, y):
    """Return `target` plus what is left of earlier references.

    `y` holds (D + w)^i z, i = 0..4, of a signal z that obeys (D + w)^5 z = 0.
    """
    w = TRANSITION_RATE
    z = y[0]
    z1 = y[1] - w * z
    z2 = y[2] - w * (2.0 * z1 + w * z)
    z3 = y[3] - w * (3.0 * z2 + w * (3.0 * z1 + w * z))
    z4 = y[4] - w * (4.0 * z3 + w * (6.0 * z2 + w * (4.0 * z1 + w * z)))
    return Target(target.r + z, target.r1 + z1, target.r2 + z2, target.r3 + z3, target.r4 + z4)


@inlined
def decay_transition(y, time):
    """Advance the transition `y` (5) by `time` [s], exactly, in place."""
    shrink = math.exp(-TRANSITION_RATE * time)
    t = time
    y0 = y[0] + t * (y[1] + t / 2.0 * (y[2] + t / 3.0 * (y[3] + t / 4.0 * y[4])))
    y1 = y[1] + t * (y[2] + t / 2.0 * (y[3] + t / 3.0 * y[4]))
    y2 = y[2] + t * (y[3] + t / 2.0 * y[4])
    y3 = y[3] + t * y[4]
    y[0], y[1], y[2], y[3], y[4] = shrink * y0, shrink * y1, shrink * y2, shrink * y3, shrink * y[4]


@entry
def change_reference(old, new, now, transition):
    """Add to `transition` (5) what keeps the reference continuous as row `old` gives way to `new` at `now` [s].

    A step is raw by nature: changing to one drops what was left.
    """
    if new[0] == STEP:
        transition[:] = 0.0
        return
    a, b = reference_at(old, now), reference_at(new, now)
    w = TRANSITION_RATE
    z, z1, z2, z3, z4 = a.r - b.r, a.r1 - b.r1, a.r2 - b.r2, a.r3 - b.r3, a.r4 - b.r4
    transition[0] += z
    transition[1] += z1 + w * z
    transition[2] += z2 + w * (2.0 * z1 + w * z)
    transition[3] += z3 + w * (3.0 * z2 + w * (3.0 * z1 + w * z))
    transition[4] += z4 + w * (4.0 * z3 + w * (6.0 * z2 + w * (4.0 * z1 + w * z)))
