"""Figures of a step response: rise, settling, overshoot, steady error, from a stated final value and time origin."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from vssea_core.simulation.settling import settled_at

Samples = NDArray[np.float64]

LOW, HIGH = 0.1, 0.9
BAND = 0.02
STEADY_WINDOW_S = 0.2
FIGURES = ("rise_time_s", "settling_time_s", "overshoot_percent", "steady_error")


@dataclass(frozen=True)
class StepMetrics:
    """The figures of one step; None where one is not defined, with the reason in `undefined` by its name."""

    rise_time_s: float | None
    """Time between first reaching 10 % and first reaching 90 % of the step [s]."""
    settling_time_s: float | None
    """Time from the origin until the position is within the band around the final value for good [s]."""
    overshoot_percent: float | None
    """Farthest beyond the final value, in percent of the step; 0 if it never passes it."""
    steady_error: float | None
    """Final value - mean position over the last `steady_window_s` of the record [rad]."""
    undefined: dict[str, str] = field(default_factory=dict)


def step_metrics(
    time: Samples,
    position: Samples,
    initial: float,
    final: float,
    band: float = BAND,
    *,
    origin_s: float | None = None,
    steady_window_s: float = STEADY_WINDOW_S,
) -> StepMetrics:
    """Return the StepMetrics of `position` (samples,) [rad] over `time` (samples,) [s], for a step `initial` to `final` [rad].

    `final` is what was asked for, never a last sample. `band` is a share of the step; `origin_s` is when the step was asked
    for, by default the first sample. Raises ValueError if the two records differ in length or the band is not above 0.
    """
    if len(time) != len(position):
        raise ValueError(f"{len(time)} times for {len(position)} positions; expected one each")
    if not band > 0.0:
        raise ValueError(f"the settling band is {band:g}; expected a share of the step above 0, such as {BAND:g}")
    undefined: dict[str, str] = {}
    step = final - initial
    if not len(time):
        why = "nothing was recorded"
        return StepMetrics(None, None, None, None, dict.fromkeys(FIGURES, why))
    steady = _steady_error(time, position, final, steady_window_s, undefined)
    if step == 0.0:
        why = "initial and final value are the same"
        return StepMetrics(None, None, None, steady, dict.fromkeys(FIGURES[:3], why) | undefined)
    share = (position - initial) / step
    origin = float(time[0]) if origin_s is None else origin_s

    reached = [_first_reached(time, share, level) for level in (LOW, HIGH)]
    rise = None if reached[0] is None or reached[1] is None else reached[1] - reached[0]
    if rise is None:
        undefined["rise_time_s"] = f"reached {100 * float(share.max()):.3g} % of the step, not {100 * HIGH:g} %"

    settled = settled_at(time, share - 1.0, band)
    if settled is None:
        away = 100.0 * abs(float(share[-1]) - 1.0)
        undefined["settling_time_s"] = (
            f"{away:.3g} % off at the end of the record, outside the band of {100 * band:g} %"
        )
    overshoot = 100.0 * max(0.0, float(share.max()) - 1.0)
    return StepMetrics(rise, None if settled is None else settled - origin, overshoot, steady, undefined)


def _first_reached(time: Samples, share: Samples, level: float) -> float | None:
    """Return when `share` first is at or above `level`, along straight lines between samples."""
    at_or_above = np.flatnonzero(share >= level)
    if not len(at_or_above):
        return None
    first = int(at_or_above[0])
    if first == 0:
        return float(time[0])
    before, after = share[first - 1], share[first]
    return float(time[first - 1] + (level - before) / (after - before) * (time[first] - time[first - 1]))


def _steady_error(
    time: Samples, position: Samples, final: float, window_s: float, undefined: dict[str, str]
) -> float | None:
    period = (time[-1] - time[0]) / max(1, len(time) - 1)
    if time[-1] - time[0] + period < window_s - 1e-9:
        undefined["steady_error"] = f"the record is shorter than the window of {window_s:g} s"
        return None
    return float(final - np.mean(position[time > time[-1] - window_s + 1e-9]))
