"""Every error of REST is one problem document with a sentence, and changes nothing."""

from collections.abc import Iterator
from typing import Any

import httpx
import pytest

UNSTABLE = {"changes": {"controller.natural_frequency": 400.0, "observer.bandwidth": 500.0}}
TUNE = "/api/session/tune"
SIMULATE = "/api/simulate"


def in_force(http: httpx.Client) -> tuple[Any, ...]:
    snapshot = http.get("/api/session").json()
    return tuple(snapshot[name] for name in ("state", "epoch", "tuning_id", "scenario"))


@pytest.fixture
def unchanged(session: httpx.Client) -> Iterator[httpx.Client]:
    """The client; afterwards the old tuning must still be in force, in a session that still runs."""
    session.post("/api/session/load_scenario", json={"name": "realistic"}).raise_for_status()
    before = in_force(session)
    yield session
    assert in_force(session) == before
    assert before[0] == "running"


def problem_of(answer: httpx.Response, status: int) -> dict[str, Any]:
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    problem: dict[str, Any] = answer.json()
    assert list(problem) == ["type", "title", "status", "detail", "errors"]
    assert problem["type"] == "about:blank"
    assert problem["status"] == status
    assert problem["title"]
    assert problem["detail"].endswith(".")
    for error in problem["errors"]:
        assert set(error) == {"field", "value", "message"}
    return problem


@pytest.mark.parametrize(
    ("method", "path", "status"),
    [
        ("GET", "/api/nothing", 404),
        ("GET", "/nothing.html", 404),
        ("GET", "/api/scenarios/nothing", 404),
        ("POST", "/api/session/explode", 404),
        ("DELETE", "/api/presets/nothing", 404),
        ("POST", "/api/presets/nothing/apply", 404),
        ("POST", "/api/schema", 405),
        ("DELETE", "/api/session", 405),
        ("GET", "/api/session/events?last=0", 422),
        ("POST", "/api/simulate?every=0", 422),
        ("POST", "/api/simulate?trajectory=xml", 422),
    ],
)
def test_a_wrong_address_or_query(unchanged: httpx.Client, method: str, path: str, status: int) -> None:
    problem_of(unchanged.request(method, path), status)


@pytest.mark.parametrize("path", [TUNE, SIMULATE, "/api/presets/new"])
@pytest.mark.parametrize(
    ("body", "status"),
    [
        (b"{not json", 400),
        (b"\xff\xfe", 400),
        (b"[" * 100_000, 400),
        (b" " * 1_000_001, 413),
        (b"[1]", 422),
        (b'"text"', 422),
        (b'{"unheard": 1}', 422),
    ],
    ids=["not JSON", "not UTF-8", "too deep", "too large", "list", "text", "unknown name"],
)
def test_a_body_that_is_not_a_document(unchanged: httpx.Client, path: str, body: bytes, status: int) -> None:
    method = "PUT" if "presets" in path else "POST"
    problem_of(unchanged.request(method, path, content=body), status)
    assert unchanged.get("/api/presets").json() == []


@pytest.mark.parametrize(
    ("literal", "shown"), [("NaN", "nan"), ("Infinity", "inf"), ("-Infinity", "-inf"), ("1e999", "inf")]
)
def test_a_number_that_is_not_finite(unchanged: httpx.Client, literal: str, shown: str) -> None:
    tune = f'{{"changes": {{"observer.bandwidth": {literal}}}}}'.encode()
    problem = problem_of(unchanged.post(TUNE, content=tune), 422)
    assert problem["errors"][0]["value"] == shown
    simulated = f'{{"tuning": {{"observer": {{"kind": "position", "bandwidth": {literal}}}}}}}'.encode()
    for path, body in ((SIMULATE, simulated), ("/api/session/set_pace", f'{{"factor": {literal}}}'.encode())):
        problem_of(unchanged.post(path, content=body), 422)


@pytest.mark.parametrize(
    ("changes", "field", "words"),
    [
        ({"observer.bandwidth": 1e6}, "tuning.observer.bandwidth", "expected a number from 1 to 2000 rad/s"),
        ({"observer.bandwidth": -1}, "tuning.observer.bandwidth", "1 to 2000 rad/s"),
        ({"observer.bandwidth": "100"}, "tuning.observer.bandwidth", "1 to 2000 rad/s"),
        ({"observer.bandwidth": None}, "tuning.observer.bandwidth", "1 to 2000 rad/s"),
        ({"observer.bandwidth": True}, "tuning.observer.bandwidth", "1 to 2000 rad/s"),
        ({"observer.bandwidth": 10**400}, "tuning.observer.bandwidth", "1 to 2000 rad/s"),
        ({"observer.band": 1}, "tuning.observer.band", "known here: kind, bandwidth"),
        ({"": 1}, "tuning.", "known here: controller"),
        ({"observer.bandwidth.deep": 1}, "tuning.observer.bandwidth.deep", "unknown name"),
        ({"controller.kind": "magic"}, "tuning.controller.kind", "'state_feedback', 'sliding_mode'"),
        ({"controller.kind": {"a": []}}, "tuning.controller.kind", "'state_feedback', 'sliding_mode'"),
        ({"controller": {}}, "tuning.controller.kind", "missing"),
        ({"controller": 5}, "tuning.controller", "an object"),
    ],
    ids=str,
)
def test_a_refused_value_is_told_with_its_field_and_what_was_expected(
    unchanged: httpx.Client, changes: dict[str, Any], field: str, words: str
) -> None:
    problem = problem_of(unchanged.post(TUNE, json={"changes": changes}), 422)
    assert problem["errors"][0]["field"] == field
    assert words in problem["errors"][0]["message"]
    assert problem["detail"].endswith("Nothing was changed.")


def test_an_unstable_tuning_is_refused_with_a_remedy_that_works(unchanged: httpx.Client) -> None:
    detail = problem_of(unchanged.post(TUNE, json=UNSTABLE), 422)["detail"]
    assert "is unstable even with its own model" in detail
    assert "would be stable" in detail or "lower both" in detail
    assert detail.endswith("The old tuning keeps running.")


@pytest.mark.parametrize(
    ("command", "arguments"),
    [
        ("set_reference", {"replace": {"kind": "circle"}}),
        ("set_reference", {"changes": {"amplitude": 100.0}}),
        ("set_stiffness", {"changes": {"stiffness": 5000.0}}),
        ("set_disturbances", {"replace": {"link": [{"kind": "constant", "torque": 1e9}]}}),
        ("set_disturbances", {"replace": {"link": [{"kind": "constant", "start_s": 2.0, "end_s": 1.0}]}}),
        ("load_scenario", {}),
        ("load_scenario", {"name": "nominal", "scenario": {}}),
        ("load_scenario", {"scenario": {"duration_s": 1e9}}),
        ("set_pace", {"factor": 0.0}),
        ("step", {"samples": 1}),
        ("step", {"samples": 10_001}),
        ("step", {"samples": 1.5}),
        ("resume", {}),
        ("pause", {"for": 5}),
        ("save_preset", {"name": ""}),
        ("save_preset", {"name": "a/b"}),
        ("apply_preset", {"name": 7}),
    ],
    ids=str,
)
def test_wrong_arguments_of_a_command(unchanged: httpx.Client, command: str, arguments: dict[str, Any]) -> None:
    problem_of(unchanged.post(f"/api/session/{command}", json=arguments), 422)
