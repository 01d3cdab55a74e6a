"""From starting the server to something moving on the page in Chromium: with an empty compile cache, and with a full one."""

import os
import socket
import subprocess
import sys
import tempfile
import time
import urllib.request
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

from benchmarks.live_server import CHROMIUM_FLAGS

MOVING = "() => window.vssea && window.vssea.latest('time') > 0.02 && window.vssea.latest('link_position') !== 0"


def answering(port: int) -> bool:
    """Return whether the server answers."""
    try:
        urllib.request.urlopen(f"http://127.0.0.1:{port}/", timeout=5).close()
    except OSError:
        return False
    return True


def measure(page: Page, cache: str) -> tuple[float, float]:
    """Return the times [s] from start to the page, and to the first motion on it."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    with tempfile.TemporaryDirectory() as data:
        environment = os.environ | {"VSSEA_DATA_DIR": data, "VSSEA_CACHE_DIR": cache}
        command = [sys.executable, "-m", "backend.cli", "serve", "--port", str(port)]
        started = time.perf_counter()
        process = subprocess.Popen(
            command, env=environment, cwd=Path(__file__).parent.parent, stdout=subprocess.DEVNULL
        )
        try:
            while not answering(port):
                time.sleep(0.05)
            page.goto(f"http://127.0.0.1:{port}/", wait_until="load", timeout=60_000)
            shown = time.perf_counter() - started
            page.wait_for_function(MOVING, timeout=120_000)
            return shown, time.perf_counter() - started
        finally:
            process.terminate()
            process.wait(20)


def main() -> None:
    """Print both."""
    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as cache:
        executable = os.environ.get("CHROMIUM", "/usr/bin/chromium")
        browser = playwright.chromium.launch(executable_path=executable, args=CHROMIUM_FLAGS)
        for what in ("empty compile cache", "full compile cache"):
            page = browser.new_page(viewport={"width": 1366, "height": 768}, bypass_csp=True)  # waiting evaluates text
            shown, moving = measure(page, cache)
            page.close()
            print(f"{what:20} page loaded after {shown:5.1f} s, something moves after {moving:5.1f} s")
        browser.close()
