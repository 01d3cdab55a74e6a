"""Figures of merit of recorded samples, each defined once. Never from a moving end sample: over a stated window.

Those that need a stated final value or instant are in step_response, settling and events.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vssea_core.channels import INDEX, LIMITS

Rows = NDArray[np.float64]


@dataclass(frozen=True)
class Metric:
    """One figure: its name, the words and the unit it is shown with, what it means, and how it is computed from rows."""

    name: str
    label: str
    unit: str
    description: str
    compute: Callable[[Rows], float]


def _column(rows: Rows, name: str) -> Rows:
    column: Rows = rows[:, INDEX[name]]
    return column


def _rms(values: Rows) -> float:
    # Added one after another, as runs side by side do: both are then equal to the bit.
    return float(np.sqrt(np.add.accumulate(np.square(values))[-1] / len(values))) if len(values) else 0.0


def _peak(values: Rows) -> float:
    return float(np.max(np.abs(values))) if len(values) else 0.0


def _of(channel: str, statistic: Callable[[Rows], float]) -> Callable[[Rows], float]:
    return lambda rows: statistic(_column(rows, channel))


TORQUE_LIMITS = sum(limit.bit for limit in LIMITS if limit.name.startswith(("motor_", "rig_")))


def _saturated(rows: Rows) -> float:
    bits = _column(rows, "limits").astype(np.int64)
    return 100.0 * float(np.mean((bits & TORQUE_LIMITS) != 0)) if len(rows) else 0.0


def _saturated_s(rows: Rows) -> float:
    time = _column(rows, "time")
    if len(time) < 2:
        return 0.0
    period = float(time[-1] - time[0]) / (len(time) - 1)
    return _saturated(rows) / 100.0 * len(time) * period


METRICS: tuple[Metric, ...] = (
    Metric("peak_error", "peak error", "rad", "Largest |reference - link|.", _of("error", _peak)),
    Metric("rms_error", "RMS error", "rad", "Root mean square of reference - link.", _of("error", _rms)),
    Metric("peak_torque", "peak torque", "N·m", "Largest applied motor torque.", _of("motor_torque", _peak)),
    Metric(
        "rms_torque", "RMS torque", "N·m", "Root mean square of the applied motor torque.", _of("motor_torque", _rms)
    ),
    Metric(
        "torque_chatter",
        "torque chatter",
        "N·m",
        "Root mean square of the change of the motor torque from one sample to the next.",
        _of("motor_torque", lambda torque: _rms(np.diff(torque))),
    ),
    Metric("saturated", "saturated", "%", "Share of samples in which a limit held the motor torque back.", _saturated),
    Metric("saturated_time", "time saturated", "s", "Time in which a limit held the motor torque back.", _saturated_s),
    Metric(
        "observer_error",
        "observer error",
        "N·m",
        "Root mean square of link disturbance - estimate.",
        lambda rows: _rms(_column(rows, "link_disturbance") - _column(rows, "link_disturbance_estimate")),
    ),
    Metric(
        "motor_observer_error",
        "motor observer error",
        "N·m",
        "Root mean square of motor disturbance, dry friction included, - estimate.",
        lambda rows: _rms(_column(rows, "motor_disturbance") - _column(rows, "motor_disturbance_estimate")),
    ),
)


def metrics(rows: Rows) -> dict[str, float]:
    """Return every metric of `rows` (samples, channels) by name, in the units of METRICS."""
    return {metric.name: metric.compute(rows) for metric in METRICS}


def limit_shares(rows: Rows) -> dict[str, float]:
    """Return by limit's name the share of samples [0, 1] in which it was active; limits that never were are left out."""
    bits = _column(rows, "limits").astype(np.int64)
    shares = {limit.name: float(np.mean((bits & limit.bit) != 0)) if len(bits) else 0.0 for limit in LIMITS}
    return {name: share for name, share in shares.items() if share > 0.0}
