"""The history beside the plots: one for all pages, undone by key and by click."""

import pytest
from playwright.sync_api import Page, expect

from tests.backend.server import Server, until
from tests.browser.conftest import OpenPage

BANDWIDTH = "[data-path='tuning.observer.bandwidth'] input[type=text]"

pytestmark = pytest.mark.browser


def bandwidth(server: Server) -> float:
    return float(server.get("/api/session").json()["scenario"]["tuning"]["observer"]["bandwidth"])


def change(page: Page, value: int) -> None:
    page.locator(BANDWIDTH).fill(str(value))
    page.locator(BANDWIDTH).press("Enter")
    page.locator("h1").click()


def test_one_page_takes_back_what_another_changed_and_says_whose_it_was(running: Server, open_page: OpenPage) -> None:
    one, other = open_page(running), open_page(running)
    change(one, 120)
    until(lambda: bandwidth(running) == 120.0)
    other.locator("#side-tab-history").click()
    entry = other.locator(".history-entry", has_text="100 → 120 rad/s").first
    expect(entry).to_contain_text(one.evaluate("window.vssea.session.you"))
    other.locator("h1").click()
    other.keyboard.press("Control+z")
    until(lambda: bandwidth(running) == 100.0)
    expect(entry).to_have_class("history-entry is-undone")
    expect(other.locator("#event-log")).to_contain_text("took back the change of page")
    one.keyboard.press("Control+Shift+z")
    until(lambda: bandwidth(running) == 120.0)


def test_a_named_save_point_is_returned_to_by_a_click(running: Server, open_page: OpenPage) -> None:
    page = open_page(running)
    page.locator("#side-tab-history").click()
    page.locator(".save-name").fill("good")
    page.get_by_role("button", name="Save point", exact=True).click()
    point = page.locator(".history-entry.is-save-point", has_text="good")
    expect(point).to_be_visible()
    for value in (120, 140):
        change(page, value)
        until(lambda value=value: bandwidth(running) == value)  # type: ignore[misc]
    point.get_by_role("button").click()
    until(lambda: bandwidth(running) == 100.0)
    page.get_by_role("button", name="Undo", exact=True).click()
    until(lambda: bandwidth(running) == 140.0)


def test_the_history_fits_beside_the_plots_on_a_laptop(running: Server, open_page: OpenPage) -> None:
    page = open_page(running)
    page.set_viewport_size({"width": 1366, "height": 768})
    page.locator("#side-tab-history").click()
    for number in range(40):
        running.post("/api/session/save_point", {"name": f"point {number}"}).raise_for_status()
    expect(page.locator(".history-entry", has_text="point 39")).to_be_in_viewport()
    root = "document.documentElement"
    assert page.evaluate(f"[{root}.scrollWidth <= innerWidth, {root}.scrollHeight <= innerHeight]") == [True, True]
