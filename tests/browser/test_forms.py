"""Every form of the document can be chosen in the page: the server's document says so, and the session goes on."""

import re
from collections.abc import Callable
from typing import Any

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page, expect

from tests.backend.server import Server, until
from tests.browser.waiting import wait_until

expect.set_options(timeout=30_000)
pytestmark = pytest.mark.browser
OpenPage = Callable[..., Page]
LINK_KINDS = ("constant", "sine", "multisine", "chirp", "noise", "pulse", "pendulum", "contact")
REFERENCES = ("step", "move", "chirp", "filtered_step", "multisine", "jog", "recorded", "sine")


def in_force(server: Server, path: str) -> Any:
    here = server.get("/api/session").json()["scenario"]
    for name in path.split("."):
        here = here[int(name)] if isinstance(here, list) else here[name]
    return here


def comes_into_force(server: Server, path: str, value: Any) -> None:
    until(lambda: in_force(server, path) == value)


def choose(page: Page, server: Server, path: str, value: str) -> None:
    page.locator(f"[data-path='{path}'] [data-value='{value}']").click()
    comes_into_force(server, path, value)
    expect(page.locator(f"[data-path='{path}'] [data-value='{value}']")).to_have_attribute("aria-checked", "true")


def goes_on(page: Page) -> None:
    """Time goes on, and nothing was refused."""
    seen = page.evaluate("window.vssea.latest('time')")
    wait_until(page, "seen => window.vssea.latest('time') > seen + 0.2", seen)
    expect(page.locator("#state")).to_have_attribute("data-state", "running")
    expect(page.locator(".panel-note:visible, [data-tone=refused]:visible")).to_have_count(0)


def opened(page: Page, panel: str) -> None:
    page.locator(f"#panel-{panel} > summary").click()


def test_every_controller_and_design_runs(running: Server, open_page: OpenPage) -> None:
    page = open_page(running)
    for kind, field, values in (
        ("baseline", "design", ("lqr_plant", "poles")),
        ("state_feedback", "design", ("lqr_chain", "lqr_plant", "poles")),
        ("sliding_mode", "switch", ("tanh", "super_twisting", "sgn", "layer")),
    ):
        choose(page, running, "tuning.controller.kind", kind)
        for value in values:
            choose(page, running, f"tuning.controller.{field}", value)
        goes_on(page)


def test_a_tiny_weight_is_shown_and_edited_in_its_row(running: Server, open_page: OpenPage) -> None:
    page = open_page(running)
    choose(page, running, "tuning.controller.design", "lqr_chain")
    box = page.locator("[data-path='tuning.controller.snap_weight'] input[type=text]")
    expect(box).to_have_value("4e-11")
    box.fill("1.5e-11")
    box.press("Enter")
    comes_into_force(running, "tuning.controller.snap_weight", 1.5e-11)
    expect(page.locator("[data-path='tuning.controller.natural_frequency']")).to_have_count(0)


def test_every_observer_runs_and_rows_without_effect_are_hidden(running: Server, open_page: OpenPage) -> None:
    page = open_page(running)
    for kind, shapes in (("off", ()), ("position", ("kalman", "multiple")), ("velocity", ("butterworth", "multiple"))):
        choose(page, running, "tuning.observer.kind", kind)
        for shape in shapes:
            choose(page, running, "tuning.observer.shape", shape)
        goes_on(page)
    velocity_filter = page.locator("[data-path='tuning.observer.velocity_filter']")
    expect(velocity_filter).to_have_count(0)
    choose(page, running, "tuning.observer.velocity_source", "difference")
    expect(velocity_filter).to_be_visible()


def test_every_reference_runs(running: Server, open_page: OpenPage) -> None:
    page = open_page(running)
    for kind in REFERENCES:
        choose(page, running, "reference.kind", kind)
        goes_on(page)
    choose(page, running, "stiffness_reference.kind", "move")
    goes_on(page)
    choose(page, running, "reference.kind", "multisine")
    page.get_by_label("component frequency 2, Hz").fill("0.4")
    page.get_by_label("component frequency 2, Hz").press("Enter")
    comes_into_force(running, "reference.components.1.frequency_hz", 0.4)
    choose(page, running, "reference.kind", "recorded")
    page.get_by_label(re.compile("Samples, a line each")).fill("time, position\n0.5, 0\n2, 0.1\n3, 0.1")
    page.locator("#panel-reference").get_by_role("button", name="Apply").click()
    comes_into_force(running, "reference.positions", [0.0, 0.1, 0.1])
    goes_on(page)


def test_every_disturbance_is_added_removed_and_undone(running: Server, open_page: OpenPage) -> None:
    page = open_page(running)
    panel = page.locator("#panel-disturbance")

    def terms(side: str) -> list[str]:
        return [term["kind"] for term in in_force(running, f"disturbances.{side}")]

    for side, kinds in (("link", LINK_KINDS), ("motor", LINK_KINDS[:6]), ("stiffness_motor", LINK_KINDS[:6])):
        panel.locator(f".segmented [data-value='{side}']").click()
        for kind in kinds:
            panel.get_by_label("Kind of disturbance to add").select_option(kind)
            panel.get_by_role("button", name="Add", exact=True).click()
            until(lambda kind=kind, side=side: terms(side)[-1:] == [kind])  # type: ignore[misc]
        goes_on(page)
    panel.locator("[data-kind=pulse] .remove").click()
    until(lambda: "pulse" not in terms("stiffness_motor"))
    page.locator("h1").click()
    page.keyboard.press("Control+z")
    until(lambda: "pulse" in terms("stiffness_motor"))
    goes_on(page)


def test_constant_and_sine_need_no_click(running: Server, open_page: OpenPage) -> None:
    running.post("/api/session/set_disturbances", {"replace": {}}).raise_for_status()
    page = open_page(running)
    for kind, amount in (("constant", "torque"), ("sine", "amplitude")):
        slider = page.locator(f"[data-path='disturbances.link.{kind}.{amount}'] input[type=range]")
        slider.focus()
        slider.press("Shift+ArrowRight")
        until(lambda kind=kind: [term["kind"] for term in in_force(running, "disturbances.link")][-1:] == [kind])  # type: ignore[misc]
        expect(slider).to_be_focused()
    assert in_force(running, "disturbances.link.0.torque") == 1.0


def test_a_sequence_is_entered_runs_and_leaves_its_marks(running: Server, open_page: OpenPage) -> None:
    page = open_page(running)
    opened(page, "sequence")
    panel = page.locator("#panel-sequence")

    def enter(number: int, at: str, field: str) -> None:
        panel.get_by_role("button", name="Add a change").click()
        page.get_by_label(f"Change {number}: time, s").fill(at)
        page.get_by_label(f"Change {number}: field").fill(field)
        page.get_by_label(f"Change {number}: field").press("Enter")

    enter(1, "0.5", "Controller: kind")
    page.get_by_label("Change 1: new value").select_option("Sliding mode")
    enter(2, "1", "switching gain")
    value = page.get_by_label("Change 2: new value")
    value.fill("1e12")
    value.press("Enter")
    expect(panel.locator(".panel-note:visible").first).to_contain_text("expected a number from 0 to 1e8")
    value.fill("40000")
    value.press("Enter")
    panel.get_by_role("button", name="Apply").click()
    comes_into_force(running, "tuning.controller.kind", "sliding_mode")
    until(lambda: in_force(running, "tuning.controller").get("switching_gain") == 40_000.0)
    made = [event for event in running.get("/api/session/events").json() if event["kind"] == "sequence"]
    assert [event["time_s"] for event in made[-2:]] == [0.5, 1.0]
    expect(page.locator("#event-log")).to_contain_text("sequence")
    goes_on(page)
    panel.get_by_label(
        "Remove change 2"
    ).click()  # the draft starts from t = 0, not from what the sequence has made of it
    panel.get_by_role("button", name="Apply").click()
    until(lambda: len(in_force(running, "sequence")) == 1)
    assert page.evaluate("window.vssea.session.document.beginning.tuning.controller.kind") == "state_feedback"


def test_another_plant_than_the_controller_believes_in_restarts_the_run(running: Server, open_page: OpenPage) -> None:
    page = open_page(running)
    opened(page, "rig")
    epoch = page.evaluate("window.vssea.session.snapshot.epoch")
    box = page.locator("[data-path='actuator.link.inertia'] input[type=text]")
    box.fill("0.2")
    box.press("Enter")
    comes_into_force(running, "actuator.link.inertia", 0.2)
    assert in_force(running, "tuning.model.link_inertia") == 0.1
    wait_until(page, "epoch => window.vssea.session.snapshot.epoch > epoch", epoch)
    choose_delay = page.locator("[data-path='timing.compute_delay_samples'] [data-value='1']")
    choose_delay.click()
    comes_into_force(running, "timing.compute_delay_samples", 1)
    expect(page.locator("[data-path='tuning.observer.predict']")).to_be_visible()
    goes_on(page)


@pytest.mark.parametrize("colours", ["dark", "light"])
def test_opened_panels_hinder_nobody_who_uses_assistive_technology(
    running: Server, open_page: OpenPage, colours: str
) -> None:
    page = open_page(running, colours)
    for panel in ("schedule", "sequence", "stiffness-loop", "model", "rig"):
        opened(page, panel)
    page.get_by_role("button", name="Add a change").click()
    page.keyboard.type("Observer: bandwidth g")
    page.keyboard.press("Enter")
    choose(page, running, "reference.kind", "multisine")
    for kind in ("chirp", "multisine"):
        page.get_by_label("Kind of disturbance to add").select_option(kind)
        page.locator("#panel-disturbance").get_by_role("button", name="Add", exact=True).click()
        expect(page.locator(f"#panel-disturbance [data-kind={kind}]")).to_be_visible()
    results = Axe().run(page, context={"exclude": [["#scene iframe"]]}, options={"resultTypes": ["violations"]})
    grave = [entry for entry in results.response["violations"] if entry["impact"] in ("serious", "critical")]
    assert [(entry["id"], [node["target"] for node in entry["nodes"]]) for entry in grave] == []
