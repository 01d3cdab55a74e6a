"""Long tasks over a real server: progress, results, cancelling, and what is refused."""

import math
from collections.abc import Iterator
from typing import Any

import httpx
import numpy as np
import pytest

from tests.backend.live_page import LivePage
from tests.backend.server import Server, until
from tests.backend.test_api_errors import problem_of

PATIENCE_S = 180.0  # kernels may have to be compiled first
ENDED = {"done", "refused", "failed", "cancelled"}
X = {"name": "spring", "count": 9, "low": 0.5, "high": 2.0}
Y = {"name": "link_inertia", "count": 7, "low": 0.4, "high": 2.5}
LONG = {
    "kind": "margin_map", "x": {"name": "spring", "count": 400}, "y": {"name": "link_inertia", "count": 400},
}  # fmt: skip


@pytest.fixture
def tasks(session: httpx.Client) -> Iterator[httpx.Client]:
    """The client; afterwards nothing is left that waits or runs."""
    yield session
    for task in session.get("/api/tasks").json():
        session.delete(f"/api/tasks/{task['id']}").raise_for_status()
    until(lambda: all(task["state"] in ENDED for task in session.get("/api/tasks").json()), PATIENCE_S)


def ask(http: httpx.Client, **body: Any) -> int:
    answer = http.post("/api/tasks", json=body)
    assert answer.status_code == 202, answer.text
    assert answer.json()["state"] in ("queued", "running")
    return int(answer.json()["id"])


def task(http: httpx.Client, number: int) -> dict[str, Any]:
    return dict(http.get(f"/api/tasks/{number}").json())


def ended(http: httpx.Client, number: int) -> dict[str, Any]:
    until(lambda: task(http, number)["state"] in ENDED, PATIENCE_S)
    return task(http, number)


def result(http: httpx.Client, number: int) -> dict[str, Any]:
    found = ended(http, number)
    assert (found["state"], found["progress"]) == ("done", 1.0), found
    assert found["seconds"] > 0.0
    return dict(http.get(f"/api/tasks/{number}/result").json())


def test_a_map_has_a_row_for_each_y_and_the_present_loop_in_its_middle(tasks: httpx.Client) -> None:
    found = result(tasks, ask(tasks, kind="stability_map", x=X, y=Y))
    growth, stable = np.array(found["growth"], float), np.array(found["stable"])
    assert growth.shape == stable.shape == (7, 9)
    assert (growth < 0.0).tolist() == stable.tolist()
    assert found["x"]["values"][4] == pytest.approx(1.0)
    assert found["y"]["values"][3] == pytest.approx(1.0)
    poles = tasks.post("/api/analysis").json()["poles"]
    assert growth[3, 4] == pytest.approx(poles["dominant"]["continuous"][0], rel=1e-6)


def test_the_margins_of_a_map_are_the_worst_of_both_breaks(tasks: httpx.Client) -> None:
    found = result(tasks, ask(tasks, kind="margin_map", x=X | {"count": 3}, y=Y | {"count": 3}))
    margins = tasks.post("/api/analysis").json()["robustness"]["margins"]
    both = (margins["plant"], margins["limiter"])
    assert found["disk"][1][1] == pytest.approx(min(each["disk"] for each in both), rel=1e-3)
    assert found["phase"][1][1] == pytest.approx(min(each["phase"] or math.inf for each in both), rel=1e-3)


def test_what_is_asked_is_the_tuning_at_that_moment(tasks: httpx.Client) -> None:
    number = ask(tasks, kind="bandwidth_sets", stiffnesses=[200.0], low=20.0, high=60.0)
    tasks.post("/api/session/load_scenario", json={"name": "realistic"}).raise_for_status()
    assert result(tasks, number)["sets"] == [{"stiffness": 200.0, "intervals": [[20.0, 60.0]]}]


def test_the_worst_of_a_box_lies_in_it_and_is_simulated(tasks: httpx.Client) -> None:
    box = {"link_inertia": [0.5, 3.0]}
    found = result(tasks, ask(tasks, kind="worst_case", box=box))
    assert not found["stable"]  # the nominal loop stands a link up to 2.3 times heavier
    assert found["values"]["link_inertia"] == pytest.approx(3.0)
    certificate = found["certificate"]
    assert certificate["agreed"]
    assert certificate["seen_growth"] == pytest.approx(certificate["predicted_growth"], rel=0.05)


def test_a_running_task_tells_its_progress_and_can_be_cancelled(tasks: httpx.Client) -> None:
    number = ask(tasks, **LONG)
    share = until(lambda: task(tasks, number)["progress"], PATIENCE_S)
    assert 0.0 < share < 1.0
    assert task(tasks, number)["state"] == "running"
    problem_of(tasks.get(f"/api/tasks/{number}/result"), 409)
    tasks.delete(f"/api/tasks/{number}").raise_for_status()
    assert ended(tasks, number)["state"] == "cancelled"
    problem_of(tasks.get(f"/api/tasks/{number}/result"), 409)
    assert len(result(tasks, ask(tasks, kind="stability_map", x=X, y=Y))["stable"]) == 7  # the worker goes on


def test_a_waiting_task_is_cancelled_at_once(tasks: httpx.Client) -> None:
    first, second = ask(tasks, **LONG), ask(tasks, **LONG)
    assert tasks.delete(f"/api/tasks/{second}").json()["state"] == "cancelled"
    assert task(tasks, first)["state"] in ("queued", "running")


def test_live_margins_and_stop_do_not_wait_for_a_task(server: Server, tasks: httpx.Client) -> None:
    number = ask(tasks, **LONG)
    until(lambda: task(tasks, number)["progress"] > 0.0, PATIENCE_S)
    with LivePage(server) as page:
        tuned = page.ask("tune", changes={"observer.bandwidth": 140.0})["result"]["tuning_id"]
        told = page.next_message("margins", lambda message: message["tuning_id"] >= tuned)
        assert told["available"]
        assert page.ask("stop")["ok"]
        page.next_message("state", lambda message: message["snapshot"]["state"] == "stopped")
    assert task(tasks, number)["state"] == "running"


def test_the_list_has_the_newest_first_and_no_results(tasks: httpx.Client) -> None:
    older = ask(tasks, kind="stability_map", x=X, y=Y)
    newer = ask(tasks, kind="stability_map", x=Y, y=X)
    listed = tasks.get("/api/tasks").json()
    assert [each["id"] for each in listed[:2]] == [newer, older]
    assert set(listed[0]) == {"id", "kind", "title", "state", "progress", "words", "reason", "asked_at", "seconds"}


@pytest.mark.parametrize(
    "body",
    [
        {},
        {"kind": "magic"},
        {"kind": "stability_map", "x": X},
        {"kind": "stability_map", "x": X, "y": {"name": "colour"}},
        {"kind": "stability_map", "x": X, "y": Y | {"count": 1}},
        {"kind": "stability_map", "x": X, "y": Y, "plant": "wishful"},
        {"kind": "stability_map", "x": X, "y": Y, "colour": "red"},
        {"kind": "worst_case", "box": {}},
        {"kind": "worst_case", "criterion": "luck"},
        {"kind": "bandwidth_sets", "stiffnesses": []},
        {"kind": "bandwidth_sets", "least": {"gain_up": 0.5}},
        {"kind": "margin_map", "x": X, "y": Y, "stiffness": -1.0},
        [],
    ],
    ids=str,
)
def test_a_request_that_makes_no_sense_is_refused_at_once(tasks: httpx.Client, body: Any) -> None:
    before = tasks.get("/api/tasks").json()
    problem_of(tasks.post("/api/tasks", json=body), 422)
    assert tasks.get("/api/tasks").json() == before


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ({"kind": "stability_map", "x": X, "y": X}, "expected two different ones"),
        ({"kind": "stability_map", "x": X | {"low": 3.0}, "y": Y}, "expected an ascending range"),
        ({"kind": "bandwidth_sets", "mismatches": [{"colour": 2.0}]}, "no axis 'colour'"),
        ({"kind": "worst_case", "box": {"colour": [0.5, 2.0]}}, "no axis 'colour'"),
    ],
    ids=["equal axes", "descending range", "unknown mismatch", "unknown axis of a box"],
)
def test_what_only_the_analysis_can_judge_ends_as_refused(
    tasks: httpx.Client, body: dict[str, Any], words: str
) -> None:
    found = ended(tasks, ask(tasks, **body))
    assert found["state"] == "refused"
    assert words in found["reason"]


@pytest.mark.parametrize("method", ["GET", "DELETE"])
def test_an_unknown_task_is_not_found(tasks: httpx.Client, method: str) -> None:
    problem_of(tasks.request(method, "/api/tasks/987654"), 404)


def test_no_file_beside_those_that_a_task_wrote(tasks: httpx.Client) -> None:
    number = ask(tasks, kind="stability_map", x=X, y=Y)
    ended(tasks, number)
    for name in ("index.html", "..%2f..%2fetc%2fpasswd", ".hidden"):
        problem_of(tasks.get(f"/api/tasks/{number}/files/{name}"), 404)


def test_more_tasks_than_may_wait_are_refused(tasks: httpx.Client) -> None:
    answers = [tasks.post("/api/tasks", json=LONG) for _ in range(18)]
    assert {answer.status_code for answer in answers[:16]} == {202}
    problem_of(answers[-1], 429)


def test_a_loop_is_analysed_at_once_on_either_plant(session: httpx.Client) -> None:
    session.post("/api/session/load_scenario", json={"name": "realistic"}).raise_for_status()
    report = session.post("/api/analysis", json={"stiffness": 50.0, "plant": "actuator"}).json()
    assert (report["stiffness"], report["plant"], report["stable"]) == (50.0, "actuator", True)
    curves = report["sensitivities"]["curves"]
    S, T = (_complex(curves[name]) for name in ("S", "T"))
    assert pytest.approx(1.0, abs=1e-9) == S + T


def test_the_analysis_of_a_controller_without_a_linear_loop_is_refused(session: httpx.Client) -> None:
    scenario = session.get("/api/session").json()["scenario"]
    scenario["tuning"]["controller"] = {"kind": "sliding_mode", "switch": "sgn"}
    detail = problem_of(session.post("/api/analysis", json={"scenario": scenario}), 422)["detail"]
    assert "no linearisation" in detail


@pytest.mark.parametrize(
    "body", [{"stiffness": 0.0}, {"plant": "wishful"}, {"scenario": {"duration_s": -1.0}}], ids=str
)
def test_a_loop_that_makes_no_sense_is_refused(session: httpx.Client, body: dict[str, Any]) -> None:
    problem_of(session.post("/api/analysis", json=body), 422)


def _complex(curve: dict[str, Any]) -> Any:
    return np.array(curve["magnitude"]) * np.exp(1j * np.array(curve["phase"]))
