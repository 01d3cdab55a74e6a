"""The same timed sequence, live: made by the session itself, told to every page, begun again by a reset."""

from typing import Any

import httpx

from tests.backend.live_page import LivePage
from tests.backend.server import Server, until
from vssea_core.scenarios import NOMINAL, REALISTIC

SEQUENCE = [
    {"at_s": 0.2, "changes": {"stiffness_reference.stiffness": 400.0}},
    {"at_s": 0.4, "changes": {"tuning.observer.bandwidth": 150.0}},
    {"at_s": 0.6, "changes": {"reference.kind": "move"}},
]


def loaded(session: httpx.Client) -> None:
    scenario = NOMINAL.model_dump(mode="json") | {"sequence": SEQUENCE}
    answer = session.post("/api/session/load_scenario", json={"scenario": scenario})
    assert answer.status_code == 200, answer.text


def scenario_of(session: httpx.Client) -> dict[str, Any]:
    return dict(session.get("/api/session").json()["scenario"])


def over(session: httpx.Client) -> bool:
    return bool(scenario_of(session)["reference"]["kind"] == "move")


def test_each_change_is_made_at_its_time_and_told(server: Server, session: httpx.Client) -> None:
    with LivePage(server) as page:
        loaded(session)
        texts = [page.next_message("event", lambda m: m["event"]["kind"] == "sequence")["event"] for _ in SEQUENCE]
        document = page.next_message("document", lambda m: m["scenario"]["reference"]["kind"] == "move")
    assert [event["time_s"] for event in texts] == [0.2, 0.4, 0.6]
    assert "200 → 400" in texts[0]["text"]
    assert "100 → 150" in texts[1]["text"]
    assert document["scenario"]["stiffness_reference"]["stiffness"] == 400.0
    assert session.get("/api/session").json()["tuning_id"] == document["tuning_id"]


def test_a_reset_brings_the_beginning_back_with_what_was_changed_by_hand(session: httpx.Client) -> None:
    loaded(session)
    until(lambda: over(session))
    session.post("/api/session/tune", json={"changes": {"controller.natural_frequency": 15.0}}).raise_for_status()
    assert scenario_of(session)["tuning"]["observer"]["bandwidth"] == 150.0
    session.post("/api/session/pause").raise_for_status()
    session.post("/api/session/reset").raise_for_status()
    begun = scenario_of(session)
    assert begun["tuning"]["observer"]["bandwidth"] == 100.0
    assert begun["tuning"]["controller"]["natural_frequency"] == 15.0
    assert begun["reference"]["kind"] == "sine"
    session.post("/api/session/resume").raise_for_status()
    until(lambda: over(session))
    assert scenario_of(session)["tuning"]["controller"]["natural_frequency"] == 15.0


def test_a_change_by_hand_before_its_time_leaves_the_rest_of_the_sequence_as_it_was(session: httpx.Client) -> None:
    loaded(session)
    session.post("/api/session/set_disturbances", json={"replace": {"link": [], "motor": []}}).raise_for_status()
    until(lambda: over(session))
    assert scenario_of(session)["tuning"]["observer"]["bandwidth"] == 150.0
    assert scenario_of(session)["disturbances"]["link"] == []


def test_a_sequence_that_would_become_unstable_is_refused_whole(session: httpx.Client) -> None:
    before = scenario_of(session)
    wild = [{"at_s": 1.0, "changes": {"tuning.controller.natural_frequency": 300.0}}]
    answer = session.post(
        "/api/session/load_scenario", json={"scenario": REALISTIC.model_dump(mode="json") | {"sequence": wild}}
    )
    assert answer.status_code == 422
    assert "unstable" in answer.json()["detail"]
    assert scenario_of(session) == before
