"""The 1 kHz loop for a minute, page closed and page open: lateness, execution, overruns, lost samples, processor time."""

import asyncio
import json
import multiprocessing
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import nullcontext

import numpy as np

from benchmarks.bare_loop import lateness_us
from benchmarks.live_server import LivePage, Server, live_page, open_page, running_server
from benchmarks.probed_server import PERCENTILES

DURATION_S = 60.0


async def listen(port: int, duration_s: float) -> int:
    """Take all telemetry for `duration_s` and return how many samples were lost."""
    async with live_page(port) as socket:
        page = LivePage(socket)
        try:
            async with asyncio.timeout(duration_s):
                while True:
                    await page.message()
        except TimeoutError:
            return page.lost


def measure(server: Server, page_open: bool) -> None:
    """Print one minute's figures."""
    with open_page(server.port) if page_open else nullcontext():
        server.post("/probe/start")
        before = server.processor_seconds()
        with ThreadPoolExecutor() as threads:  # the browser's driver has an event loop of its own in this thread
            lost = threads.submit(asyncio.run, listen(server.port, DURATION_S)).result()
        report = json.loads(server.post("/probe/report"))
        after = server.processor_seconds()
    load = {name: 100.0 * (after[name] - before[name]) / DURATION_S for name in before if name in after}
    counted = f"{report['samples']} samples, {report['overruns']} overruns, {lost} lost on the websocket"
    print(f"page {'open' if page_open else 'closed'}: {counted}")
    for name in ("lateness_us", "execution_us"):
        print(f"  {name:13}" + "   ".join(f"{label} {value:.1f}" for label, value in report[name].items()))
    others = ", ".join(f"{name} {share:.1f} %" for name, share in load.items() if name != "web")
    gap = f"worst event-loop gap {report['worst_event_loop_gap_ms']} ms"
    print(f"  web process: {gap}, {load['web']:.1f} % of a core; {others}")
    print(f"  scheduling: {'real-time' if report['real_time'] else 'best effort'}")


def compare() -> None:
    """Print what an empty loop gets from this machine."""
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as process:
        late = process.submit(lateness_us, DURATION_S / 2).result()
    percentiles = "   ".join(f"{label} {np.percentile(late, p):.1f}" for label, p in PERCENTILES.items())
    print(f"an empty 1 kHz loop on this machine, {DURATION_S / 2:.0f} s, for comparison\n  lateness_us  {percentiles}")


def main() -> None:
    """Print both minutes, and an empty loop's."""
    compare()
    with running_server(probed=True) as server:
        measure(server, page_open=False)
        measure(server, page_open=True)
