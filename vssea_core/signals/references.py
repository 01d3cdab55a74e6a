"""References with four continuous derivatives, and the transition that keeps them continuous through any live change."""

import math

import numpy as np
from numpy.typing import NDArray

from vssea_core.compiled import called, entry, inlined
from vssea_core.control.law import Target
from vssea_core.signals.courses import (
    HEAD,
    chirp,
    chirp_row,
    filtered_step,
    jog,
    jog_row,
    multisine,
    numbers,
    plan_jog,
)
from vssea_core.signals.documents import Reference
from vssea_core.signals.recorded import recorded, recorded_row
from vssea_core.signals.smooth_step import faded_in, moved

SINE, MOVE, STEP, MULTISINE, FILTERED_STEP, CHIRP, JOG, RECORDED = 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0
REFERENCE_SIZE = HEAD
"""Numbers of a row that all kinds have; a kind may have more behind them."""
TRANSITION_SIZE = 5
TRANSITION_RATE = 12.0
"""Five-fold pole [rad/s] at which a live change of the reference is worked off."""
TIME_SLACK_S = 1e-9


def reference_row(reference: Reference, set_at_s: float = 0.0) -> NDArray[np.float64]:
    """Return the reference as numbers (n,) for the kernel: its kind, six numbers, when it was set [s], and what else it needs."""
    match reference.kind:
        case "sine":
            frequency = 2.0 * math.pi * reference.frequency_hz
            row = [reference.amplitude, frequency, reference.offset, reference.fade_in_s, 0.0, 0.0, 0.0]
            return numbers(SINE, row, set_at_s)
        case "move":
            row = [reference.origin, reference.target, reference.start_s, reference.duration_s]
            return numbers(MOVE, [*row, reference.dwell_s, float(reference.repeat), 0.0], set_at_s)
        case "step":
            row = [reference.origin, reference.target, reference.start_s, 0.0]
            return numbers(STEP, [*row, reference.dwell_s, float(reference.repeat), 0.0], set_at_s)
        case "multisine":
            parts = reference.components
            sines = [x for p in parts for x in (p.amplitude, 2.0 * math.pi * p.frequency_hz, p.phase)]
            row = [reference.offset, reference.fade_in_s, float(len(parts)), 0.0, 0.0, 0.0, 0.0]
            return numbers(MULTISINE, [*row, *sines], set_at_s)
        case "filtered_step":
            row = [reference.origin, reference.target, reference.start_s, reference.bandwidth, reference.dwell_s]
            return numbers(FILTERED_STEP, [*row, float(reference.repeat), 0.0], set_at_s)
        case "chirp":
            return numbers(CHIRP, chirp_row(reference), set_at_s)
        case "jog":
            jogging = numbers(JOG, jog_row(reference), set_at_s)
            plan_jog(jogging)
            return jogging
        case "recorded":
            return numbers(RECORDED, recorded_row(reference), set_at_s)


@inlined
def faded_sine(amplitude, w, offset, fade_in_s, time):
    """Return (offset + amplitude sin(w t)) times a smooth fade-in, and four derivatives by Leibniz' rule."""
    sine = amplitude * math.sin(w * time)
    cosine = amplitude * math.cos(w * time)
    f0, f1, f2, f3, f4 = offset + sine, w * cosine, -w * w * sine, -w * w * w * cosine, w * w * w * w * sine
    return faded_in(Target(f0, f1, f2, f3, f4), fade_in_s, time)


@called
def other_course(row, time):
    """Return the Target of the kinds that few runs use, at `time` [s] since it was set."""
    if row[0] == MULTISINE:
        return multisine(row, time)
    if row[0] == FILTERED_STEP:
        return filtered_step(row, time)
    if row[0] == CHIRP:
        return chirp(row, time)
    if row[0] == JOG:
        return jog(row, time)
    return recorded(row, time)


@inlined
def reference_at(row, now):
    """Return the Target of a reference row at scenario time `now` [s]."""
    time = now - row[7]
    if row[0] == SINE:
        return faded_sine(row[1], row[2], row[3], row[4], time)
    if row[0] > STEP:
        return other_course(row, time)
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

    A step is raw by nature: changing to one drops what was left. A jog starts from where the reference is: its row is
    given the present position and velocity.
    """
    if new[0] == STEP:
        transition[:] = 0.0
        return
    a = reference_at(old, now)
    if new[0] == JOG:
        present = with_transition(a, transition)
        new[1], new[2] = present.r, present.r1
        plan_jog(new)
    b = reference_at(new, now)
    w = TRANSITION_RATE
    z, z1, z2, z3, z4 = a.r - b.r, a.r1 - b.r1, a.r2 - b.r2, a.r3 - b.r3, a.r4 - b.r4
    transition[0] += z
    transition[1] += z1 + w * z
    transition[2] += z2 + w * (2.0 * z1 + w * z)
    transition[3] += z3 + w * (3.0 * z2 + w * (3.0 * z1 + w * z))
    transition[4] += z4 + w * (4.0 * z3 + w * (6.0 * z2 + w * (4.0 * z1 + w * z)))
