"""The view Batch in a real browser against a real server: defined, watched, read, a run of it looked at and loaded."""

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import httpx
import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Locator, Page, Route, expect

from tests.backend.server import Server, until
from tests.browser.waiting import wait_until

expect.set_options(timeout=30_000)
pytestmark = pytest.mark.browser
OpenPage = Callable[..., Page]
COMPILING_LIMIT_S = 400.0  # a new clone compiles the lanes first
LINK, BANDWIDTH, SOFTEST = "actuator.link.inertia", "tuning.observer.bandwidth", "actuator.stiffness.softest"
COLOURS = """() => {
    const canvas = document.querySelector('.batch-canvas');
    if (!canvas.width) return 0;
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    const colours = new Set();
    for (let i = 0; i < data.length; i += 4) colours.add(`${data[i]},${data[i + 1]},${data[i + 2]}`);
    return colours.size;
}"""


def grid(path: str, low: float, high: float, count: int) -> dict[str, Any]:
    return {"kind": "grid", "path": path, "low": low, "high": high, "count": count}


def nominal(server: Server, **fields: Any) -> dict[str, Any]:
    return dict(server.get("/api/scenarios/nominal").json()) | {"duration_s": 1.0} | fields


def computed(server: Server, name: str, scenario: dict[str, Any], *vary: dict[str, Any]) -> str:
    """Start a batch over REST and return its id, once it is done."""
    document = {"name": name, "scenario": scenario, "vary": list(vary)}
    answer = server.post("/api/batches", document)
    answer.raise_for_status()
    batch = str(answer.json()["id"])
    until(lambda: server.get(f"/api/batches/{batch}").json()["state"] == "done", COMPILING_LIMIT_S)
    return batch


@pytest.fixture(scope="module")
def mapped(browser_server: Server) -> str:
    """A batch over two fields, all of whose runs are done."""
    scenario = nominal(browser_server)
    return computed(
        browser_server, "wrong inertia", scenario, grid(LINK, 0.05, 0.2, 6), grid(BANDWIDTH, 40.0, 120.0, 5)
    )


@pytest.fixture(scope="module")
def partly_refused(browser_server: Server) -> str:
    """A batch whose last runs ask for a stiffness outside of the end stops."""
    scenario = nominal(browser_server)
    return computed(browser_server, "soft stop", scenario, grid(SOFTEST, 20.0, 300.0, 8), grid(LINK, 0.05, 0.2, 2))


@pytest.fixture(scope="module")
def partly_ended(browser_server: Server) -> str:
    """A batch with heavy links, which a motor without limits drives out of the spring's law."""
    scenario = browser_server.get("/api/scenarios/paper_fig2").json() | {"duration_s": 2.0}
    scenario["actuator"]["motor"] |= {"peak_torque": 5000.0, "continuous_torque": 5000.0}
    return computed(browser_server, "no limits", scenario, grid(LINK, 0.1, 4.0, 16))


def batch_view(page: Page, batch: str = "") -> None:
    page.keyboard.press("3")
    expect(page.locator("#tab-batch")).to_have_attribute("aria-selected", "true")
    if batch:
        page.locator(f".batch[data-id='{batch}'] .batch-title").click()
        expect(page.locator(".batch-results")).to_be_visible()


def vary(page: Page, words: str, path: str) -> None:
    fold = page.get_by_role("button", name="New batch")
    if fold.get_attribute("aria-expanded") == "false":
        fold.click()
    page.get_by_label("Field to vary").fill(words)
    page.locator(f".field-options [data-path='{path}']").click()
    expect(page.locator(f".variation[data-path='{path}']")).to_be_visible()


def kind(page: Page, name: str) -> None:
    page.locator(f".picture-choice [data-value='{name}']").click()


def test_two_chosen_fields_are_estimated_started_watched_and_drawn(
    running: Server, open_page: OpenPage, mapped: str
) -> None:
    page = open_page(running)
    batch_view(page)
    expect(page.get_by_role("button", name="Start")).to_be_disabled()
    vary(page, "link inertia", LINK)
    vary(page, "observer bandwidth", BANDWIDTH)
    for field in page.locator(".variation").all():
        field.get_by_label("number of values").fill("4")
    expect(page.locator(".estimate dd").first).to_have_text("16")
    expect(page.locator(".estimate dd").nth(1)).to_have_text(re.compile(r" s$"))
    page.get_by_label("Name of the batch").fill("my map")
    page.get_by_role("button", name="Start").click()
    own = page.locator(".batch", has_text="my map")
    expect(own.locator(".batch-title")).to_be_focused()
    expect(own.locator(".task-state")).to_have_text("done", timeout=60_000)
    expect(page.locator(".batch-head")).to_contain_text("16 runs: 16 done.")
    wait_until(page, f"() => ({COLOURS})() > 20")
    asked = running.get("/api/batches?limit=1").json()["batches"][0]
    document = running.get(f"/api/batches/{asked['id']}/document").json()
    assert [(each["path"], each["count"]) for each in document["vary"]] == [(LINK, 4), (BANDWIDTH, 4)]
    assert document["scenario"]["duration_s"] == 10.0


def test_what_cannot_be_is_said_while_it_is_typed(running: Server, open_page: OpenPage) -> None:
    page = open_page(running, tolerant=True)  # the browser itself logs the refusal
    batch_view(page)
    vary(page, "link inertia", LINK)
    page.get_by_label("link inertia, lowest").fill("one")
    expect(page.locator(".estimate .form-problem")).to_contain_text("expected a number")
    page.get_by_role("button", name="Start").click()
    expect(page.get_by_label("link inertia, lowest")).to_be_focused()
    expect(page.locator(".batch-form .form-problem:visible")).to_have_count(1)
    page.get_by_label("link inertia, lowest").fill("-1")
    expect(page.locator(".estimate .form-problem")).to_contain_text("log grid needs positive ends")
    page.locator(".variation").get_by_role("radio", name="List").click()
    page.get_by_label("link inertia, values").fill("0.1; 0,2; 0.3")
    expect(page.locator(".estimate .form-problem")).to_be_hidden()
    expect(page.locator(".estimate dd").first).to_have_text("3")


def test_random_fields_are_drawn_together(running: Server, open_page: OpenPage) -> None:
    page = open_page(running)
    batch_view(page)
    vary(page, "link inertia", LINK)
    vary(page, "observer bandwidth", BANDWIDTH)
    for field in page.locator(".variation").all():
        field.get_by_role("radio", name="Random").click()
    page.get_by_label("number of random draws").fill("250")
    expect(page.locator(".estimate dd").first).to_have_text("250")


def test_a_factor_says_what_the_range_is_of_the_present_value(running: Server, open_page: OpenPage) -> None:
    page = open_page(running)
    batch_view(page)
    vary(page, "link inertia", LINK)
    lowest = page.get_by_label("link inertia, lowest")
    expect(lowest).to_have_value("0.05")
    page.get_by_label("as factors of the present value").check()
    expect(lowest).to_have_value("0.5")
    page.get_by_label("as factors of the present value").uncheck()
    expect(lowest).to_have_value("0.05")


def test_a_run_is_read_by_keys_shown_and_loaded_into_the_live_session(
    running: Server, open_page: OpenPage, mapped: str
) -> None:
    page = open_page(running)
    batch_view(page, mapped)
    wait_until(page, f"() => ({COLOURS})() > 20")
    canvas = page.locator(".batch-canvas")
    canvas.focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowUp")
    read = page.locator("#batch-main .result-readout")
    expect(read).to_contain_text("mrad")
    run = int(re.search(r"run (\d+)", read.inner_text())[1])  # type: ignore[index]
    page.keyboard.press("Enter")
    expect(page.locator("#batch-run h2").first).to_have_text(f"Run {run}")
    expect(page.locator("#batch-run")).to_have_attribute("data-simulated", str(run))
    expect(page.locator("#batch-run canvas")).to_have_count(3)
    expect(page.locator("#batch-run")).to_contain_text("RMS error")
    known = running.get(f"/api/batches/{mapped}/runs/{run}").json()
    page.get_by_role("button", name="Load into live session").click()
    expect(page.locator("#batch-run .run-words")).to_have_text("It runs live now, from t = 0.")
    loaded = running.get("/api/session").json()["scenario"]
    assert loaded["actuator"]["link"]["inertia"] == known["values"][LINK]
    assert loaded["tuning"]["observer"]["bandwidth"] == known["values"][BANDWIDTH]


def test_a_clicked_run_is_kept_as_a_preset(running: Server, open_page: OpenPage, mapped: str) -> None:
    page = open_page(running)
    batch_view(page, mapped)
    wait_until(page, f"() => ({COLOURS})() > 20")
    area = page.locator(".batch-canvas").bounding_box()
    assert area is not None
    page.locator(".batch-canvas").click(position={"x": 0.5 * area["width"], "y": 0.5 * area["height"]})
    name = page.get_by_label("Name of the preset")
    expect(name).to_be_enabled()
    name.fill("of a batch")
    page.get_by_role("button", name="Keep as preset").click()
    expect(page.locator("#batch-run .run-words")).to_contain_text("Kept as preset of a batch")
    run = page.locator("#batch-run h2").first.inner_text().split()[1]
    values = running.get(f"/api/batches/{mapped}/runs/{run}").json()["values"]
    content = running.get("/api/presets/of%20a%20batch").json()["content"]
    assert content["tuning"]["observer"]["bandwidth"] == values[BANDWIDTH]


def test_every_picture_is_drawn_with_any_figure(running: Server, open_page: OpenPage, mapped: str) -> None:
    page = open_page(running)
    batch_view(page, mapped)
    for name in ("map", "scatter", "histogram"):
        kind(page, name)
        canvas = page.locator(".batch-canvas")
        expect(canvas).to_have_attribute("aria-label", re.compile("RMS error"))
        wait_until(page, f"() => ({COLOURS})() > 3")
    page.get_by_label("Figure").select_option("peak_torque")
    expect(canvas).to_have_attribute("aria-label", re.compile(r"peak torque \[N·m\]"))


def test_refused_runs_are_counted_and_listed_with_the_reason(
    running: Server, open_page: OpenPage, partly_refused: str
) -> None:
    page = open_page(running)
    batch_view(page, partly_refused)
    counts = running.get(f"/api/batches/{partly_refused}").json()["counts"]
    assert counts["refused"] > 0
    expect(page.locator(".batch-head")).to_contain_text(f"{counts['refused']} refused")
    kind(page, "refused")
    expect(page.locator(".unwell tbody tr")).to_have_count(counts["refused"])
    expect(page.locator(".unwell .why").first).to_contain_text("the end stops")
    page.locator(".unwell tbody button").first.click()
    expect(page.locator("#batch-run .run-state")).to_contain_text("refused")
    expect(page.get_by_role("button", name="Load into live session")).to_be_disabled()


def test_runs_that_ended_early_are_marked_and_say_why(running: Server, open_page: OpenPage, partly_ended: str) -> None:
    page = open_page(running)
    batch_view(page, partly_ended)
    ended = running.get(f"/api/batches/{partly_ended}").json()["counts"]["ended"]
    assert 0 < ended < 16
    expect(page.locator(".batch-head")).to_contain_text(f"{ended} ended early")
    expect(page.locator(".picture-choice [data-value=scatter]")).to_have_attribute("aria-checked", "true")
    wait_until(page, f"() => ({COLOURS})() > 3")
    page.locator(".batch-canvas").focus()
    readout = page.locator("#batch-main .result-readout")
    for _ in range(16):
        page.keyboard.press("ArrowRight")
        if "ended early" in readout.inner_text():
            break
    expect(readout).to_contain_text("ended early")
    page.keyboard.press("Enter")
    expect(page.locator("#batch-run .run-state")).to_contain_text("ended early: stopped at t =")
    run = page.locator("#batch-run h2").first.inner_text().split()[1]
    expect(page.locator("#batch-run")).to_have_attribute("data-simulated", run)


def test_the_page_knows_the_values_of_a_batch_before_it_runs(running: Server, open_page: OpenPage) -> None:
    """Of every kind of variation, as the server computes them: a cell for each, from the first run on."""
    scenario = nominal(running)
    seeds = grid("seed", 0, 10, 4)
    ratios = grid(LINK, 0.5, 2.0, 7) | {"spacing": "log", "factor": True}
    listed = {"kind": "list", "path": BANDWIDTH, "values": [80.0, 40.0, 120.0]}
    batch = computed(running, "of every kind", scenario, seeds, ratios, listed)
    document = running.get(f"/api/batches/{batch}/document").json()
    found = running.get(f"/api/batches/{batch}/results?limit=84&columns=seed,{LINK},{BANDWIDTH}").json()
    page = open_page(running)
    sizes = page.evaluate(
        """async ([document, rows]) => {
            const { variedValues } = await import('/app/batch/varied_values.js');
            const { cellScale } = await import('/app/batch/cell_scales.js');
            const known = [...variedValues(document, (path) => path === 'seed').values()];
            const size = (values, varied) => cellScale(values, { varied, options: null, isLogarithmic: null }).size;
            return known.flatMap((varied, i) => rows.map((row) => size([row[i]], varied)));
        }""",
        [document, found["rows"]],
    )
    assert sizes == [4] * 84 + [7] * 84 + [3] * 84


def test_a_batch_under_way_is_cancelled_and_deleted(running: Server, open_page: OpenPage, mapped: str) -> None:
    page = open_page(running)
    batch_view(page)
    scenario = running.get("/api/scenarios/nominal").json()
    long = {"name": "long one", "scenario": scenario, "vary": [grid(LINK, 0.05, 0.2, 90_000)]}
    running.post("/api/batches", long).raise_for_status()
    own = page.locator(".batch", has_text="long one")
    own.get_by_role("button", name="Cancel").click()
    expect(own.locator(".task-state")).to_have_text("cancelled")
    own.get_by_role("button", name="Delete").click()
    page.locator(".ask-dialog").get_by_role("button", name="Delete").click()
    expect(own).to_have_count(0)
    expect(page.locator(".batch-title:focus")).to_have_count(1)


def cancelled(server: Server, name: str, runs: int) -> str:
    """A batch that was cancelled while it waited, so that none of its runs is computed."""
    scenario = nominal(server)
    before = {"name": f"before {name}", "scenario": scenario, "vary": [grid(LINK, 0.05, 0.2, 90_000)]}
    own = {"name": name, "scenario": scenario, "vary": [grid(LINK, 0.05, 0.2, runs)]}
    first, batch = (str(server.post("/api/batches", document).json()["id"]) for document in (before, own))
    server.post(f"/api/batches/{batch}/cancel").raise_for_status()
    server.post(f"/api/batches/{first}/cancel").raise_for_status()
    httpx.delete(f"{server.url}/api/batches/{first}", trust_env=False).raise_for_status()
    assert server.get(f"/api/batches/{batch}").json()["state"] == "cancelled"
    return batch


def is_whole(part: Locator) -> bool:
    """Whether all words of a part of the page can be seen."""
    return bool(part.evaluate("(own) => own.scrollWidth <= own.clientWidth && own.scrollHeight <= own.clientHeight"))


def test_a_batch_that_failed_says_why_and_resumed_it_gets_all_its_rows(running: Server, open_page: OpenPage) -> None:
    batch = cancelled(running, "once more", 12)
    page = open_page(running)
    batch_view(page, batch)
    own, head = page.locator(f".batch[data-id='{batch}']"), page.locator(".batch-head")
    expect(page.locator("#batch-main .result-overlay")).to_contain_text("it has no results. Resume computes them.")
    document = running.errors.parent / "batches" / batch / "batch.json"
    away = document.rename(document.with_suffix(".away"))  # a disk that is not there for a while
    own.locator(".batch-title").focus()
    page.keyboard.press("Tab")
    expect(page.locator(":focus")).to_have_text("Resume")
    page.keyboard.press("Enter")
    expect(own.locator(".task-state")).to_have_text("failed")
    expect(own.locator(":focus")).to_have_count(1)
    told = running.get(f"/api/batches/{batch}").json()["reason"]
    for reason in (own.locator(".batch-reason"), head.locator(".batch-reason")):
        expect(reason).to_have_text(re.compile(f"^{re.escape(told)}\\.?$", re.IGNORECASE))
        for width in (1366, 820, 420):
            page.set_viewport_size({"width": width, "height": 768})
            assert is_whole(reason), width
    away.rename(document)
    head.get_by_role("button", name="Resume").click()
    expect(head.locator(".result-caption")).to_have_text("12 runs: 12 done.")
    expect(own.locator(".task-state")).to_have_text("done")
    for part in (head, own):
        expect(part.get_by_role("button", name="Resume")).to_be_hidden()
        expect(part.locator(".batch-reason")).to_be_hidden()
    wait_until(page, f"() => ({COLOURS})() > 3")
    assert running.get(f"/api/batches/{batch}/results").json()["total"] == 12


def test_a_batch_that_cannot_be_resumed_stays_as_the_server_tells_it(running: Server, open_page: OpenPage) -> None:
    batch = cancelled(running, "refused", 12)
    page = open_page(running, tolerant=True)  # the browser itself logs the refusal
    problem = {"detail": "16 batches are waiting; cancel one."}
    page.route(f"**/api/batches/{batch}/resume", lambda route: route.fulfill(status=429, json=problem))
    batch_view(page, batch)
    own, head = page.locator(f".batch[data-id='{batch}']"), page.locator(".batch-head")
    head.get_by_role("button", name="Resume").click()
    expect(head.locator(".form-problem")).to_have_text(problem["detail"])
    own.get_by_role("button", name="Resume").click()
    expect(page.locator(".batch-list-panel > .form-problem")).to_have_text(problem["detail"])
    expect(own.locator(".task-state")).to_have_text("cancelled")
    expect(own.get_by_role("button", name="Resume")).to_be_focused()


def test_a_warning_of_the_estimate_is_shown_and_start_stays_possible(running: Server, open_page: OpenPage) -> None:
    page = open_page(running)
    batch_view(page)
    vary(page, "softest", SOFTEST)
    softest = page.locator(".variation")
    for name, value in (("lowest", "290"), ("highest", "300"), ("number of values", "100")):
        softest.get_by_label(name).fill(value)
    estimate = page.get_by_role("status", name="Estimate")
    expect(estimate.locator(".form-problem")).to_have_text("None of the 64 runs looked at can start.")
    expect(estimate.locator("li")).to_have_text([re.compile("^Run .*the end stops")] * 3)
    expect(estimate.locator("dd").first).to_have_text("100")
    page.get_by_role("button", name="Start").click()
    expect(page.locator(".batch-head")).to_contain_text("100 runs: 0 done, 100 refused.")


@contextmanager
def altered(server: Server, page: Page, batch: str, rows: int, **facts: Any) -> Iterator[None]:
    """Let a page see a batch with other facts, and only the first rows of its results."""
    told = server.get(f"/api/batches/{batch}").json() | facts
    page.route(f"**/api/batches/{batch}", lambda route: route.fulfill(json=told))
    page.route("**/api/batches?*", lambda route: route.fulfill(json={"total": 1, "batches": [told]}))

    def few(route: Route) -> None:
        found = route.fetch().json()
        route.fulfill(json=found | {"total": rows, "rows": found["rows"][:rows]})

    page.route(f"**/api/batches/{batch}/results?*", few)
    yield
    page.unroute_all(behavior="ignoreErrors")


def test_a_batch_without_a_result_says_that_it_prepares_and_for_how_long(
    running: Server, open_page: OpenPage, mapped: str
) -> None:
    page = open_page(running)
    nothing = {"done": 0, "runs": 30, "parts_done": 0, "parts": 1, "share": 0.0}
    with altered(running, page, mapped, 0, state="running", progress=nothing, rate=None, seconds=7.2, ended_at=None):
        batch_view(page, mapped)
        expect(page.locator(".batch-state")).to_have_text("preparing · 7 s")
        expect(page.locator(".batch .task-state")).to_have_text("preparing")
        for bar in (page.locator(".batch progress"), page.locator(".batch-head progress")):
            expect(bar).to_be_visible()
            assert bar.get_attribute("value") is None
        expect(page.locator("#batch-main .result-overlay")).to_contain_text("the first part is under way")
        expect(page.locator("#batch-main .result-overlay")).to_contain_text("compiled")


AXES = """() => {
    const canvas = document.querySelector('.batch-canvas');
    const { width, height } = canvas;
    const context = canvas.getContext('2d');
    const strips = [[0, 0, 50, height], [0, height - 44, 0.8 * width, 44]];
    return strips.map((strip) => Array.from(context.getImageData(...strip).data).join()).join();
}"""


IS_DRAWN_ABOVE = """() => {
    const canvas = document.querySelector('.batch-canvas');
    return canvas.getContext('2d').getImageData(0.5 * canvas.width, 0.2 * canvas.height, 1, 1).data[3] > 0;
}"""


def test_the_axes_of_a_map_stay_as_they_are_while_results_come_in(
    running: Server, open_page: OpenPage, mapped: str
) -> None:
    page = open_page(running)
    batch_view(page, mapped)
    wait_until(page, f"() => ({COLOURS})() > 20")
    whole = page.evaluate(AXES)
    assert page.evaluate(IS_DRAWN_ABOVE)
    page.evaluate("location.hash = '#batch'")
    expect(page.locator(".batch-results")).to_be_hidden()
    with altered(running, page, mapped, 7):
        page.locator(f".batch[data-id='{mapped}'] .batch-title").click()
        wait_until(page, f"() => ({COLOURS})() > 3")
        assert page.evaluate(AXES) == whole
        assert not page.evaluate(IS_DRAWN_ABOVE), "more than the first runs are drawn"


def test_no_legend_of_a_run_is_cut(running: Server, open_page: OpenPage, mapped: str) -> None:
    page = open_page(running)
    batch_view(page, mapped)
    wait_until(page, f"() => ({COLOURS})() > 20")
    page.locator(".batch-canvas").focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Enter")
    expect(page.locator("#batch-run")).to_have_attribute("data-simulated", re.compile(r"\d+"))
    legends = page.locator("#batch-run .legend")
    expect(legends).to_have_count(3)
    for width in (1920, 1366, 1280, 1100, 820, 420):
        page.set_viewport_size({"width": width, "height": 768})
        for legend in legends.all():
            assert legend.evaluate("({ scrollWidth, clientWidth }) => scrollWidth <= clientWidth"), width


def test_the_list_and_start_stay_in_sight_however_long_the_form_is(
    running: Server, open_page: OpenPage, mapped: str
) -> None:
    page = open_page(running)
    batch_view(page)
    for words, path in (
        ("link inertia", LINK),
        ("observer bandwidth", BANDWIDTH),
        ("softest", SOFTEST),
        ("controller kind", "tuning.controller.kind"),
    ):
        vary(page, words, path)
    for width, height in ((1366, 768), (820, 1180), (1920, 1080)):
        page.set_viewport_size({"width": width, "height": height})
        expect(page.get_by_role("button", name="Start")).to_be_in_viewport(ratio=1.0)
        expect(page.locator(".batch-title").first).to_be_in_viewport(ratio=1.0)
        assert page.evaluate(
            """() => {
                const edges = (words) => document.querySelector(words).getBoundingClientRect();
                return edges('.batch-form .start').bottom <= edges('.batch-list-panel').top;
            }"""
        )
    page.locator(f".batch[data-id='{mapped}'] .batch-title").click()
    fold = page.get_by_role("button", name="New batch")
    expect(fold).to_have_attribute("aria-expanded", "false")
    expect(fold).to_contain_text("4 fields")
    expect(page.locator(".batch-title[aria-current]")).to_be_in_viewport(ratio=1.0)
    fold.click()
    expect(page.locator(".variation")).to_have_count(4)


def test_the_list_is_one_stop_of_the_tab_key_and_arrow_keys_move_in_it(
    running: Server, open_page: OpenPage, mapped: str, partly_refused: str
) -> None:
    page = open_page(running)
    batch_view(page, mapped)
    titles = page.locator(".batch-title")
    assert titles.count() > 1
    page.get_by_role("button", name="New batch").focus()
    page.keyboard.press("Tab")
    expect(page.locator(f".batch[data-id='{mapped}'] .batch-title")).to_be_focused()
    page.keyboard.press("End")
    expect(titles.last).to_be_focused()
    page.keyboard.press("ArrowUp")
    expect(titles.nth(titles.count() - 2)).to_be_focused()
    for button in page.locator(".batch").nth(titles.count() - 2).locator(".quiet:visible").all():
        page.keyboard.press("Tab")
        expect(button).to_be_focused()
    page.keyboard.press("Tab")
    expect(page.locator(".batch-list :focus")).to_have_count(0)
    expect(page.locator("#batch-main :focus")).to_have_count(1)


def test_results_that_cannot_be_fetched_are_told_and_fetched_again(
    running: Server, open_page: OpenPage, mapped: str
) -> None:
    page = open_page(running, tolerant=True)  # the browser itself logs the failure
    problem = {"detail": "The disk does not answer. Try again."}
    page.route("**/results?*", lambda route: route.fulfill(status=500, json=problem))
    batch_view(page, mapped)
    expect(page.locator(".batch-results > .form-problem")).to_have_text(problem["detail"])
    expect(page.locator("#batch-main .result-overlay")).to_be_hidden()
    page.unroute("**/results?*")
    page.keyboard.press("1")
    page.keyboard.press("3")
    wait_until(page, f"() => ({COLOURS})() > 20")
    expect(page.locator(".batch-results > .form-problem")).to_be_hidden()


def test_an_address_without_a_batch_says_so(running: Server, open_page: OpenPage) -> None:
    page = open_page(running, tolerant=True)  # the browser itself logs the refusal
    page.evaluate("location.hash = '#batch/nosuch'")
    expect(page.locator("#batch-main .result-overlay")).to_contain_text("There is no batch 'nosuch'")


def test_stop_is_never_covered_in_the_batch_view(running: Server, open_page: OpenPage, mapped: str) -> None:
    page = open_page(running)
    batch_view(page, mapped)
    vary(page, "observer bandwidth", BANDWIDTH)
    stop = page.locator("#stop")
    on_top = """(stop) => {
        const { left, top, width, height } = stop.getBoundingClientRect();
        return [[0.1, 0.1], [0.5, 0.5], [0.9, 0.9]].every(([u, v]) =>
            document.elementFromPoint(left + u * width, top + v * height) === stop);
    }"""
    for width in (420, 820, 1366, 1920):
        page.set_viewport_size({"width": width, "height": 800})
        page.get_by_label("Field to vary").focus()
        expect(stop).to_be_in_viewport(ratio=1.0)
        assert stop.evaluate(on_top)
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    page.keyboard.press("Escape")
    expect(page.locator("#state-word")).to_have_text("Stopped")


@pytest.mark.parametrize("colours", ["dark", "light"])
def test_nothing_in_the_batch_view_hinders_people_who_use_assistive_technology(
    running: Server, open_page: OpenPage, partly_refused: str, colours: str
) -> None:
    page = open_page(running, colours)
    batch_view(page, partly_refused)
    vary(page, "link inertia", LINK)
    vary(page, "controller kind", "tuning.controller.kind")
    expect(page.locator(".estimate.is-old")).to_have_count(0)
    kind(page, "refused")
    page.locator(".unwell tbody button").first.click()
    for name in ("refused", "map", "scatter", "histogram"):
        kind(page, name)
        page.get_by_label("Field to vary").focus()
        results = Axe().run(page, options={"resultTypes": ["violations"]})
        grave = [entry for entry in results.response["violations"] if entry["impact"] in ("serious", "critical")]
        assert [(entry["id"], [node["target"] for node in entry["nodes"]]) for entry in grave] == []
