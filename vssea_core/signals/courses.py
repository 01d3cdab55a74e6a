"""Closed forms of references that few runs use, each with four derivatives: multi-sine, filtered step, chirp and jog.

Rows of all references begin alike: kind, six numbers of the kind, and at 7 when it was set [s]; more may follow from 8 on.
"""

import math

import numpy as np
from numpy.typing import NDArray

from vssea_core.compiled import entry, inlined
from vssea_core.control.law import Target
from vssea_core.signals.disturbances import chirp_law
from vssea_core.signals.documents import ChirpReference, JogReference
from vssea_core.signals.smooth_step import faded_in, faded_out, risen, smooth_step

HEAD = 8
SETTLED = 50.0  # bandwidth times time after which a five-fold pole is settled to the last digit
SLOWEST = 1e-12  # rad/s; a slower jog is none, and its quotients would not be numbers
EASE_SHARE = 0.1  # share of a sweep over which it eases into its end frequency
EASE = 14  # where a chirp's row holds the eight coefficients of that part
FASTEST, SHARPEST, HARSHEST = 630.0 / 256.0, 2520.0 * (3.0 / 14.0) ** 3 / math.sqrt(7.0), 78.75
"""Largest first, second and third derivative of the 9th-order step."""


@inlined
def multisine(row, time):
    """Return offset plus the sines of a row, faded in."""
    r, r1, r2, r3, r4 = row[1], 0.0, 0.0, 0.0, 0.0
    for i in range(int(row[3])):
        size, w, phase = row[HEAD + 3 * i], row[HEAD + 3 * i + 1], row[HEAD + 3 * i + 2]
        sine, cosine = size * math.sin(w * time + phase), size * math.cos(w * time + phase)
        r, r1, r2, r3, r4 = (
            r + sine, r1 + w * cosine, r2 - w * w * sine, r3 - w * w * w * cosine, r4 + w * w * w * w * sine,
        )  # fmt: skip
    return faded_in(Target(r, r1, r2, r3, r4), row[2], time)


@inlined
def filtered_step(row, time):
    """Return the answer of 1 / (s / w + 1)^5 to a step, or to steps to and fro: the sum over the edges not yet settled."""
    origin, target, w, dwell = row[1], row[2], row[4], row[5]
    since = time - row[3]
    if since <= 0.0:
        return Target(origin, 0.0, 0.0, 0.0, 0.0)
    edges = math.floor(since / dwell) if row[6] != 0.0 else 0.0
    size = target - origin if edges % 2.0 == 0.0 else origin - target
    r = target if edges % 2.0 == 0.0 else origin
    r1 = r2 = r3 = r4 = 0.0
    x = w * (since - edges * dwell)
    while x < SETTLED and edges >= 0.0:
        g0 = math.exp(-x)  # g_m = x^m exp(-x) / m!, so g_m' = g_(m-1) - g_m
        g1 = g0 * x
        g2 = g1 * x / 2.0
        g3 = g2 * x / 3.0
        g4 = g3 * x / 4.0
        r -= size * (g0 + g1 + g2 + g3 + g4)
        r1 += size * g4
        r2 += size * (g3 - g4)
        r3 += size * (g2 - 2.0 * g3 + g4)
        r4 += size * (g1 - 3.0 * g2 + 3.0 * g3 - g4)
        x += w * dwell
        edges -= 1.0
        size = -size
    return Target(r, w * r1, w**2 * r2, w**3 * r3, w**4 * r4)


def chirp_row(reference: ChirpReference) -> list[float]:
    """Return the numbers of a chirp behind its kind, without when it was set.

    Over the last tenth of the sweep the frequency follows the polynomial of degree 7 that joins it to the end frequency
    with three continuous derivatives.
    """
    law = chirp_law(reference.start_frequency_hz, reference.end_frequency_hz, reference.duration_s, reference.sweep)
    low, growth, duration, logarithmic = law
    high = 2.0 * math.pi * reference.end_frequency_hz
    length = EASE_SHARE * duration
    until = duration - length
    grown = math.exp(growth * until)
    linear = np.array([low + growth * until, growth, 0.0, 0.0])
    left = low * grown * growth ** np.arange(4.0) if logarithmic else linear
    angle = low * (grown - 1.0) / growth if logarithmic else until * (low + 0.5 * growth * until)
    first = left * length ** np.arange(4.0) / np.array([1.0, 1.0, 2.0, 6.0])
    powers = np.array([[math.perm(k, i) for k in range(8)] for i in range(4)], dtype=float)
    wanted = np.array([high, 0.0, 0.0, 0.0]) - powers[:, :4] @ first
    ease = np.concatenate([first, np.linalg.solve(powers[:, 4:], wanted)])
    end_angle = angle + length * float(np.sum(ease / np.arange(1.0, 9.0)))
    head = [reference.amplitude, reference.offset, reference.fade_in_s, float(reference.after == "stop"), duration]
    return [*head, logarithmic, 0.0, low, growth, angle, high, end_angle, length, *ease.tolist()]


@inlined
def swept_angle(row, time):
    """Return the angle [rad] of a chirp and its four derivatives."""
    duration, low, growth, angle, high, length = row[5], row[8], row[9], row[10], row[11], row[13]
    until = duration - length
    if time >= duration:
        return row[12] + high * (time - duration), high, 0.0, 0.0, 0.0
    if time >= until:
        x = (time - until) / length
        turned = w0 = w1 = w2 = w3 = 0.0
        for k in range(7, -1, -1):
            c = row[EASE + k]
            turned = turned * x + c / (k + 1.0)
            w0 = w0 * x + c
        for k in range(7, 0, -1):
            w1 = w1 * x + k * row[EASE + k]
        for k in range(7, 1, -1):
            w2 = w2 * x + k * (k - 1.0) * row[EASE + k]
        for k in range(7, 2, -1):
            w3 = w3 * x + k * (k - 1.0) * (k - 2.0) * row[EASE + k]
        return angle + length * x * turned, w0, w1 / length, w2 / length**2, w3 / length**3
    if row[6] == 0.0:
        return time * (low + 0.5 * growth * time), low + growth * time, growth, 0.0, 0.0
    grown = math.expm1(growth * time)
    w = low * (1.0 + grown)
    return low * grown / growth, w, w * growth, w * growth**2, w * growth**3


@inlined
def chirp(row, time):
    """Return offset plus a swept sine, faded in, and faded out at the sweep's end if it stops there."""
    amplitude, offset, fade = row[1], row[2], row[3]
    angle, p1, p2, p3, p4 = swept_angle(row, time)
    s, c = amplitude * math.sin(angle), amplitude * math.cos(angle)
    sine = Target(
        s,
        p1 * c,
        p2 * c - p1 * p1 * s,
        p3 * c - 3.0 * p1 * p2 * s - p1 * p1 * p1 * c,
        p4 * c - (4.0 * p1 * p3 + 3.0 * p2 * p2) * s - 6.0 * p1 * p1 * p2 * c + p1 * p1 * p1 * p1 * s,
    )
    if row[4] != 0.0:
        sine = faded_out(sine, fade, time - row[5] + fade)
    return faded_in(Target(offset + sine.r, sine.r1, sine.r2, sine.r3, sine.r4), fade, time)


def jog_row(reference: JogReference) -> list[float]:
    """Return the numbers of a jog from rest behind its kind, without when it was set and not yet planned."""
    distance = math.inf if reference.distance is None else reference.distance
    duration = math.inf if reference.duration_s is None else reference.duration_s
    head = [reference.origin, 0.0, reference.velocity, 0.0, math.inf, 0.0, 0.0]
    limits = FASTEST / reference.acceleration, SHARPEST / reference.jerk, HARSHEST / reference.snap
    return [*head, *limits, reference.velocity, distance, duration]


@inlined
def ramp_time(row, change):
    """Return how long [s] a change of velocity [rad/s] takes within the limits of a jog."""
    size = abs(change)
    return max(1e-6, size * row[8], math.sqrt(size * row[9]), (size * row[10]) ** (1.0 / 3.0))


@inlined
def covered(row, velocity):
    """Return how far [rad] a jog comes, in its direction, that goes to `velocity` [rad/s] and at once to rest."""
    way = 0.5 * (row[2] + velocity) * ramp_time(row, velocity - row[2]) + 0.5 * velocity * ramp_time(row, velocity)
    return way if row[11] > 0.0 else -way


@entry
def plan_jog(row):
    """Set ramps and stop of a jog from the velocity it starts with; a short distance lowers the velocity it reaches."""
    velocity, distance = row[11], row[12]
    stop = math.inf
    if abs(velocity) < SLOWEST:
        velocity = 0.0
    if velocity != 0.0 and distance < math.inf:
        if covered(row, velocity) > distance:
            low, high = 0.0, 1.0
            for _ in range(60):
                middle = 0.5 * (low + high)
                if covered(row, middle * row[11]) > distance:
                    high = middle
                else:
                    low = middle
            velocity *= low
        if velocity != 0.0:
            stop = ramp_time(row, velocity - row[2]) + max(0.0, distance - covered(row, velocity)) / abs(velocity)
    row[3], row[4] = velocity, ramp_time(row, velocity - row[2])
    row[5], row[6] = min(stop, row[13]), ramp_time(row, velocity)


@inlined
def jog(row, time):
    """Return motion from one velocity to another and, if it stops, to rest."""
    start, velocity, ramp, stop, stop_ramp = row[2], row[3], row[4], row[5], row[6]
    gain = velocity - start
    s = smooth_step(time / ramp)
    r = row[1] + start * time + gain * ramp * risen(time / ramp)
    r1, r2, r3, r4 = start + gain * s.r, gain * s.r1 / ramp, gain * s.r2 / ramp**2, gain * s.r3 / ramp**3
    if time > stop:
        x = (time - stop) / stop_ramp
        s = smooth_step(x)
        r -= velocity * stop_ramp * risen(x)
        r1 -= velocity * s.r
        r2 -= velocity * s.r1 / stop_ramp
        r3 -= velocity * s.r2 / stop_ramp**2
        r4 -= velocity * s.r3 / stop_ramp**3
    return Target(r, r1, r2, r3, r4)


def numbers(kind: float, row: list[float], set_at_s: float) -> NDArray[np.float64]:
    """Return a reference row from its kind, what is behind it, and when it was set [s]."""
    made = np.array([kind, *row])
    made[HEAD - 1] = set_at_s
    return made
