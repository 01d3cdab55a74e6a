"""The view Presets and the panel Preset in a real browser against a real server: nothing is applied or lost unasked."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx
import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Locator, Page, expect

from tests.backend.server import Server, until

expect.set_options(timeout=30_000)
pytestmark = pytest.mark.browser
OpenPage = Callable[..., Page]


@pytest.fixture
def library(running: Server) -> Server:
    """The running server with a preset of two versions, `tracking`, and one that differs by its kind, `sliding`."""
    for kind in ("presets", "actuators"):
        for line in running.get(f"/api/{kind}").json():
            ask(running, "DELETE", f"{kind}/{line['name']}").raise_for_status()
    etag = put(running, "tracking", note="as found", tags=["bench"])
    tune(running, **{"observer.bandwidth": 60.0})
    put(running, "tracking", etag)
    tune(running, **{"controller.kind": "sliding_mode", "controller.switching_gain": 7e4, "observer.bandwidth": 100.0})
    put(running, "sliding")
    running.post("/api/session/load_scenario", {"name": "nominal"}).raise_for_status()
    return running


def ask(server: Server, method: str, path: str, body: Any = None, etag: str = "*") -> httpx.Response:
    headers = {"If-Match": etag} if method in ("PATCH", "PUT") and etag else {}
    return httpx.request(method, f"{server.url}/api/{path}", json=body, headers=headers, trust_env=False, timeout=60.0)


def put(server: Server, name: str, etag: str = "", **body: Any) -> str:
    answer = ask(server, "PUT", f"presets/{name}", body, etag or ("*" if known(server, name) else ""))
    answer.raise_for_status()
    return str(answer.headers["etag"])


def known(server: Server, name: str) -> bool:
    return any(line["name"] == name for line in server.get("/api/presets").json())


def tune(server: Server, **changes: Any) -> None:
    server.post("/api/session/tune", {"changes": changes}).raise_for_status()


def live(server: Server) -> dict[str, Any]:
    return dict(server.get("/api/session").json()["scenario"]["tuning"])


def presets(page: Page, name: str = "tracking") -> Locator:
    """The detail of a preset in the view Presets."""
    page.locator("#tab-presets").click()
    page.locator(".document-line:visible", has_text=name).click()
    detail = page.locator(".detail:visible")
    expect(detail.get_by_label("Name", exact=True)).to_have_value(name)
    return detail


def test_key_5_shows_the_library_and_a_search_finds(library: Server, open_page: OpenPage) -> None:
    page = open_page(library)
    page.keyboard.press("5")
    expect(page.locator("#tab-presets")).to_have_attribute("aria-selected", "true")
    lines = page.locator(".document-line:visible")
    expect(lines).to_have_count(2)
    expect(lines.nth(1)).to_contain_text("tracking")
    page.get_by_label("Search presets").fill("bench")
    expect(lines).to_have_count(1)
    page.get_by_label("Search presets").fill("nothing like it")
    expect(page.get_by_text("None found.")).to_be_visible()


def test_applying_shows_the_difference_first_and_sends_only_what_is_chosen(
    library: Server, open_page: OpenPage
) -> None:
    page = open_page(library)
    tune(library, **{"controller.natural_frequency": 31.0})
    before = live(library)
    detail = presets(page)
    rows = detail.locator(".difference-table tbody tr")
    expect(rows).to_have_count(2)
    expect(detail.get_by_role("button", name="Apply 2 changes")).to_be_visible()
    assert live(library) == before
    rows.filter(has_text="poles").get_by_role("checkbox").uncheck()
    detail.get_by_role("button", name="Apply 1 change").click()
    expect(rows).to_have_count(1)
    assert live(library)["observer"]["bandwidth"] == 60.0
    assert live(library)["controller"]["natural_frequency"] == 31.0


def test_a_field_of_another_kind_goes_with_its_kind(library: Server, open_page: OpenPage) -> None:
    page = open_page(library)
    detail = presets(page, "sliding")
    gain = detail.locator("tr[data-path='controller.switching_gain']").get_by_role("checkbox")
    kind = detail.locator("tr[data-path='controller.kind']").get_by_role("checkbox")
    kind.uncheck()
    expect(gain).to_be_disabled()
    expect(detail.get_by_role("button", name="Apply 0 changes")).to_be_disabled()
    kind.check()
    detail.get_by_role("button", name="Apply 2 changes").click()
    expect(detail.get_by_text("The same as what runs: nothing to apply.")).to_be_visible()
    assert live(library)["controller"]["kind"] == "sliding_mode"
    assert live(library)["controller"]["switching_gain"] == 7e4


def test_a_note_and_tags_are_changed_where_they_stand(library: Server, open_page: OpenPage) -> None:
    page = open_page(library)
    detail = presets(page)
    detail.get_by_label("Note", exact=True).fill("for the heavier link")
    detail.get_by_label("Tags, with commas between them").fill("bench, heavy")
    detail.get_by_label("Tags, with commas between them").press("Enter")
    until(lambda: library.get("/api/presets/tracking").json()["tags"] == ["bench", "heavy"])
    assert library.get("/api/presets/tracking").json()["note"] == "for the heavier link"
    expect(page.locator(".document-line", has_text="tracking")).to_contain_text("#bench #heavy")
    expect(page.locator(".stale-notice:visible")).to_have_count(0)


def test_what_another_changed_meanwhile_is_shown_and_the_user_chooses(library: Server, open_page: OpenPage) -> None:
    page = open_page(library, tolerant=True)  # the browser notes an answer of 412
    detail = presets(page)
    note = detail.get_by_label("Note", exact=True)
    note.focus()
    ask(library, "PATCH", "presets/tracking", {"tags": ["theirs"]}).raise_for_status()
    expect(page.locator(".document-line", has_text="tracking")).to_contain_text("#theirs")
    note.fill("mine")
    note.press("Enter")
    notice = detail.locator(".stale-notice")
    expect(notice).to_contain_text("has changed meanwhile, it was edited: tags: theirs. Nothing was saved.")
    assert library.get("/api/presets/tracking").json()["note"] == ""
    notice.get_by_role("button", name="Save mine on top").click()
    until(lambda: library.get("/api/presets/tracking").json()["note"] == "mine")
    expect(notice).to_be_hidden()
    assert library.get("/api/presets/tracking").json()["tags"] == ["theirs"]


def test_versions_are_named_compared_and_restored(library: Server, open_page: OpenPage) -> None:
    page = open_page(library)
    detail = presets(page)
    newest = library.get("/api/presets/tracking").json()["version"]
    old = newest - 1
    detail.get_by_label(f"Name of version {old}", exact=True).fill("before the heavier link")
    detail.get_by_label(f"Name of version {old}", exact=True).press("Enter")
    until(lambda: "before the heavier link" in library.get("/api/presets/tracking").text)
    row = detail.locator(".version-table tbody tr").nth(1)
    row.get_by_role("button", name="Compare").click()
    expect(detail.get_by_label("Compared with")).to_have_value(str(old))
    expect(detail.locator("tr[data-path='observer.bandwidth']")).to_contain_text("60")
    expect(detail.get_by_role("checkbox")).to_have_count(0)
    row.get_by_role("button", name="Restore").click()
    expect(detail.locator(".detail-meta")).to_contain_text(f"version {newest + 1} of {newest + 1}")
    assert library.get("/api/presets/tracking").json()["content"]["tuning"]["observer"]["bandwidth"] == 100.0


def test_an_archived_preset_is_in_the_archive_and_comes_back(library: Server, open_page: OpenPage) -> None:
    page = open_page(library)
    detail = presets(page)
    detail.get_by_role("button", name="Archive").click()
    expect(page.locator(".document-line:visible", has_text="tracking")).to_have_count(0)
    page.get_by_role("checkbox", name="archive").check()
    page.locator(".document-line:visible", has_text="tracking").click()
    detail.get_by_role("button", name="Take out of the archive").click()
    until(lambda: known(library, "tracking"))


def test_an_import_shows_what_was_found_before_it_is_kept(library: Server, open_page: OpenPage, tmp_path: Path) -> None:
    page = open_page(library)
    page.locator("#tab-presets").click()
    file = tmp_path / "by hand.json"
    name = f"by hand {tmp_path.name}"
    file.write_text(
        json.dumps({"name": name, "tuning": {"observer": {"kind": "position", "bandwidth": 80.0, "band": 1}}})
    )
    side = page.locator("#presets-side")
    side.locator("input[type=file]:not([hidden])").first.set_input_files(file)
    found = side.locator(".import-found:visible")
    expect(found).to_contain_text(f"{name}: 1 version, new here")
    expect(found).to_contain_text("Unknown, left out: tuning.observer.band")
    expect(found).to_contain_text("tuning.controller")
    assert not known(library, name)
    side.get_by_role("button", name="Keep 1 version").click()
    expect(page.locator(".detail:visible").get_by_label("Name", exact=True)).to_have_value(name)
    assert known(library, name)
    file.write_text(json.dumps({"name": "bad", "tuning": {"observer": {"kind": "position", "bandwidth": 1e9}}}))
    side.locator("input[type=file]").first.set_input_files(file)
    expect(found).to_contain_text("tuning.observer.bandwidth, expected a number from 1 to 2000 rad/s")
    expect(side.get_by_role("button", name="Keep")).to_have_count(0)
    ask(library, "DELETE", f"presets/{name}")


def test_an_actuator_is_saved_edited_calibrated_and_loaded(library: Server, open_page: OpenPage) -> None:
    page = open_page(library)
    page.locator("#tab-presets").click()
    page.locator("[data-section=actuators]").click()
    page.get_by_label("Name to save the plant that runs under").fill("rig")
    page.get_by_label("Name to save the plant that runs under").press("Enter")
    detail = page.locator(".detail:visible")
    expect(detail.get_by_label("Name", exact=True)).to_have_value("rig")
    inertia = detail.get_by_label("link inertia", exact=True)
    inertia.fill("9000")
    inertia.press("Tab")
    expect(detail.locator(".detail-section .form-problem:visible")).to_contain_text(
        "expected a number from 0.005 to 5 kg·m²"
    )
    inertia.fill("0.25")
    inertia.press("Tab")
    detail.get_by_label("where link inertia comes from").select_option("measured")
    detail.get_by_role("button", name="Add a point").click()
    detail.get_by_label("stiffness of point 1").fill("160")
    detail.get_by_label("stiffness of point 1").press("Tab")
    detail.get_by_role("button", name="Save as version").click()
    expect(detail.locator(".calibration-verdict")).to_contain_text("fits best")
    kept = library.get("/api/actuators/rig").json()["content"]
    assert kept["actuator"]["link"]["inertia"] == 0.25
    assert kept["provenance"]["link.inertia"]["source"] == "measured"
    assert kept["calibration"][0]["stiffness"] == 160.0
    detail.get_by_role("button", name="Load this plant").click()
    until(lambda: library.get("/api/session").json()["scenario"]["actuator"]["link"]["inertia"] == 0.25)
    expect(detail.get_by_text("The same as what runs: nothing to apply.")).to_be_visible()


def test_the_panel_in_tune_asks_before_it_changes_what_runs(library: Server, open_page: OpenPage) -> None:
    page = open_page(library)
    panel = page.locator("#panel-preset")
    panel.get_by_label("Saved presets").select_option("tracking")
    panel.get_by_role("button", name="Apply").click()
    dialog = page.locator("#apply-dialog")
    expect(dialog).to_contain_text("bandwidth")
    dialog.get_by_role("button", name="Cancel").click()
    expect(dialog).to_be_hidden()
    assert live(library)["observer"]["bandwidth"] == 100.0
    panel.get_by_role("button", name="Apply").click()
    dialog.get_by_role("button", name="Apply 1 change").click()
    until(lambda: live(library)["observer"]["bandwidth"] == 60.0)
    expect(panel.get_by_label("Preset name")).to_have_value("tracking")


def test_saving_in_tune_over_what_another_has_saved_asks_and_keeps_both(library: Server, open_page: OpenPage) -> None:
    page = open_page(library, tolerant=True)
    panel = page.locator("#panel-preset")
    panel.get_by_label("Saved presets").select_option("tracking")
    panel.get_by_role("button", name="Apply").click()
    page.locator("#apply-dialog").get_by_role("button", name="Apply 1 change").click()
    expect(panel.get_by_label("Preset name")).to_have_value("tracking")
    tune(library, **{"observer.bandwidth": 77.0})
    paper = library.get("/api/scenarios/paper_fig2").json()["tuning"]
    theirs = ask(library, "PUT", "presets/tracking", {"tuning": paper}).json()["version"]
    page.keyboard.press("Control+s")
    dialog = page.locator("#stale-dialog")
    expect(dialog).to_contain_text("Preset 'tracking' has changed meanwhile")
    dialog.get_by_role("button", name="Save mine on top").click()
    until(lambda: library.get("/api/presets/tracking").json()["version"] == theirs + 1)
    assert library.get("/api/presets/tracking").json()["content"]["tuning"]["observer"]["bandwidth"] == 77.0
    assert library.get(f"/api/presets/tracking?version={theirs}").json()["content"]["tuning"] == paper


def test_stop_works_while_a_dialog_asks(library: Server, open_page: OpenPage) -> None:
    page = open_page(library)
    panel = page.locator("#panel-preset")
    panel.get_by_label("Saved presets").select_option("tracking")
    panel.get_by_role("button", name="Apply").click()
    expect(page.locator("#apply-dialog")).to_be_visible()
    page.locator("#stop").click()
    until(lambda: library.get("/api/session").json()["state"] == "stopped")


def test_stop_is_never_covered_in_presets(library: Server, open_page: OpenPage) -> None:
    page = open_page(library)
    presets(page)
    for width in (1920, 1366, 820, 420):
        page.set_viewport_size({"width": width, "height": 760})
        for section in page.locator("#presets-side .section-button").all():
            section.click()
            expect(page.locator("#stop")).to_be_in_viewport(ratio=1.0)
            assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")


@pytest.mark.parametrize("colours", ["dark", "light"])
def test_nothing_in_presets_hinders_people_who_use_assistive_technology(
    library: Server, open_page: OpenPage, colours: str
) -> None:
    ask(
        library, "PUT", "actuators/rig", {}, "*" if library.get("/api/actuators/rig").status_code == 200 else ""
    ).raise_for_status()
    page = open_page(library, colours)
    presets(page)
    for section in ("presets", "actuators"):
        page.locator(f"#presets-side [data-section={section}]").click()
        page.locator(".document-line:visible").first.click()
        expect(page.locator(".detail:visible .detail-meta")).to_contain_text("version")
        results = Axe().run(page, options={"resultTypes": ["violations"]})
        grave = [entry for entry in results.response["violations"] if entry["impact"] in ("serious", "critical")]
        assert [(entry["id"], [node["target"] for node in entry["nodes"]]) for entry in grave] == []
