"""The Tune view in a real browser, against a real server."""

import io
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from axe_playwright_python.sync_playwright import Axe
from numpy.typing import NDArray
from PIL import Image
from playwright.sync_api import Page, expect

from tests.backend.server import Server
from tests.browser.waiting import wait_until

expect.set_options(timeout=30_000)
pytestmark = pytest.mark.browser
OpenPage = Callable[..., Page]
FREQUENCY = "[data-path='tuning.controller.natural_frequency']"
TORQUE_OFF = "window.vssea.latest('motor_torque') === 0"
STILL_TORQUE_OFF = f"""async () => {{
    const begun = window.vssea.latest('time');
    while (window.vssea.latest('time') < begun + 0.3) {{
        if (!({TORQUE_OFF})) return false;
        await new Promise(requestAnimationFrame);
    }}
    return true;
}}"""


def tuning_id(page: Page) -> int:
    return int(page.evaluate("window.vssea.session.snapshot.tuning_id"))


def in_force(server: Server) -> float:
    return float(server.get("/api/session").json()["scenario"]["tuning"]["controller"]["natural_frequency"])


def test_telemetry_flows_without_a_gap(running: Server, open_page: OpenPage) -> None:
    page = open_page(running)
    wait_until(page, "() => window.vssea.store.length > 2000")
    assert page.evaluate("window.vssea.store.lostSamples") == 0
    expect(page.locator("#state")).to_have_attribute("data-state", "running")


def test_a_slider_changes_the_running_loop(running: Server, open_page: OpenPage) -> None:
    page = open_page(running)
    before, was = tuning_id(page), in_force(running)
    slider = page.locator(f"{FREQUENCY} input[type=range]")
    slider.focus()
    for _ in range(3):
        slider.press("Shift+ArrowRight")
    wait_until(page, "id => window.vssea.session.snapshot.tuning_id > id", before)
    expect(page.locator(f"{FREQUENCY} input[type=text]")).not_to_have_value(f"{was:g}")
    assert in_force(running) > was
    expect(page.locator("#event-log")).to_contain_text("rad/s")


def test_dragging_with_the_mouse_changes_the_torque(running: Server, open_page: OpenPage) -> None:
    # A step meets the law at once: its first torque is proportional to the fourth power of the pole.
    running.post("/api/session/set_disturbances", {"replace": {}}).raise_for_status()
    running.post("/api/session/set_reference", {"replace": {"kind": "step", "target": 0.02, "dwell_s": 1.0}})
    page = open_page(running)
    peak = "Math.max(...Array.from(window.vssea.store.column('motor_torque')).slice(-1500).map(Math.abs))"
    wait_until(page, "() => window.vssea.store.length > 0")
    stepping_from = page.evaluate("window.vssea.latest('time')")
    wait_until(page, "t => window.vssea.latest('time') > t + 2.5", stepping_from)  # the window then holds whole steps
    before, was = tuning_id(page), page.evaluate(peak)
    box = page.locator(f"{FREQUENCY} input[type=range]").bounding_box()
    assert box is not None
    y = box["y"] + box["height"] / 2
    page.mouse.move(box["x"] + box["width"] / 2, y)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] * 0.2, y, steps=5)
    page.mouse.up()
    wait_until(page, "id => window.vssea.session.snapshot.tuning_id > id", before)
    changed_at = page.evaluate("window.vssea.latest('time')")
    wait_until(page, "t => window.vssea.latest('time') > t", changed_at + 2.5)
    assert in_force(running) < 20.0
    assert page.evaluate(peak) < 0.7 * was


def test_a_refused_value_is_explained_in_its_row_and_the_old_tuning_runs(running: Server, open_page: OpenPage) -> None:
    page = open_page(running)
    before = tuning_id(page)
    box = page.locator(f"{FREQUENCY} input[type=text]")
    box.fill("1e6")
    box.press("Enter")
    note = page.locator(f"{FREQUENCY} .row-note")
    expect(note).to_be_visible()
    expect(note).to_contain_text(re.compile(r"refused: expected a number from .+ rad/s"))
    assert (tuning_id(page), in_force(running)) == (before, 20.0)
    seen = page.evaluate("window.vssea.latest('time')")
    wait_until(page, "seen => window.vssea.latest('time') > seen", seen)
    box.blur()
    expect(box).to_have_value("20")


def picture(page: Page) -> NDArray[np.float64]:
    """Brightness of the scene, pixel by pixel, 0 to 255."""
    return np.asarray(Image.open(io.BytesIO(page.locator("#scene iframe").screenshot())).convert("L"), float)


def test_the_scene_is_drawn_and_moves(running: Server, open_page: OpenPage) -> None:
    page = open_page(running, scene=True)
    page.frame_locator("#scene iframe").locator("canvas").first.wait_for()
    looks = 60
    first = picture(page)
    while first.std() < 3.0:  # nothing on the page says that WebGL has drawn
        assert (looks := looks - 1), "the scene stays a uniform colour"
        page.wait_for_timeout(500)
        first = picture(page)
    while np.abs(picture(page) - first).max() < 20.0:
        assert (looks := looks - 1), "the scene stands still"
        page.wait_for_timeout(250)


def test_stop_by_key_on_one_page_stops_the_other(running: Server, open_page: OpenPage) -> None:
    one, other = open_page(running), open_page(running)
    wait_until(one, "() => Math.abs(window.vssea.latest('motor_torque')) > 0.05")
    box = other.locator(f"{FREQUENCY} input[type=text]")
    box.focus()
    box.press("Escape")
    expect(one.locator("#state")).to_have_attribute("data-state", "stopped")
    expect(one.locator("#state-sentence")).to_contain_text("Reset")
    assert one.evaluate(STILL_TORQUE_OFF)


def test_only_a_confirmed_reset_leaves_a_stop(running: Server, open_page: OpenPage) -> None:
    page = open_page(running)
    page.locator("#stop").click()
    state = page.locator("#state")
    expect(state).to_have_attribute("data-state", "stopped")
    expect(page.locator("#pause")).to_be_disabled()
    page.locator("#reset").click()
    page.locator("#reset-dialog button[value=cancel]").click()
    expect(page.locator("#reset-dialog")).to_be_hidden()
    expect(state).to_have_attribute("data-state", "stopped")
    page.locator("#reset").click()
    page.locator("#reset-dialog button[value=reset]").click()
    expect(state).to_have_attribute("data-state", "ready")
    page.locator("#pause").click()
    expect(state).to_have_attribute("data-state", "running")


def test_a_page_says_when_the_server_is_gone_and_recovers(open_page: OpenPage, data_dir: Path) -> None:
    server = Server(data_dir).wait_until_running()
    again = None
    try:
        page = open_page(server, tolerant=True)
        server.kill()
        expect(page.locator("#connection-banner")).to_be_visible()
        expect(page.locator("#state")).to_have_attribute("data-state", "lost")
        for control in ("#pause", "#reset", "#pace", f"{FREQUENCY} input[type=range]"):
            expect(page.locator(control)).to_be_disabled()
        expect(page.locator("#stop")).to_be_enabled()
        again = Server(data_dir, port=server.port).wait_until_running()
        expect(page.locator("#connection-banner")).to_be_hidden(timeout=60_000)
        expect(page.locator("#state")).to_have_attribute("data-state", "running")
        seen = page.evaluate("window.vssea.latest('time')")
        wait_until(page, "seen => window.vssea.latest('time') > seen", seen)
        expect(page.locator(f"{FREQUENCY} input[type=range]")).to_be_enabled()
    finally:
        server.kill()
        if again is not None:
            again.terminate()


@pytest.mark.parametrize("colours", ["dark", "light"])
def test_nothing_hinders_people_who_use_assistive_technology(
    running: Server, open_page: OpenPage, colours: str
) -> None:
    page = open_page(running, colours)
    results = Axe().run(page, context={"exclude": [["#scene iframe"]]}, options={"resultTypes": ["violations"]})
    grave = [entry for entry in results.response["violations"] if entry["impact"] in ("serious", "critical")]
    assert [(entry["id"], [node["target"] for node in entry["nodes"]]) for entry in grave] == []
