"""Margins beside the tuning, and the view Analyse, in a real browser against a real server."""

import re
from collections.abc import Callable

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page, expect

from tests.backend.server import Server, until
from tests.browser.waiting import wait_until

expect.set_options(timeout=30_000)
pytestmark = pytest.mark.browser
OpenPage = Callable[..., Page]
BANDWIDTH = "[data-path='tuning.observer.bandwidth']"
PAINTED = """() => {
    const canvas = document.querySelector('#view-analyse .map-canvas');
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    const colours = new Set();
    for (let i = 0; i < data.length; i += 4) colours.add(`${data[i]},${data[i + 1]},${data[i + 2]}`);
    return colours.size;
}"""


def analyse(page: Page) -> None:
    page.locator("#tab-analyse").click()
    expect(page.locator("#view-tune")).to_be_hidden()


def figure(page: Page, name: str) -> str:
    row = page.locator("#stability .bar-row", has=page.get_by_text(name, exact=True)).first
    return str(row.locator(".bar-figure").inner_text())


def test_the_margins_beside_the_tuning_follow_a_slider(running: Server, open_page: OpenPage) -> None:
    page = open_page(running)
    delay = page.locator("#stability .bar-row", has=page.get_by_text("torque delay", exact=True)).locator(".bar-figure")
    expect(delay).to_have_text(re.compile(r"^[\d.]+ samples$"))
    before = delay.inner_text()
    slider = page.locator(f"{BANDWIDTH} input[type=range]")
    slider.focus()
    for _ in range(3):
        slider.press("Shift+ArrowRight")
    expect(delay).not_to_have_text(before)
    assert float(delay.inner_text().split()[0]) < float(before.split()[0])
    expect(page.locator("#stability-head")).to_have_attribute("data-tone", "ample")
    expect(page.locator("#stability-body")).not_to_have_class(re.compile("is-old"))


def test_an_ill_tuning_is_warned_of_in_a_sentence_at_every_width(running: Server, open_page: OpenPage) -> None:
    page = open_page(running)
    running.post("/api/session/load_scenario", {"name": "realistic"}).raise_for_status()
    running.post("/api/session/tune", {"changes": {"observer.bandwidth": 330.0}}).raise_for_status()
    sentence = page.locator("#stability-sentence")
    expect(sentence).to_have_text(re.compile(r"^Unstable if .+\.$"))
    expect(page.locator("#stability-head")).to_have_attribute("data-tone", "warning")
    expect(page.locator("#stability-announcement")).to_have_text(sentence.inner_text())
    for width in (1366, 900, 500):
        page.set_viewport_size({"width": width, "height": 800})
        expect(sentence).to_be_in_viewport()
        expect(page.locator("#stop")).to_be_in_viewport(ratio=1.0)


def test_a_controller_without_margins_says_why(running: Server, open_page: OpenPage) -> None:
    page = open_page(running)
    changes = {"controller.kind": "sliding_mode", "controller.switch": "sgn"}
    running.post("/api/session/tune", {"changes": changes}).raise_for_status()
    expect(page.locator("#stability-sentence")).to_contain_text("no linearisation")
    expect(page.locator("#stability-body")).to_be_hidden()


def test_the_loop_is_analysed_and_follows_the_tuning(running: Server, open_page: OpenPage) -> None:
    page = open_page(running)
    page.keyboard.press("2")
    expect(page.locator("#tab-analyse")).to_have_attribute("aria-selected", "true")
    phase = page.locator(".loop-side tr", has_text="phase").locator("td").first
    expect(phase).to_have_text(re.compile(r"^[\d.]+°at \d+$"))
    expect(page.locator(".loop-charts canvas")).to_have_count(5)
    before = phase.inner_text()
    running.post("/api/session/tune", {"changes": {"observer.bandwidth": 250.0}}).raise_for_status()
    expect(phase).not_to_have_text(before)


def test_a_stability_map_is_drawn_and_read_by_the_keyboard(running: Server, open_page: OpenPage) -> None:
    page = open_page(running)
    analyse(page)
    page.locator("[data-section=map]").click()
    page.get_by_role("radio", name="30²").click()
    page.get_by_role("button", name="Compute the map").click()
    expect(page.locator(".result-caption").first).to_have_text(
        re.compile(r"stable in [1-9]\d? % of the map"), timeout=120_000
    )
    wait_until(page, f"() => ({PAINTED})() > 20")
    page.locator("#view-analyse .map-canvas").focus()
    page.keyboard.press("ArrowRight")
    expect(page.locator("#view-analyse .result-readout")).to_have_text(
        re.compile(r"true / nominal stiffness .+ · stable: decay")
    )


def test_a_map_under_way_can_be_cancelled(running: Server, open_page: OpenPage) -> None:
    page = open_page(running)
    analyse(page)
    page.locator("[data-section=map]").click()
    page.locator("#view-analyse").get_by_label("Shown").select_option("disk")
    page.get_by_role("radio", name="120²").click()
    running.post(
        "/api/tasks",
        {"kind": "margin_map", "x": {"name": "spring", "count": 400}, "y": {"name": "poles", "count": 400}},
    )
    page.get_by_role("button", name="Compute the map").click()
    tasks = page.locator(".task")
    expect(tasks.first).to_have_attribute("data-state", "queued")
    for number in (0, 1):
        tasks.nth(number).get_by_role("button", name="Cancel").click()
    for number in (0, 1):
        expect(tasks.nth(number)).to_have_attribute("data-state", "cancelled", timeout=120_000)


def test_a_task_that_is_refused_says_why(running: Server, open_page: OpenPage) -> None:
    page = open_page(running, tolerant=True)  # the browser notes an answer of 422
    analyse(page)
    page.locator("[data-section=map]").click()
    page.get_by_label("lowest value on x").fill("much")
    page.get_by_role("button", name="Compute the map").click()
    expect(page.locator("form:visible .form-problem")).to_contain_text("expected a number")
    page.get_by_label("lowest value on x").fill("9")
    page.get_by_role("button", name="Compute the map").click()
    expect(page.locator(".task").first.locator(".task-reason")).to_contain_text(
        "expected an ascending range", timeout=120_000
    )


def test_stop_works_in_analyse(running: Server, open_page: OpenPage) -> None:
    page = open_page(running)
    analyse(page)
    page.locator("[data-section=worst]").click()
    page.get_by_label("lowest additional delay").focus()
    page.keyboard.press("Escape")
    expect(page.locator("#state")).to_have_attribute("data-state", "stopped")
    until(lambda: running.get("/api/session").json()["state"] == "stopped")


def test_stop_is_never_covered_in_analyse(running: Server, open_page: OpenPage) -> None:
    page = open_page(running)
    analyse(page)
    for width in (1920, 1366, 820, 420):
        page.set_viewport_size({"width": width, "height": 760})
        for section in page.locator("#view-analyse .section-button").all():
            section.click()
            expect(page.locator("#stop")).to_be_in_viewport(ratio=1.0)
            assert (
                page.evaluate(
                    """() => {
                    const { left, top, width, height } = document.getElementById('stop').getBoundingClientRect();
                    return document.elementFromPoint(left + width / 2, top + height / 2).id;
                }"""
                )
                == "stop"
            )
            assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")


@pytest.mark.parametrize("colours", ["dark", "light"])
def test_nothing_in_analyse_hinders_people_who_use_assistive_technology(
    running: Server, open_page: OpenPage, colours: str
) -> None:
    page = open_page(running, colours)
    analyse(page)
    expect(page.locator(".loop-charts canvas")).to_have_count(5)
    for section in page.locator("#view-analyse .section-button").all():
        section.click()
        results = Axe().run(page, options={"resultTypes": ["violations"]})
        grave = [entry for entry in results.response["violations"] if entry["impact"] in ("serious", "critical")]
        assert [(entry["id"], [node["target"] for node in entry["nodes"]]) for entry in grave] == []
