"""Takes the README's screenshot from a running server: `python docs/screenshot.py [http://127.0.0.1:8000/]`."""

import os
import sys
from pathlib import Path

from playwright.sync_api import sync_playwright

FLAGS = ["--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader", "--disable-background-networking"]
IMAGE = Path(__file__).parent / "images" / "tune.png"


def main(address: str) -> None:
    """Open the page, let it run, and save what it looks like."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=os.environ.get("CHROMIUM", "/usr/bin/chromium"), args=FLAGS
        )
        page = browser.new_page(viewport={"width": 1366, "height": 768}, color_scheme="dark", bypass_csp=True)
        page.goto(address, wait_until="load", timeout=60_000)
        page.wait_for_function("() => window.vssea && window.vssea.latest('time') > 12", timeout=60_000)
        page.wait_for_timeout(6_000)
        page.screenshot(path=IMAGE)
        browser.close()


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "http://127.0.0.1:8000/")
