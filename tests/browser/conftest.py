"""A server with its scene, and a real browser, for all browser tests."""

from collections.abc import Callable, Iterator
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Browser, ConsoleMessage, Page, sync_playwright

from tests.backend.server import Server, until
from tests.browser.waiting import PATIENCE_MS, wait_until

ANALYSIS_LIMIT_S = 240.0
NO_SCENE = "<!doctype html><html lang=en><title>no scene</title></html>"
FLAGS = (
    "--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
)  # fmt: skip


@pytest.fixture(scope="session")
def browser_server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    started = Server(tmp_path_factory.mktemp("data"), VSSEA_SCENE="true")
    try:
        yield with_margins(started.wait_until_running())
    finally:
        started.terminate()


def with_margins(server: Server) -> Server:
    """The server once its analysis answers: in a new clone that has to be compiled first, for longer than a page waits."""
    httpx.post(server.url + "/api/analysis", json={}, trust_env=False, timeout=ANALYSIS_LIMIT_S).raise_for_status()
    return server


@pytest.fixture(scope="session")
def browser(chromium_path: str) -> Iterator[Browser]:
    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=chromium_path, args=list(FLAGS))
        yield opened
        opened.close()


@pytest.fixture
def running(browser_server: Server) -> Server:
    """The server with the nominal scenario just loaded and running."""
    browser_server.post("/api/session/reset").raise_for_status()
    browser_server.post("/api/session/load_scenario", {"name": "nominal"}).raise_for_status()
    if browser_server.get("/api/session").json()["state"] != "running":
        browser_server.post("/api/session/resume").raise_for_status()
    until(lambda: browser_server.get("/api/session").json()["state"] == "running")
    return browser_server


OpenPage = Callable[..., Page]


@pytest.fixture
def open_page(browser: Browser) -> Iterator[OpenPage]:
    """Opens pages that have telemetry, and a `scene` if asked; at the end none of them may have logged an error."""
    complaints: list[str] = []
    contexts = []

    def complain(message: ConsoleMessage) -> None:
        if message.type == "error":
            complaints.append(message.text)

    def opened(server: Server, colours: str = "dark", tolerant: bool = False, scene: bool = False) -> Page:
        context = browser.new_context(color_scheme=colours, viewport={"width": 1440, "height": 900})  # type: ignore[arg-type]
        context.set_default_timeout(PATIENCE_MS)
        contexts.append(context)
        page = context.new_page()
        if not tolerant:
            page.on("console", complain)
        page.on("pageerror", lambda error: complaints.append(str(error)))
        if not scene:  # without a graphics card it takes most of the processor
            page.route("**/scene/**", lambda route: route.fulfill(body=NO_SCENE, content_type="text/html"))
        page.goto(server.url)
        wait_for_samples(page)
        page.wait_for_selector("[data-path='tuning.controller.natural_frequency'] input")
        return page

    yield opened
    for context in contexts:
        context.close()
    assert complaints == []


def wait_for_samples(page: Page) -> None:
    """Wait until telemetry arrives and time goes on."""
    wait_until(page, "() => window.vssea !== undefined && window.vssea.store.length > 0")
    seen = page.evaluate("[window.vssea.store.epoch, window.vssea.latest('time')]")  # perhaps the end of the run before
    wait_until(page, "([epoch, t]) => window.vssea.store.epoch !== epoch || window.vssea.latest('time') > t", seen)


@pytest.fixture
def data_dir(tmp_path: Path) -> Path:
    return tmp_path / "data"
