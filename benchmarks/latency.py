"""From a command on the websocket to what it changes, as a page sees it: slider to torque and to margins, STOP to zero torque."""

import asyncio
import multiprocessing
import time
import urllib.request
from collections.abc import Callable
from contextlib import contextmanager

import numpy as np

from benchmarks.live_server import LivePage, Server, live_page, running_server
from vssea_core.scenarios import NOMINAL

COUNT = 50


async def slider(port: int) -> list[float]:
    """Return the delays [s] from sending a pole to receiving the first sample that it made, with its changed torque."""
    delays = []
    async with live_page(port) as socket:
        page = LivePage(socket)
        await page.message()
        for turn in range(COUNT):
            started = time.perf_counter()
            number = await page.send("tune", changes={"controller.natural_frequency": 20.0 + (turn + 1) % 2})
            reply = await page.reply(number)
            tuning_id = reply["result"]["tuning_id"]
            delays.append(await page.until("tuning_id", lambda ids, wanted=tuning_id: ids == wanted) - started)
            await asyncio.sleep(0.037)
    return delays


async def margins(port: int) -> list[float]:
    """Return the delays [s] from sending a pole to receiving the margins of the tuning that it made."""
    delays = []
    async with live_page(port) as socket:
        page = LivePage(socket)
        await page.message()
        for turn in range(COUNT):
            started = time.perf_counter()
            await page.send("tune", changes={"controller.natural_frequency": 20.0 + (turn + 1) % 2})
            await page.of_type("margins")
            delays.append(time.perf_counter() - started)
            await asyncio.sleep(0.037)
    return delays


async def stop(port: int) -> list[float]:
    """Return the delays [s] from sending STOP to receiving the first sample with zero motor torque."""
    delays = []
    async with live_page(port) as socket:
        page = LivePage(socket)
        await page.message()
        for _ in range(COUNT):
            await page.until("motor_torque", lambda torque: torque != 0.0)
            await asyncio.sleep(0.05)
            started = time.perf_counter()
            await page.send("stop")
            delays.append(await page.until("motor_torque", lambda torque: torque == 0.0) - started)
            await page.reply(await page.send("reset"))
            await page.reply(await page.send("resume"))
    return delays


@contextmanager
def simulations(server: Server, count: int = 3):
    """Keep `count` simulations of 30 s with all samples as JSON under way, asked by processes of their own."""
    askers = [multiprocessing.Process(target=ask_for_ever, args=(server.port,), daemon=True) for _ in range(count)]
    for asker in askers:
        asker.start()
    try:
        yield
    finally:
        for asker in askers:
            asker.terminate()
            asker.join()


def ask_for_ever(port: int) -> None:
    """Ask for one simulation after the other."""
    body = NOMINAL.model_copy(update={"duration_s": 30.0}).model_dump_json().encode()
    address = f"http://127.0.0.1:{port}/api/simulate?trajectory=json"
    while True:
        request = urllib.request.Request(address, body, {"Content-Type": "application/json"})
        with urllib.request.urlopen(request, timeout=300) as answer:
            answer.read()


def row(what: str, measure: Callable[[], list[float]]) -> None:
    """Print one line of figures."""
    delays = 1e3 * np.array(measure())
    print(f"{what:58} p50 {np.median(delays):7.2f} ms   worst {delays.max():7.2f} ms   of {len(delays)}")


def main() -> None:
    """Print the delays."""
    with running_server() as server:
        row("slider to changed torque, seen on the websocket", lambda: asyncio.run(slider(server.port)))
        row("slider to its margins, seen on the websocket", lambda: asyncio.run(margins(server.port)))
        row("STOP to zero torque, seen on the websocket, idle", lambda: asyncio.run(stop(server.port)))
        with simulations(server):
            row("the same while three simulations are computed", lambda: asyncio.run(stop(server.port)))
            row("slider to its margins while three simulations are computed", lambda: asyncio.run(margins(server.port)))
            row("slider while three simulations are computed", lambda: asyncio.run(slider(server.port)))
