"""The view Hardware in a real browser, against a real server and an emulated rig behind a CAN bus of its own."""

import importlib.resources
import re
from collections.abc import Callable, Iterator
from typing import Any

import httpx
import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Locator, Page, expect

from backend.emulator.start import EmulatorHandle, start_emulator
from tests.backend.server import Server, free_port, until
from tests.browser.waiting import wait_until

expect.set_options(timeout=30_000)
pytestmark = [pytest.mark.browser, pytest.mark.real_time]
OpenPage = Callable[..., Page]
RIG = "bench"
SILENT_RIG = "nobody home"
STEPS = 20
NEXT = {"connected": "Home", "ready": "Arm", "stopped": "Reset", "fault": "Reset"}
LATCHED = ("stopped", "fault")
HIDE = """hidden => {
    Object.defineProperty(document, 'hidden', {get: () => hidden, configurable: true});
    document.dispatchEvent(new Event('visibilitychange'));
}"""
NOTE_SENT = """() => {
    window.sent = [];
    const own = window.vssea.session.connection.command.bind(window.vssea.session.connection);
    window.vssea.session.connection.command = (name, values, limit) => {
        window.sent.push({name, values});
        return own(name, values, limit);
    };
}"""


@pytest.fixture(scope="module")
def emulator() -> Iterator[EmulatorHandle]:
    """An emulated rig that is switched on, unhomed, at 200 N m/rad."""
    handle = start_emulator()
    try:
        yield handle
    finally:
        handle.close()


@pytest.fixture(scope="module")
def rig_server(emulator: EmulatorHandle, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """A server that knows the emulator as the rig `bench`, and a rig where nobody listens."""
    text = (importlib.resources.files("backend.rigs") / "emulator.toml").read_text("utf-8")
    ports = {RIG: emulator.port, SILENT_RIG: free_port()}
    started = Server(tmp_path_factory.mktemp("rig"))
    try:
        started.wait_until_running()
        for name, port in ports.items():
            own = text.replace('name = "emulator"', f'name = "{name}"').replace("port = 29536", f"port = {port}")
            httpx.put(f"{started.url}/api/rigs/{name}", content=own, trust_env=False).raise_for_status()
        yield started
    finally:
        started.terminate()


@pytest.fixture
def rig(rig_server: Server) -> Iterator[Server]:
    """The server with its simulation running; whatever a test leaves connected is disconnected after it."""
    yield rig_server
    if rig_server.get("/api/session").json()["rig"]["connected"]:
        key = until(lambda: taken(rig_server))
        ask(rig_server, "disconnect_rig", key=key).raise_for_status()


def ask(server: Server, command: str, body: Any = None, key: str | None = None) -> httpx.Response:
    headers = {"X-VSSEA-Lease": key} if key else {}
    return httpx.post(
        f"{server.url}/api/session/{command}", json=body or {}, headers=headers, trust_env=False, timeout=60
    )


def taken(server: Server) -> str | None:
    """The key of control, once the page that had it is gone."""
    answer = ask(server, "take_control", {"expires_s": 5.0})
    return str(answer.json()["key"]) if answer.is_success else None


def state(server: Server) -> str:
    return str(server.get("/api/session").json()["state"])


def panel(page: Page, name: str) -> Locator:
    return page.get_by_role("region", name=name, exact=True)


def expect_state(page: Page, *states: str) -> None:
    expect(page.locator("#state")).to_have_attribute("data-state", re.compile(f"^({'|'.join(states)})$"))


def hardware(server: Server, open_page: OpenPage, colours: str = "dark", tolerant: bool = False) -> Page:
    page = open_page(server, colours, tolerant)
    page.keyboard.press("6")
    expect(page.locator("#tab-hardware")).to_have_attribute("aria-selected", "true")
    return page


def connected(server: Server, open_page: OpenPage, colours: str = "dark", tolerant: bool = False) -> Page:
    page = hardware(server, open_page, colours, tolerant)
    page.locator(f"[data-rig-name={RIG}]").click()
    panel(page, "Rig").get_by_role("button", name="Connect", exact=True).click()
    expect_state(page, "connected", "ready")
    return page


def next_step(page: Page, name: str) -> None:
    button = page.locator("#next-step .start")
    expect(button).to_have_text(name)
    expect(button).to_be_enabled()
    button.click()


def armed(server: Server, open_page: OpenPage, tolerant: bool = False) -> Page:
    """A page in control of the armed rig. What a busy machine stops on the way there is reset, and tried again."""
    page = connected(server, open_page, tolerant=tolerant)
    page.keyboard.press("f")  # pictures that stand still leave their time to the emulated drives
    for _ in range(STEPS):
        was = now(page)
        if was == "armed":
            return page
        if was in NEXT:
            in_control(page)
            next_step(page, NEXT[was])
        if was in LATCHED:
            page.locator("#reset-dialog button[value=reset]").click()
        wait_until(page, "was => window.vssea.session.snapshot.state !== was", was)
    raise AssertionError(f"the rig cannot be armed: {page.locator('#state').inner_text()}")


def in_control(page: Page) -> None:
    if page.locator("#control").inner_text() == "Nobody is in control":
        next_step(page, "Take control")
        expect(page.locator("#control")).to_have_text("You are in control")


def now(page: Page) -> str:
    return str(page.evaluate("window.vssea.session.snapshot.state"))


def latest(page: Page, channel: str) -> float:
    return float(page.evaluate("name => window.vssea.latest(name)", channel))


def wait_for_time(page: Page, seconds: float) -> None:
    wait_until(page, "t => window.vssea.latest('time') > t", latest(page, "time") + seconds)


def jogs(page: Page) -> list[dict[str, float]]:
    return list(page.evaluate("window.sent.filter(({name}) => name === 'jog').map(({values}) => values)"))


def test_without_a_rig_the_next_step_is_to_connect_and_nothing_can_move(rig: Server, open_page: OpenPage) -> None:
    page = hardware(rig, open_page)
    expect(page.locator("#next-step [aria-current]")).to_contain_text("Connect")
    expect(page.locator("#rig")).to_have_text("simulated rig")
    expect(page.locator("#control")).to_be_hidden()
    for button in page.locator(".jog-button, .go-to button").all():
        expect(button).to_be_disabled()


def test_a_rig_that_does_not_answer_is_refused_in_words_and_the_simulation_is_back(
    rig: Server, open_page: OpenPage
) -> None:
    page = hardware(rig, open_page)
    page.locator(f"[data-rig-name='{SILENT_RIG}']").click()
    panel(page, "Rig").get_by_role("button", name="Connect", exact=True).click()
    expect(panel(page, "Rig").locator("> .rig-note")).to_contain_text("simulation is back")
    expect(page.locator("#rig")).to_have_text("simulated rig")
    until(lambda: state(rig) in ("running", "ready"))


def test_an_operator_homes_arms_jogs_goes_tunes_and_stops(rig: Server, open_page: OpenPage) -> None:
    page = armed(rig, open_page)
    expect(page.locator("#rig")).to_have_text(f"EMULATED{RIG}")
    expect(page.locator("#control")).to_have_text("You are in control")
    expect(page.locator("#pause")).to_be_hidden()
    expect(panel(page, "Homing")).to_contain_text("Span of the end stops")

    began = latest(page, "link_position")
    page.locator("[data-way=right]").hover()
    page.mouse.down()
    wait_until(page, "from => window.vssea.latest('link_position') > from + 0.1", began)
    page.mouse.up()
    expect_state(page, "armed")

    page.get_by_label("Position to go to").fill("-0.2")
    page.get_by_label("Speed at most").fill("0.5")
    page.get_by_role("button", name="Go", exact=True).click()
    wait_until(page, "() => Math.abs(window.vssea.latest('link_position') + 0.2) < 0.01")
    expect_state(page, "armed")

    page.keyboard.press("1")
    bandwidth = page.locator("[data-path='tuning.stiffness_loop.bandwidth']")
    page.locator("#panel-stiffness-loop summary").click()
    box = bandwidth.locator("input[type=text]")
    before = rig.get("/api/session").json()["tuning_id"]
    box.fill("60")
    box.press("Enter")
    wait_until(page, "id => window.vssea.session.snapshot.tuning_id > id", before)
    expect_state(page, "armed")

    page.keyboard.press("Escape")
    expect_state(page, "stopped")
    page.locator("#tab-hardware").click()
    next_step(page, "Reset")
    page.locator("#reset-dialog button[value=reset]").click()
    expect_state(page, "ready")
    panel(page, "Rig").get_by_role("button", name="Disconnect").click()
    expect(page.locator("#rig")).to_have_text("simulated rig")


def test_the_stiffness_changes_while_the_link_moves(rig: Server, open_page: OpenPage) -> None:
    page = armed(rig, open_page)
    ask_stiffness(page, 200.0)
    wait_until(page, "() => Math.abs(window.vssea.latest('stiffness') - 200) < 5")
    page.locator(".jog-pad").focus()
    away = "ArrowRight" if latest(page, "link_position") < 0 else "ArrowLeft"
    page.keyboard.down(away)
    expect_state(page, "running")
    page.keyboard.down("ArrowUp")
    wait_until(page, "() => window.vssea.latest('stiffness') > 240")
    expect_state(page, "running")
    page.keyboard.up("ArrowUp")
    page.keyboard.up(away)
    expect_state(page, "armed")
    held = latest(page, "stiffness")
    wait_for_time(page, 0.5)
    assert latest(page, "stiffness") == pytest.approx(held, rel=0.1)


def ask_stiffness(page: Page, stiffness: float) -> None:
    box = page.get_by_label("Stiffness asked for, N·m/rad")
    box.fill(f"{stiffness:g}")
    box.press("Enter")


@pytest.mark.parametrize("letting_go", ["leaving the button", "another window", "focus elsewhere", "STOP"])
def test_whatever_takes_the_hand_away_lets_go_of_a_jog_once(rig: Server, open_page: OpenPage, letting_go: str) -> None:
    page = armed(rig, open_page)
    page.evaluate(NOTE_SENT)
    way = "right" if latest(page, "link_position") < 0 else "left"
    if letting_go == "leaving the button":
        page.locator(f"[data-way={way}]").hover()
        page.mouse.down()
    else:
        page.locator(".jog-pad").focus()
        page.keyboard.down(f"Arrow{way.capitalize()}")
    expect_state(page, "running")
    match letting_go:
        case "leaving the button":
            page.mouse.move(5, 400)
        case "another window":
            page.evaluate("window.dispatchEvent(new Event('blur'))")
        case "focus elsewhere":
            page.locator("#tab-hardware").focus()
        case "STOP":
            page.keyboard.press("Escape")
    expect_state(page, "stopped" if letting_go == "STOP" else "armed")
    wait_for_time(page, 0.5)
    sent = jogs(page)
    assert len(sent) >= 2
    assert all(each["link"] != 0 for each in sent[:-1])
    assert sent[-1] == {"link": 0, "stiffness": 0}


def test_a_hidden_tab_stops_the_jog_and_then_the_rig(rig: Server, open_page: OpenPage) -> None:
    page = armed(rig, open_page)
    page.evaluate(NOTE_SENT)
    page.locator(".jog-pad").focus()
    page.keyboard.down("ArrowRight" if latest(page, "link_position") < 0 else "ArrowLeft")
    expect_state(page, "running")
    page.evaluate(HIDE, True)
    assert jogs(page)[-1] == {"link": 0, "stiffness": 0}
    said = len(page.evaluate("window.sent"))
    until(lambda: state(rig) == "stopped")
    assert len(page.evaluate("window.sent")) == said
    page.evaluate(HIDE, False)
    expect(page.locator("#control")).to_have_text("Nobody is in control")
    assert state(rig) == "stopped"


def test_a_second_page_is_refused_says_why_and_can_ask_for_control(rig: Server, open_page: OpenPage) -> None:
    one = armed(rig, open_page)
    other = open_page(rig)
    name = other.evaluate("window.vssea.session.you")
    expect(other.locator("#control-strip")).to_contain_text("is in control")
    expect(other.locator("[data-path='tuning.controller.natural_frequency'] input[type=text]")).to_be_disabled()
    other.keyboard.press("6")
    for button in other.locator(".jog-button").all():
        expect(button).to_be_disabled()
    refused = other.evaluate(
        "window.vssea.session.command('go_to', {position: 0.0, speed: 0.1}).catch(r => r.problem.status)"
    )
    assert refused == 403
    next_step(other, "Ask for control")
    expect(one.locator("#control")).to_have_text(f"{name} asks for control")
    one.locator("#control").click()
    one.get_by_role("button", name=f"Hand over to {name}").click()
    expect(other.locator("#control")).to_have_text("You are in control")
    expect(one.locator("#control")).to_contain_text(f"{name} is in control")
    expect_state(other, "armed")
    wait_for_time(other, 1.0)
    expect_state(other, "armed")
    expect(other.locator("[data-way=left]")).to_be_enabled()


def test_a_tuning_is_tried_in_simulation_before_it_reaches_the_rig(rig: Server, open_page: OpenPage) -> None:
    page = connected(rig, open_page)
    page.get_by_role("switch").check()
    before = rig.get("/api/session").json()["tuning_id"]
    page.locator("#tab-tune").click()
    box = page.locator("[data-path='tuning.observer.bandwidth'] input[type=text]")
    was = float(box.input_value())
    box.fill(f"{0.9 * was:g}")
    box.press("Enter")
    result = page.locator("#parameters .try-result")
    expect(result).to_contain_text("Not on the rig yet: observer bandwidth")
    apply = result.get_by_role("button", name="Apply to the rig")
    expect(apply).to_be_enabled()
    expect(result.locator("dt").first).to_have_text("peak error")
    assert rig.get("/api/session").json()["tuning_id"] == before
    box.blur()
    expect(box).to_have_value(f"{was:g}")
    apply.click()
    expect(result).to_be_hidden()
    expect(box).to_have_value(f"{0.9 * was:g}")
    assert rig.get("/api/session").json()["tuning_id"] > before


def test_a_page_that_closes_loses_control_and_the_rig_stops(rig: Server, open_page: OpenPage) -> None:
    page = armed(rig, open_page)
    page.close()
    until(lambda: state(rig) == "stopped")


def test_a_fault_is_told_with_its_number_and_kept_as_an_excerpt(
    rig: Server, emulator: EmulatorHandle, open_page: OpenPage
) -> None:
    page = armed(rig, open_page, tolerant=True)  # this server draws no scene: the replay's pose is refused
    emulator.control({"do": "fault", "name": "drive_fault", "node": 1, "value": 0x2310})
    try:
        expect_state(page, "fault")
        fault = page.locator(".fault-line").first
        expect(fault).to_contain_text("motor drive")
        expect(page.locator("#next-step")).to_have_attribute("data-tone", "fault")
        kept = panel(page, "Recorded at faults").get_by_role("button").first
        expect(kept).to_be_enabled()
        kept.click()
        expect(page.locator("#tab-recordings")).to_have_attribute("aria-selected", "true")
        expect(page.locator("#view-recordings .recording-title")).not_to_be_empty()
    finally:
        emulator.control({"do": "clear"})
    page.locator("#tab-hardware").click()
    in_control(page)
    next_step(page, "Reset")
    page.locator("#reset-dialog button[value=reset]").click()
    expect_state(page, "ready", "connected")


@pytest.mark.parametrize("colours", ["dark", "light"])
def test_nothing_hinders_people_who_use_assistive_technology(rig: Server, open_page: OpenPage, colours: str) -> None:
    page = connected(rig, open_page, colours)
    expect(page.locator("#control")).to_have_text("You are in control")
    page.locator("#control").click()
    results = Axe().run(page, options={"resultTypes": ["violations"]})
    grave = [entry for entry in results.response["violations"] if entry["impact"] in ("serious", "critical")]
    assert [(entry["id"], [node["target"] for node in entry["nodes"]]) for entry in grave] == []


@pytest.mark.parametrize("size", [(1366, 768), (1920, 1080), (820, 1100)])
def test_the_view_fits_without_scrolling_the_page(rig: Server, open_page: OpenPage, size: tuple[int, int]) -> None:
    page = hardware(rig, open_page)
    page.set_viewport_size({"width": size[0], "height": size[1]})
    expect(page.locator(".rig-plots canvas").first).to_be_visible()
    root = "document.documentElement"
    assert page.evaluate(f"[{root}.scrollWidth - innerWidth, {root}.scrollHeight - innerHeight]") == [0, 0]
    stop = page.locator("#stop").bounding_box()
    assert stop is not None
    assert stop["x"] + stop["width"] == pytest.approx(size[0], abs=1)
