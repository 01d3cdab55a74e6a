"""Disturbance torques over time, as rows of numbers for the kernel.

A term is active over whole sample periods: from the first tick at or after its start to the first at or after its end.
Its value still varies inside the period: the integrator asks for it at the six instants of its step. What depends on the
state of the link has rows here too, but is evaluated by actuator.surroundings.
"""

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from vssea_core.compiled import called, entry, inlined
from vssea_core.signals.documents import Disturbances, LinkDisturbance
from vssea_core.signals.noise import STREAMS_A_LIST
from vssea_core.signals.smooth_noise import SPACING_BANDWIDTH, noise_at, noise_of_step

CONSTANT, SINE, PULSE, CHIRP, NOISE, PENDULUM, CONTACT = 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0
ROW_SIZE = 16
GRAVITY = 9.80665  # m/s^2
TIME_SLACK_S = 1e-9  # tick times are k T in floating point
INSTANTS = (0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0)
"""Instants of the integrator's step, as shares of its length (Dormand-Prince, order 5)."""
C2, C3, C4, C5, C6 = INSTANTS[1:]
Inertia = Literal["link", "motor", "stiffness_motor"]
INERTIAS: tuple[Inertia, ...] = ("link", "motor", "stiffness_motor")


def disturbance_rows(
    terms: Sequence[LinkDisturbance], sample_time_s: float, seed: int = 0, on: Inertia = "link"
) -> NDArray[np.float64]:
    """Return the terms that act `on` one inertia as an array (n, 16).

    Columns: kind, size, two numbers of the kind, start, end [s], then what its kind needs besides; for a sine, angular
    frequency [rad/s] and phase [rad], and cosine and sine of the angle from a tick to each later instant of a whole period.
    """
    rows: list[list[float]] = []
    for number, term in enumerate(terms):
        span = [term.start_s, math.inf if term.end_s is None else term.end_s]
        match term.kind:
            case "constant":
                rows.append([CONSTANT, term.torque, 0.0, 0.0, *span])
            case "sine":
                rows.append(_sine(term.amplitude, term.frequency_hz, term.phase, span, sample_time_s))
            case "multisine":
                parts = term.components
                rows.extend(_sine(p.amplitude, p.frequency_hz, p.phase, span, sample_time_s) for p in parts)
            case "pulse":
                rows.append([PULSE, term.torque, term.width_s, term.period_s if term.repeat else 0.0, *span])
            case "chirp":
                law = chirp_law(term.start_frequency_hz, term.end_frequency_hz, term.duration_s, term.sweep)
                rows.append([CHIRP, term.amplitude, law[0], law[1], *span, *law[2:]])
            case "noise":
                spacing = term.bandwidth_hz / SPACING_BANDWIDTH
                rows.append([NOISE, term.rms, spacing, float(seed), *span, float(noise_stream(on, number))])
            case "pendulum":
                rows.append([PENDULUM, GRAVITY * term.mass * term.length, 0.0, 0.0, *span])
            case "contact":
                side = 1.0 if term.side == "above" else -1.0
                rows.append([CONTACT, term.stiffness, term.damping, term.position, *span, side])
    table = np.zeros((len(rows), ROW_SIZE))
    for to, row in zip(table, rows, strict=True):
        to[: len(row)] = row
    return table


def _sine(amplitude: float, frequency_hz: float, phase: float, span: list[float], sample_time_s: float) -> list[float]:
    frequency = 2.0 * math.pi * frequency_hz
    angles = [frequency * sample_time_s * share for share in INSTANTS[1:]]
    turns = [*(math.cos(angle) for angle in angles), *(math.sin(angle) for angle in angles)]
    return [SINE, amplitude, frequency, phase, *span, *turns]


def noise_stream(on: Inertia, number: int) -> int:
    """Return the stream of the noise of term `number` of one inertia's list."""
    return (1 + INERTIAS.index(on)) * STREAMS_A_LIST + number


def chirp_law(start_hz: float, end_hz: float, duration_s: float, sweep: str) -> tuple[float, float, float, float]:
    """Return start frequency [rad/s], its growth, duration [s] and whether the sweep is logarithmic.

    The growth is the rate [rad/s^2] of a linear sweep, or the relative rate [1/s] of a logarithmic one.
    """
    low, high = 2.0 * math.pi * start_hz, 2.0 * math.pi * end_hz
    if sweep == "linear" or low == high:
        return low, (high - low) / duration_s, duration_s, 0.0
    return low, math.log(high / low) / duration_s, duration_s, 1.0


def disturbance_tables(
    disturbances: Disturbances, sample_time_s: float, seed: int
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return the rows of link, motor and stiffness motor."""
    link, motor, stiffness_motor = (
        disturbance_rows(getattr(disturbances, on), sample_time_s, seed, on) for on in INERTIAS
    )
    return link, motor, stiffness_motor


@inlined
def active(rows, i, tick_time):
    """Return whether term `i` acts over the period that starts at `tick_time` [s]."""
    return rows[i, 4] <= tick_time + TIME_SLACK_S and tick_time + TIME_SLACK_S < rows[i, 5]


@inlined
def pulse(rows, i, tick_time):
    """Return the torque [N m] of rectangular pulses over the period that starts at `tick_time` [s]."""
    since, period = tick_time + TIME_SLACK_S - rows[i, 4], rows[i, 3]
    if period > 0.0:
        since -= math.floor(since / period) * period
    return rows[i, 1] if since < rows[i, 2] else 0.0


@inlined
def chirp(rows, i, time):
    """Return the torque [N m] of a swept sine at `time` [s]."""
    low, growth, duration = rows[i, 2], rows[i, 3], rows[i, 6]
    swept = min(time - rows[i, 4], duration)
    held = time - rows[i, 4] - swept
    if rows[i, 7] == 0.0:
        angle, frequency = swept * (low + 0.5 * growth * swept), low + growth * swept
    else:
        grown = math.expm1(growth * swept)
        angle, frequency = low * grown / growth, low * (1.0 + grown)
    return rows[i, 1] * math.sin(angle + held * frequency)


@called
def rare_load(rows, i, tick_time, time):
    """Return the torque [N m] of a pulse, chirp or noise at `time` [s]."""
    if rows[i, 0] == PULSE:
        return pulse(rows, i, tick_time)
    if rows[i, 0] == CHIRP:
        return chirp(rows, i, time)
    return rows[i, 1] * noise_at(rows[i, 2], rows[i, 3], rows[i, 6], time)


@called
def rare_loads_of_step(rows, i, tick_time, time, h):
    """Return the torques [N m] of a pulse, chirp or noise at the six instants of a step of `h` [s] from `time`."""
    if rows[i, 0] == PULSE:
        torque = pulse(rows, i, tick_time)
        return torque, torque, torque, torque, torque, torque
    if rows[i, 0] == CHIRP:
        return (
            chirp(rows, i, time),
            chirp(rows, i, time + C2 * h),
            chirp(rows, i, time + C3 * h),
            chirp(rows, i, time + C4 * h),
            chirp(rows, i, time + C5 * h),
            chirp(rows, i, time + C6 * h),
        )
    size = rows[i, 1]
    a, b, c, d, e, f = noise_of_step(rows[i, 2], rows[i, 3], rows[i, 6], time, h, INSTANTS)
    return size * a, size * b, size * c, size * d, size * e, size * f


@inlined
def load(rows, tick_time, time):
    """Return the sum [N m] at `time` [s] of the functions of time that are active in the period starting at `tick_time`."""
    total = 0.0
    for i in range(rows.shape[0]):
        if active(rows, i, tick_time):
            if rows[i, 0] == CONSTANT:
                total += rows[i, 1]
            elif rows[i, 0] == SINE:
                total += rows[i, 1] * math.sin(rows[i, 2] * time + rows[i, 3])
            elif rows[i, 0] <= NOISE:
                total += rare_load(rows, i, tick_time, time)
    return total


@inlined
def loads_of_step(rows, tick_time, time, h, whole):
    """Return the torques [N m] at the six instants of a step of `h` [s] from `time`, in the period starting at `tick_time`.

    For constants and sines, the terms of most runs; `all_loads_of_step` is for any.
    If the step is the `whole` period, the angles of a sine are turned by precomputed ones, which saves four sines.
    """
    a = b = c = d = e = f = 0.0
    for i in range(rows.shape[0]):
        if active(rows, i, tick_time):
            size = rows[i, 1]
            angle = rows[i, 2] * time + rows[i, 3]
            if rows[i, 0] == CONSTANT:
                a, b, c, d, e, f = a + size, b + size, c + size, d + size, e + size, f + size
            elif whole:
                sine, cosine = size * math.sin(angle), size * math.cos(angle)
                a += sine
                b += sine * rows[i, 6] + cosine * rows[i, 11]
                c += sine * rows[i, 7] + cosine * rows[i, 12]
                d += sine * rows[i, 8] + cosine * rows[i, 13]
                e += sine * rows[i, 9] + cosine * rows[i, 14]
                f += sine * rows[i, 10] + cosine * rows[i, 15]
            else:
                turn = rows[i, 2] * h
                a += size * math.sin(angle)
                b += size * math.sin(angle + C2 * turn)
                c += size * math.sin(angle + C3 * turn)
                d += size * math.sin(angle + C4 * turn)
                e += size * math.sin(angle + C5 * turn)
                f += size * math.sin(angle + C6 * turn)
    return a, b, c, d, e, f


@called
def all_loads_of_step(rows, tick_time, time, h, whole):
    """Return `loads_of_step` for terms of any kind that is a function of time."""
    a = b = c = d = e = f = 0.0
    for i in range(rows.shape[0]):
        if rows[i, 0] <= SINE:
            part = loads_of_step(rows[i : i + 1], tick_time, time, h, whole)
        elif rows[i, 0] <= NOISE and active(rows, i, tick_time):
            part = rare_loads_of_step(rows, i, tick_time, time, h)
        else:
            continue
        a, b, c, d, e, f = a + part[0], b + part[1], c + part[2], d + part[3], e + part[4], f + part[5]
    return a, b, c, d, e, f


@inlined
def only_constants_and_sines(rows):
    """Return whether `loads_of_step` does for these terms."""
    found = True
    for i in range(rows.shape[0]):
        found = found and rows[i, 0] <= SINE
    return found


@entry
def load_at(rows, time):
    """Return the torque [N m] of the functions of time at a tick at `time` [s]."""
    return load(rows, time, time)
