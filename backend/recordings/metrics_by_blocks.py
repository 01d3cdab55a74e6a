"""The metrics of a long recording, block by block: to rounding those of vssea_core.simulation.metrics over all rows at once."""

import math

import numpy as np
from numpy.typing import NDArray

from vssea_core.channels import INDEX
from vssea_core.simulation.metrics import METRICS

Rows = NDArray[np.float64]
PEAKS = frozenset({"peak_error", "peak_torque"})
SQUARES = frozenset({"rms_error", "rms_torque", "observer_error", "motor_observer_error"})
CHATTER, SATURATED, SATURATED_TIME = "torque_chatter", "saturated", "saturated_time"


class MetricsByBlocks:
    """Takes blocks of rows (n, channels) in order; `metrics` has the figures of all of them."""

    def __init__(self) -> None:
        self._parts: dict[str, list[tuple[int, float]]] = {metric.name: [] for metric in METRICS}
        self._before: Rows | None = None
        self._count = 0
        self._first_s = self._last_s = 0.0

    def take(self, rows: Rows) -> None:
        """Take the next rows (n, channels), in the order of channels.CHANNELS."""
        if not len(rows):
            return
        joined = rows if self._before is None else np.concatenate([self._before, rows])
        has_limits = bool(np.isfinite(rows[:, INDEX["limits"]]).all())
        with np.errstate(invalid="ignore", over="ignore"):
            for metric in METRICS:
                if metric.name == CHATTER:
                    part = len(joined) - 1, metric.compute(joined)
                elif metric.name in (SATURATED, SATURATED_TIME) and not has_limits:
                    part = len(rows), math.nan
                else:
                    part = len(rows), metric.compute(rows)
                self._parts[metric.name].append(part)
        times = rows[:, INDEX["time"]]
        if self._before is None:
            self._first_s = float(times[0])
        self._before, self._last_s = rows[-1:].copy(), float(times[-1])
        self._count += len(rows)

    def metrics(self) -> dict[str, float | None]:
        """Return every metric by name; None where channels that it needs were not recorded. {} without samples."""
        if not self._count:
            return {}
        found = {metric.name: self._whole(metric.name) for metric in METRICS}
        return {name: value if math.isfinite(value) else None for name, value in found.items()}

    def _whole(self, name: str) -> float:
        parts = self._parts[name]
        if name in PEAKS:
            return float(np.max([value for _, value in parts]))  # of NaN it is NaN
        if name in SQUARES or name == CHATTER:
            count = sum(count for count, _ in parts)
            return math.sqrt(_sum([count * value * value for count, value in parts]) / count) if count else 0.0
        share = _sum([count * value for count, value in self._parts[SATURATED]]) / self._count
        if name == SATURATED:
            return share
        if self._count < 2:
            return 0.0
        return share / 100.0 * self._count * (self._last_s - self._first_s) / (self._count - 1)


def _sum(values: list[float]) -> float:
    return math.fsum(values) if all(map(math.isfinite, values)) else float(np.sum(values))
