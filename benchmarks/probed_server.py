"""The server with a probe in it: how long its event loop was away at most, and how late every sample was."""

import asyncio
import sys
import time
from typing import Any

import numpy as np
import uvicorn

from backend.app import create_app
from backend.settings import Settings
from backend.telemetry.ring import EXECUTION_US, LATENESS_US

PROBE_S = 0.005
PERCENTILES = {"p50": 50, "p99": 99, "p99.9": 99.9, "worst": 100}


class Probe:
    """Measures from `start` to `report`."""

    def __init__(self, app: Any) -> None:
        self._ring = app.state.session.ring
        self._task: asyncio.Task[None] | None = None

    def start(self) -> None:
        """Begin a measurement."""
        self._first, self._overruns, self._worst_gap_s = self._ring.written, self._ring.overruns, 0.0
        self._task = asyncio.create_task(self._watch())

    async def _watch(self) -> None:
        due = time.perf_counter() + PROBE_S
        while True:
            await asyncio.sleep(max(0.0, due - time.perf_counter()))
            now = time.perf_counter()
            self._worst_gap_s = max(self._worst_gap_s, now - due)
            due = now + PROBE_S

    def report(self) -> dict[str, Any]:
        """Return the figures since `start`; a minute fits into the ring."""
        if self._task is not None:
            self._task.cancel()
        piece = self._ring.since(self._first)
        figures = {
            name: {
                label: float(np.percentile(piece.samples[:, column], p).round(1)) for label, p in PERCENTILES.items()
            }
            for name, column in (("lateness_us", LATENESS_US), ("execution_us", EXECUTION_US))
        }
        return figures | {
            "samples": len(piece.samples),
            "overruns": self._ring.overruns - self._overruns,
            "real_time": self._ring.real_time,
            "worst_event_loop_gap_ms": round(self._worst_gap_s * 1e3, 2),
        }


def main() -> None:
    """Serve on the port given as argument."""
    port = int(sys.argv[1])
    app = create_app(Settings(port=port))
    probe = Probe(app)

    @app.post("/probe/start")
    async def start() -> None:
        probe.start()

    @app.post("/probe/report")
    async def report() -> dict[str, Any]:
        return probe.report()

    routes = app.router.routes
    routes[:0] = [routes.pop(), routes.pop()]  # before the page, which takes every path
    uvicorn.run(app, port=port, log_level="warning", ws_per_message_deflate=False)


if __name__ == "__main__":
    main()
