"""Pinned runs behind the live one, and the trigger that holds the picture."""

from itertools import pairwise

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page, expect

from tests.backend.server import Server, until
from tests.browser.conftest import OpenPage, wait_for_samples
from tests.browser.waiting import wait_until

HAS_SAMPLES = "() => window.vssea.pins.list.length === 1 && window.vssea.pins.list[0].samples.time.length > 500"
GHOSTS = """async ([seconds, period, from, to]) => {
    const { Ghosts } = await import("/app/pins/ghosts.js");
    const time = Float64Array.from({ length: Math.round(seconds * 100) + 1 }, (_, i) => 3 + i / 100);
    const run = { id: 1, seconds, excerpt: { shown: true, period_s: period, label: "" }, samples: { time, column: () => time } };
    const lines = new Ghosts({ list: [run] }, { range: [from, to] }).lines;
    return lines.map((line) => {
        const times = line.picture([from, to], 1000).time;
        return { shift: line.shift, from: times[0] + line.shift, to: times.at(-1) + line.shift };
    });
}"""

pytestmark = pytest.mark.browser


def ran_for(page: Page, seconds: float) -> None:
    wait_until(page, "seconds => window.vssea.latest('time') > seconds", seconds)


@pytest.fixture
def unpinned(running: Server, open_page: OpenPage) -> Page:
    """A page without pinned runs and trigger, showing where they will be."""
    running.post("/api/session/disarm_trigger").raise_for_status()
    page = open_page(running)
    page.locator("#side-tab-pins").click()
    while page.evaluate("window.vssea.pins.list.length"):
        page.locator(".pin-entry button").first.click()
        page.wait_for_timeout(100)
    return page


def test_a_pinned_run_survives_a_reload_and_is_renamed_hidden_and_let_go(unpinned: Page) -> None:
    page = unpinned
    ran_for(page, 2.0)
    page.locator("h1").click()
    page.keyboard.press("p")
    wait_until(page, HAS_SAMPLES)
    name = page.locator(".pin-entry .pin-name")
    name.fill("calm")
    name.press("Enter")
    expect(page.locator(".pin-figures")).to_contain_text("peak")
    page.reload()
    wait_for_samples(page)
    expect(name).to_have_value("calm")
    wait_until(page, HAS_SAMPLES)
    page.locator(".pin-entry input[type=checkbox]").click()
    wait_until(page, "() => !window.vssea.pins.list[0].excerpt.shown")
    page.get_by_role("button", name="Let go of calm").click()
    expect(page.locator(".pin-entry")).to_have_count(0)


CASES = [(10, 4, 42.3, 52.3), (10, 4, 42.3, 44.3), (5, 4, 100, 160), (10, 0.4, 20, 30), (2, 4, 50, 60)]


def test_ghosts_stand_whole_periods_later_and_meet_without_overlap(running: Server, open_page: OpenPage) -> None:
    page = open_page(running)
    for seconds, period, start, end in CASES:
        lines = sorted(page.evaluate(GHOSTS, [seconds, period, start, end]), key=lambda line: line["from"])
        assert all(abs(line["shift"] / period - round(line["shift"] / period)) < 1e-9 for line in lines)
        assert end - 1e-9 <= lines[-1]["to"] < end + period
        if seconds >= period:
            assert lines[0]["from"] <= start
            gaps = [after["from"] - before["to"] for before, after in pairwise(lines)]
            assert all(0.0 <= gap <= 0.011 for gap in gaps)
    (line,) = page.evaluate(GHOSTS, [10, None, 42.0, 52.0])
    assert (line["shift"], line["from"]) == (0, 3)  # without a period it stands where it was


def test_a_trigger_holds_what_it_captured(running: Server, unpinned: Page) -> None:
    page = unpinned
    ran_for(page, 1.0)
    page.locator("#trigger").click()
    page.get_by_label("Fires at").select_option("tuning")
    page.get_by_label("Seconds before").fill("0.5")
    page.locator("#trigger-form").get_by_role("button", name="Arm", exact=True).click()
    expect(page.locator("#trigger")).to_have_text("Trigger: armed")
    running.post("/api/session/tune", {"changes": {"observer.bandwidth": 120.0}}).raise_for_status()
    wait_until(page, "() => document.getElementById('trigger').textContent === 'Trigger: captured'")
    expect(page.locator("#plot-toolbar .readout")).to_contain_text("zoomed")
    expect(page.locator(".pin-entry")).to_contain_text("trigger, ")
    until(lambda: any(event["kind"] == "trigger" for event in running.get("/api/session/events").json()))


def test_a_trigger_that_makes_no_sense_is_refused_in_its_form(unpinned: Page) -> None:
    page = unpinned
    page.locator("#trigger").click()
    page.get_by_label("Fires at").select_option("level")
    page.get_by_label("Level", exact=True).fill("much")
    page.locator("#trigger-form").get_by_role("button", name="Arm", exact=True).click()
    expect(page.locator(".trigger-state")).to_have_text("Every box needs a number.")
    expect(page.locator("#trigger")).to_have_text("Trigger")


@pytest.mark.parametrize("colours", ["dark", "light"])
def test_nothing_beside_the_plots_hinders_people_who_use_assistive_technology(
    running: Server, open_page: OpenPage, colours: str
) -> None:
    page = open_page(running, colours)
    ran_for(page, 1.0)
    page.locator("h1").click()
    page.keyboard.press("p")
    running.post("/api/session/tune", {"changes": {"observer.bandwidth": 120.0}}).raise_for_status()
    running.post("/api/session/undo").raise_for_status()
    page.locator("#trigger").click()
    for tab in ("history", "pins"):
        page.locator(f"#side-tab-{tab}").focus()
        page.keyboard.press("Enter")
        results = Axe().run(page, context={"exclude": [["#scene iframe"]]}, options={"resultTypes": ["violations"]})
        grave = [entry for entry in results.response["violations"] if entry["impact"] in ("serious", "critical")]
        assert [(entry["id"], [node["target"] for node in entry["nodes"]]) for entry in grave] == []
