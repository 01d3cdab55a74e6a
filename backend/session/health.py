"""What the ring says of a session: loop timing, live metrics, limits, pace. Cheap: a few numpy passes twice a second."""

import math
import time
from collections import deque
from collections.abc import Callable
from typing import Any

import numpy as np

from backend.telemetry.ring import EPOCH, EXECUTION_US, LATENESS_US, WIDTH, RingReader, Samples
from vssea_core.channels import INDEX, LIMITS
from vssea_core.simulation.metrics import METRICS

WINDOW_S = 10.0
RECENT_S = 0.5


class Health:
    """Reads the newest window of the ring and turns it into figures."""

    def __init__(self, ring: RingReader, clock: Callable[[], float] = time.monotonic) -> None:
        self._ring, self._clock = ring, clock
        self._marks: deque[tuple[float, int]] = deque(maxlen=8)

    def figures(self, period_s: float, epoch: int, free_core: int | None = None) -> dict[str, Any]:
        """Return the parts of a snapshot that come from the ring; `free_core` is the one that the workers stay off."""
        window = self._ring.last(round(WINDOW_S / period_s)).samples
        window = window[window[:, EPOCH] == epoch]
        recent = window[-max(1, round(RECENT_S / period_s)) :]
        newest = window[-1] if len(window) else None
        return {
            "loop": {
                "rate_hz": 1.0 / period_s,
                "lateness_us": _percentiles(window[:, LATENESS_US]),
                "execution_us": _percentiles(window[:, EXECUTION_US]),
                "overruns": self._ring.overruns,
                "scheduling": "real-time" if self._ring.real_time else "best effort",
                "free_core": free_core,
            },
            "limits": _active_limits(recent),
            "metrics": {"window_s": WINDOW_S, "items": _metric_items(window[:, :WIDTH])},
            "stiffness": None if newest is None else _known(newest[INDEX["stiffness"]]),
            "deflection": None if newest is None else _known(newest[INDEX["deflection"]]),
            "achieved": self._achieved(period_s),
        }

    def _achieved(self, period_s: float) -> float:
        """Return the real-time factor over the last seconds."""
        self._marks.append((self._clock(), self._ring.written))
        (then, before), (now, after) = self._marks[0], self._marks[-1]
        return (after - before) * period_s / (now - then) if now > then else 0.0


def _percentiles(values: Samples) -> dict[str, float]:
    if not len(values):
        return {"p50": 0.0, "p99": 0.0, "worst": 0.0}
    p50, p99, worst = np.percentile(values, (50, 99, 100))
    return {"p50": round(float(p50), 2), "p99": round(float(p99), 2), "worst": round(float(worst), 2)}


def _known(value: float) -> float | None:
    """Return a figure, None for what a rig cannot know, such as the true disturbance."""
    return float(value) if math.isfinite(value) else None


def _active_limits(samples: Samples) -> list[str]:
    bits = int(np.bitwise_or.reduce(samples[:, INDEX["limits"]].astype(np.int64))) if len(samples) else 0
    return [limit.sentence for limit in LIMITS if bits & limit.bit]


def _metric_items(rows: Samples) -> list[dict[str, Any]]:
    return [
        {
            "name": metric.name, "label": metric.label, "unit": metric.unit, "description": metric.description,
            "value": _known(metric.compute(rows)) if len(rows) else 0.0,
        }
        for metric in METRICS
    ]  # fmt: skip
