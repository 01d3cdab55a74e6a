"""The rest-to-rest polynomial of 9th order, what is built of it, and products with it by Leibniz' rule."""

from vssea_core.compiled import inlined
from vssea_core.control.law import Target


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
def risen(x):
    """Return the integral of `smooth_step` from 0 to x."""
    if x <= 0.0:
        return 0.0
    if x >= 1.0:
        return x - 0.5
    return x * x * x * x * x * x * (21.0 + x * (-60.0 + x * (67.5 + x * (-35.0 + 7.0 * x))))


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
def product(s, f):
    """Return the product of two functions of time, each with four derivatives."""
    return Target(
        s.r * f.r,
        s.r * f.r1 + s.r1 * f.r,
        s.r * f.r2 + 2.0 * s.r1 * f.r1 + s.r2 * f.r,
        s.r * f.r3 + 3.0 * s.r1 * f.r2 + 3.0 * s.r2 * f.r1 + s.r3 * f.r,
        s.r * f.r4 + 4.0 * s.r1 * f.r3 + 6.0 * s.r2 * f.r2 + 4.0 * s.r3 * f.r1 + s.r4 * f.r,
    )


@inlined
def faded_in(f, fade_in_s, time):
    """Return `f` times a smooth rise from 0 to 1 over the first `fade_in_s` [s]."""
    if time >= fade_in_s:
        return f
    return product(moved(0.0, 1.0, time, fade_in_s), f)


@inlined
def faded_out(f, fade_s, time):
    """Return `f` times a smooth fall from 1 to 0 over the first `fade_s` [s]."""
    if time <= 0.0:
        return f
    if time >= fade_s:
        return Target(0.0, 0.0, 0.0, 0.0, 0.0)
    return product(moved(1.0, 0.0, time, fade_s), f)
