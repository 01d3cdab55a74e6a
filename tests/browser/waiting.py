"""Waiting for a page, from outside: its own policy forbids playwright's way, which is `eval`."""

import time
from typing import Any

from playwright.sync_api import Page

PATIENCE_MS = 60_000  # WebGL without a graphics card is slow
LOOK_AGAIN_MS = 100


def wait_until(page: Page, condition: str, argument: Any = None) -> None:
    """Wait, a bounded time, until a function of the page returns true."""
    deadline = time.monotonic() + PATIENCE_MS / 1000
    while not page.evaluate(condition, argument):
        if time.monotonic() > deadline:
            raise TimeoutError(condition)
        page.wait_for_timeout(LOOK_AGAIN_MS)
