"""The Recordings view in a real browser, against a real server that records."""

import re
import struct
from collections.abc import Callable
from json import loads
from typing import Any

import numpy as np
import pytest
from axe_playwright_python.sync_playwright import Axe
from numpy.typing import NDArray
from playwright.sync_api import Locator, Page, expect

from tests.backend.server import Server, until
from tests.browser.waiting import wait_until

expect.set_options(timeout=30_000)
pytestmark = pytest.mark.browser
OpenPage = Callable[..., Page]
SHOWN = "#view-recordings"
ROWS = f"{SHOWN} .recordings tbody tr"
PLOT = f"{SHOWN} #chart-error .u-over"


def recordings(server: Server) -> list[dict[str, Any]]:
    listed: list[dict[str, Any]] = server.get("/api/recordings").json()["recordings"]
    return listed


def being_written(server: Server) -> str | None:
    recording: str | None = server.get("/api/recordings").json()["recorder"]["recording"]
    return recording


def finished(server: Server, seconds: float = 4.0) -> str:
    """Record some seconds of the nominal scenario with a change in them; return the recording's id once it is summarised."""
    before = being_written(server)
    server.post("/api/session/load_scenario", {"name": "nominal"}).raise_for_status()
    recording = until(lambda: (now := being_written(server)) != before and now, 60.0)
    until(lambda: server.get("/api/session").json()["time_s"] > seconds / 2)
    server.post("/api/session/tune", {"changes": {"controller.natural_frequency": 24.0}}).raise_for_status()
    until(lambda: server.get("/api/session").json()["time_s"] > seconds)
    server.post("/api/session/load_scenario", {"name": "nominal"}).raise_for_status()
    until(lambda: [each for each in recordings(server) if each["id"] == recording and each["summary"]], 60.0)
    return str(recording)


@pytest.fixture(scope="module")
def recorded(browser_server: Server) -> tuple[str, str]:
    """Two recordings, the older one first, with a tuning change in each."""
    return finished(browser_server), finished(browser_server)


def samples(
    server: Server, recording: str, channel: str, from_s: float, to_s: float
) -> tuple[NDArray[Any], NDArray[Any]]:
    """Times and values of a channel as the server has them."""
    query = f"channels={channel}&from_s={from_s}&to_s={to_s}&points=20000"
    answer = server.get(f"/api/recordings/{recording}/samples?{query}").content
    (length,) = struct.unpack_from("<I", answer)
    rows = loads(answer[4 : 4 + length])["samples"]
    time = np.frombuffer(answer, "<f8", rows, 4 + length)
    return time, np.frombuffer(answer, "<f4", rows, 4 + length + 8 * rows)


def opened(page: Page, recording: str) -> None:
    page.evaluate("id => { location.hash = `#recordings/${id}`; }", recording)
    expect(page.locator(f"{SHOWN} .recording-title")).not_to_be_empty()
    expect(page.locator(PLOT)).to_be_visible()
    wait_until(page, "() => window.vssea.recordings.page.source.picture([0, 1e9], 500).time.length > 100")


def row(page: Page, recording: str) -> Locator:
    return page.locator(f"{ROWS}[data-id='{recording}']")


def point(page: Page, share: float) -> None:
    """Click the chart of the error at a share of its width."""
    box = page.locator(PLOT).bounding_box()
    assert box is not None
    page.mouse.click(box["x"] + share * box["width"], box["y"] + box["height"] / 2)


def drag(page: Page, begin: float, end: float) -> None:
    """Zoom into the chart of the error, from one share of its width to another."""
    box = page.locator(PLOT).bounding_box()
    assert box is not None
    y = box["y"] + box["height"] / 2
    page.mouse.move(box["x"] + begin * box["width"], y)
    page.mouse.down()
    page.mouse.move(box["x"] + end * box["width"], y, steps=5)
    page.mouse.up()


def test_a_run_is_in_the_list_while_it_is_recorded(running: Server, open_page: OpenPage) -> None:
    page = open_page(running)
    page.keyboard.press("4")
    newest = page.locator(ROWS).first
    expect(newest.locator(".recording-state")).to_have_text("recording…")
    size = newest.locator(".row-length small")
    before = size.inner_text()
    expect(size).not_to_have_text(before)
    newest.locator("th").click()
    expect(page.locator(f"{SHOWN} .recording-head .recording-state")).to_have_text("recording…")
    end = page.evaluate("window.vssea.recordings.page.replay.extent[1]")
    wait_until(page, "end => window.vssea.recordings.page.replay.extent[1] > end", end)


def test_differences_between_the_cursors_are_those_of_the_samples(
    running: Server, open_page: OpenPage, recorded: tuple[str, str]
) -> None:
    page = open_page(running)
    opened(page, recorded[0])
    page.keyboard.press("c")
    point(page, 0.3)
    point(page, 0.7)
    wait_until(page, "() => window.vssea.recordings.page.stack.cursors.b !== null")
    near = "Math.max(...['a', 'b'].map((name) => Math.abs(window.vssea.recordings.page.stack.cursors[name].time * 1000 % 1)))"
    wait_until(page, f"() => Math.min({near}, 1 - {near}) < 1e-6")  # the very samples have come
    a, b = page.evaluate("['a', 'b'].map((name) => window.vssea.recordings.page.stack.cursors[name].time)")
    found = page.evaluate("window.vssea.recordings.page.stack.cursors.difference('link_position')")
    time, values = samples(running, recorded[0], "link_position", a - 0.01, b + 0.01)
    expected = values[np.abs(time - b).argmin()] - values[np.abs(time - a).argmin()]
    assert found == pytest.approx(float(expected), abs=1e-7)
    expect(page.locator(f"{SHOWN} .plot-toolbar .readout")).to_contain_text(re.compile(rf"Δt {b - a:.3f} s"))


def test_zooming_in_fetches_every_sample(running: Server, open_page: OpenPage, recorded: tuple[str, str]) -> None:
    page = open_page(running)
    page.set_viewport_size({"width": 1366, "height": 768})
    opened(page, recorded[0])
    drag(page, 0.4, 0.5)
    shown = "window.vssea.recordings.page.stack.timeWindow"
    wait_until(page, f"() => {shown}.isHeld && {shown}.picture.isExact")
    # Ends between two samples: on one, it would be a matter of rounding whether it is inside.
    first, last = page.evaluate(f"{shown}.range")
    low, high = round(first, 3) + 0.0005, round(last, 3) - 0.0005
    time, values = samples(running, recorded[0], "motor_torque", low, high)
    own = page.evaluate(
        f"""([low, high]) => {{
            const {{ picture }} = {shown};
            const torque = picture.column('motor_torque');
            const inside = Array.from(picture.time.keys()).filter((i) => picture.time[i] >= low && picture.time[i] <= high);
            return inside.map((i) => [picture.time[i], torque[i]]);
        }}""",
        [low, high],
    )
    assert len(own) == len(time) > 100
    assert np.allclose([each[0] for each in own], time)
    assert np.allclose([each[1] for each in own], values)
    page.locator(PLOT).dblclick()
    wait_until(page, f"() => !{shown}.isHeld")


def test_an_overlay_is_aligned_at_an_event(running: Server, open_page: OpenPage, recorded: tuple[str, str]) -> None:
    page = open_page(running)
    opened(page, recorded[0])
    compare = page.locator("[aria-label=Compare]")
    compare.get_by_label("Lay another recording over this one").select_option(recorded[1])
    expect(page.locator(f"{SHOWN} .run-key")).to_have_count(1)
    expect(compare.locator(".overlay-words")).not_to_have_text("Its tuning is being compared.")
    compare.get_by_label("Align at").select_option("tuning 1")
    changes = [
        next(
            event["time_s"]
            for event in running.get(f"/api/recordings/{each}").json()["events"]
            if event["kind"] == "tuning"
        )
        for each in recorded
    ]
    shift = page.evaluate("window.vssea.recordings.page.comparison.overlays[0].shift")
    assert shift == pytest.approx(changes[0] - changes[1], abs=1e-9)
    box = compare.get_by_label("Shift by hand, s")
    box.fill("0.5")
    box.press("Enter")
    wait_until(
        page, "shift => Math.abs(window.vssea.recordings.page.comparison.overlays[0].shift - shift - 0.5) < 1e-9", shift
    )
    compare.get_by_label("Lay another recording over this one").select_option("live")
    expect(page.locator(f"{SHOWN} .run-key")).to_have_count(2)


def test_a_star_protects_and_only_a_confirmed_delete_deletes(running: Server, open_page: OpenPage) -> None:
    recording = finished(running, 1.0)
    page = open_page(running, tolerant=True)  # the browser notes an answer of 409
    page.keyboard.press("4")
    row(page, recording).hover()
    star = row(page, recording).locator(".star")
    star.click()
    expect(star).to_have_attribute("aria-pressed", "true")
    row(page, recording).get_by_role("button", name="Delete").click()
    page.locator(".ask-dialog").get_by_role("button", name="Delete").click()
    expect(page.locator(f"{SHOWN} .form-problem:visible")).to_contain_text("starred")
    expect(row(page, recording)).to_be_visible()
    star.click()
    expect(star).to_have_attribute("aria-pressed", "false")
    row(page, recording).get_by_role("button", name="Delete").click()
    page.locator(".ask-dialog").get_by_role("button", name="Cancel").click()
    expect(row(page, recording)).to_be_visible()
    row(page, recording).get_by_role("button", name="Delete").click()
    page.locator(".ask-dialog").get_by_role("button", name="Delete").click()
    expect(row(page, recording)).to_have_count(0)
    assert running.get(f"/api/recordings/{recording}").status_code == 404


def test_a_note_and_the_open_recording_survive_a_reload(
    running: Server, open_page: OpenPage, recorded: tuple[str, str]
) -> None:
    page = open_page(running)
    opened(page, recorded[0])
    page.locator(f"{SHOWN} textarea").fill("heavier link, 2nd try")
    page.locator(f"{SHOWN} textarea").blur()
    until(lambda: running.get(f"/api/recordings/{recorded[0]}").json()["note"] == "heavier link, 2nd try")
    page.reload()
    expect(page.locator(f"{SHOWN} textarea")).to_have_value("heavier link, 2nd try")
    page.keyboard.press("1")
    page.keyboard.press("4")
    expect(page.locator(f"{SHOWN} textarea")).to_be_visible()
    page.locator(".back").click()
    page.get_by_role("searchbox", name="Search").fill("heavier 2nd")
    expect(page.locator(ROWS)).to_have_count(1)
    expect(row(page, recorded[0]).locator(".recording-note")).to_have_text("heavier link, 2nd try")


def test_space_plays_the_recording_and_leaves_the_session_running(
    running: Server, open_page: OpenPage, recorded: tuple[str, str]
) -> None:
    page = open_page(running)
    opened(page, recorded[0])
    page.keyboard.press(" ")
    wait_until(page, "() => window.vssea.recordings.page.replay.position > 0.3")
    page.keyboard.press(" ")
    stands = page.evaluate("window.vssea.recordings.page.replay.position")
    page.evaluate("() => new Promise(requestAnimationFrame)")
    assert page.evaluate("window.vssea.recordings.page.replay.position") == stands
    expect(page.locator("#state")).to_have_attribute("data-state", "running")
    assert running.get("/api/session").json()["state"] == "running"
    page.keyboard.press("Escape")
    expect(page.locator("#state")).to_have_attribute("data-state", "stopped")


def test_the_list_is_walked_by_the_arrows_and_enter_opens(
    running: Server, open_page: OpenPage, recorded: tuple[str, str]
) -> None:
    page = open_page(running)
    page.keyboard.press("4")
    expect(row(page, recorded[0])).to_be_visible()
    upper, lower = (str(page.locator(ROWS).nth(place).get_attribute("data-id")) for place in (1, 2))
    row(page, upper).focus()
    page.keyboard.press("ArrowDown")
    expect(row(page, lower)).to_be_focused()
    page.keyboard.press(" ")
    expect(row(page, lower).locator("input")).to_be_checked()
    page.keyboard.press("ArrowUp")
    page.keyboard.press("Enter")
    wait_until(page, "id => location.hash.includes(id)", upper)
    expect(page.locator(f"{SHOWN} .run-key")).to_have_count(1)
    expect(page.locator("#state")).to_have_attribute("data-state", "running")


def test_the_same_scenario_simulated_leaves_no_residual(
    running: Server, open_page: OpenPage, recorded: tuple[str, str]
) -> None:
    page = open_page(running)
    opened(page, recorded[0])
    page.get_by_role("button", name="Simulate the same scenario").click()
    expect(page.locator("[aria-label=Simulation] .form-hint")).to_contain_text(
        "the same, sample by sample", timeout=120_000
    )
    expect(page.locator(f"{SHOWN} #chart-residual")).to_be_visible()
    residual = "window.vssea.recordings.page.source.picture([0, 1e9], 500).column('residual link_position')"
    wait_until(page, f"() => Array.from({residual}).some((value) => value === 0)")
    assert page.evaluate(f"Array.from({residual}).every((value) => value === 0 || Number.isNaN(value))")


def test_spectra_are_those_of_the_shown_span(running: Server, open_page: OpenPage, recorded: tuple[str, str]) -> None:
    page = open_page(running)
    opened(page, recorded[0])
    page.get_by_role("button", name="Spectra").click()
    charts = page.locator(f"{SHOWN} .spectra .frequency-chart")
    expect(charts).to_have_count(2, timeout=120_000)  # the worker's first one loads scipy
    key = charts.first.locator(".frequency-key")
    expect(key).to_contain_text(re.compile(r"RMS [\d.]+ mrad"))
    before = key.inner_text()
    page.get_by_role("button", name="Spectra").click()
    drag(page, 0.02, 0.4)
    page.get_by_role("button", name="Spectra").click()
    expect(key).not_to_have_text(before)


def test_what_is_shown_of_a_recording_becomes_the_reference(
    running: Server, open_page: OpenPage, recorded: tuple[str, str]
) -> None:
    page = open_page(running)
    opened(page, recorded[0])
    page.get_by_role("button", name="Use as reference").click()
    until(lambda: running.get("/api/session").json()["scenario"]["reference"]["kind"] == "recorded")
    page.get_by_role("button", name="Load its scenario").click()
    until(lambda: running.get("/api/session").json()["scenario"]["reference"]["kind"] == "sine")


def test_a_log_of_a_rig_is_imported_with_its_headings_told(running: Server, open_page: OpenPage) -> None:
    lines = ["t [s],q1 [deg],theta_ref"] + [f"{0.001 * n:.3f},{10 * n / 500:.4f},0.1" for n in range(1000)]
    page = open_page(running, tolerant=True)  # the browser notes an answer of 422 before the headings are told
    page.keyboard.press("4")
    log = {"name": "bench.csv", "mimeType": "text/csv", "buffer": "\n".join(lines).encode()}
    page.locator("input[accept*=csv]").set_input_files(log)  # type: ignore[arg-type]
    dialog = page.locator(".import-dialog")
    dialog.get_by_label("q1 [deg] is").select_option("link_position")
    dialog.get_by_label("factor of q1 [deg]", exact=True).select_option(label="° → rad")
    dialog.get_by_label("theta_ref is").select_option("reference")
    dialog.get_by_label("factor of theta_ref", exact=True).select_option(label="as it is")
    expect(dialog.get_by_role("status").first).to_contain_text("1000 samples")
    dialog.get_by_role("button", name="Import").click()
    expect(page.locator(f"{SHOWN} .recording-title")).to_have_text(re.compile("^bench"))
    imported = page.evaluate("window.vssea.recordings.page.source.run.id")
    _, values = samples(running, imported, "link_position", 0.5, 0.5)
    assert values == pytest.approx([np.radians(10.0)], abs=1e-6)
    expect(page.locator(f"{SHOWN} .chart")).to_have_count(2)  # position and error: all else was not recorded


def test_stop_is_never_covered_in_recordings(running: Server, open_page: OpenPage, recorded: tuple[str, str]) -> None:
    page = open_page(running)
    for width in (1920, 1366, 820, 420):
        page.set_viewport_size({"width": width, "height": 768})
        for place in ("#recordings", f"#recordings/{recorded[0]}"):
            page.evaluate("place => { location.hash = place; }", place)
            expect(page.locator(f"{SHOWN} > :visible")).to_have_count(1)
            expect(page.locator("#stop")).to_be_in_viewport(ratio=1.0)
            middle = (
                "() => { const { left, top, width, height } = document.getElementById('stop').getBoundingClientRect(); "
            )
            assert (
                page.evaluate(middle + "return document.elementFromPoint(left + width / 2, top + height / 2).id; }")
                == "stop"
            )
            assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
            assert width < 800 or page.evaluate("document.documentElement.scrollHeight <= innerHeight")


@pytest.mark.parametrize("colours", ["dark", "light"])
def test_nothing_in_recordings_hinders_people_who_use_assistive_technology(
    running: Server, open_page: OpenPage, recorded: tuple[str, str], colours: str
) -> None:
    page = open_page(running, colours)
    page.keyboard.press("4")
    expect(row(page, recorded[0])).to_be_visible()
    assert violations(page) == []
    opened(page, recorded[0])
    page.get_by_label("Lay another recording over this one").select_option(recorded[1])
    expect(page.locator(f"{SHOWN} .run-key")).to_have_count(1)
    assert violations(page) == []
    page.get_by_role("button", name="Spectra").click()
    expect(page.locator(f"{SHOWN} .frequency-key").first).to_be_visible()
    assert violations(page) == []


def violations(page: Page) -> list[Any]:
    exclude = {"exclude": [["#scene iframe"], [".replay-scene iframe"]]}
    results = Axe().run(page, context=exclude, options={"resultTypes": ["violations"]})
    return [(entry["id"], [node["target"] for node in entry["nodes"]]) for entry in results.response["violations"]]
