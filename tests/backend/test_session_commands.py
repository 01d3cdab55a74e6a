"""Every command of the live session, over REST."""

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import httpx
import pytest

from tests.backend.server import until
from vssea_core.scenarios import SCENARIOS


def ask(http: httpx.Client, command: str, **arguments: Any) -> dict[str, Any]:
    answer = http.post(f"/api/session/{command}", json=arguments)
    assert answer.status_code == 200, answer.text
    return dict(answer.json())


def snapshot(http: httpx.Client) -> dict[str, Any]:
    return dict(http.get("/api/session").json())


def scenario(http: httpx.Client) -> dict[str, Any]:
    return dict(snapshot(http)["scenario"])


def state(http: httpx.Client) -> str:
    return str(http.get("/api/health").json()["session"])


def events(http: httpx.Client) -> list[dict[str, Any]]:
    return list(http.get("/api/session/events").json())


def test_a_tuning_is_applied_and_numbered(session: httpx.Client) -> None:
    before = snapshot(session)["tuning_id"]
    answer = ask(session, "tune", changes={"observer.bandwidth": 150.0, "controller.damping": 0.9})
    assert answer["applied"] == {"observer.bandwidth": 150.0, "controller.damping": 0.9}
    assert answer["tuning_id"] == before + 1 == snapshot(session)["tuning_id"]
    assert scenario(session)["tuning"]["observer"]["bandwidth"] == 150.0


def test_a_tuning_that_changes_nothing_is_not_counted(session: httpx.Client) -> None:
    before = snapshot(session)["tuning_id"]
    assert ask(session, "tune", changes={"observer.bandwidth": 100.0})["tuning_id"] == before


def test_a_whole_tuning_replaces_the_old_one(session: httpx.Client) -> None:
    tuning = SCENARIOS["paper_fig2"].tuning.model_dump(mode="json")
    ask(session, "tune", replace=tuning)
    assert scenario(session)["tuning"] == tuning


@pytest.mark.parametrize(
    ("command", "part", "path", "first", "then", "kept"),
    [
        ("set_reference", "reference", "", {"kind": "move", "target": 0.7, "start_s": 0.1}, "sine", {}),
        ("set_reference", "reference", "", {"kind": "move", "target": 0.7}, "step", {"target": 0.7}),
        ("set_reference", "reference", "", {"kind": "step", "dwell_s": 3.0}, "move", {"dwell_s": 3.0}),
        ("set_stiffness", "stiffness_reference", "", {"kind": "constant", "stiffness": 300.0}, "move", {"stiffness": 300.0}),
        ("set_stiffness", "stiffness_reference", "", {"kind": "move", "stiffness": 300.0}, "constant", {"stiffness": 300.0}),
        ("tune", "tuning.observer", "observer.", {"kind": "velocity", "bandwidth": 90.0}, "position", {"bandwidth": 90.0}),
        ("tune", "tuning.controller", "controller.", {"kind": "sliding_mode"}, "state_feedback", {}),
    ],
)  # fmt: skip
def test_another_kind_takes_its_own_defaults_and_keeps_what_both_share(
    session: httpx.Client, command: str, part: str, path: str, first: dict[str, Any], then: str, kept: dict[str, Any]
) -> None:
    ask(session, command, changes={f"{path}{name}": value for name, value in first.items()})
    ask(session, command, changes={f"{path}kind": then})
    found = scenario(session)
    for name in part.split("."):
        found = found[name]
    assert found["kind"] == then
    assert {name: found[name] for name in kept} == kept


def test_disturbances_are_replaced_whole(session: httpx.Client) -> None:
    terms = {"link": [{"kind": "sine", "amplitude": 1.0}], "motor": [{"kind": "constant", "torque": -2.0}]}
    ask(session, "set_disturbances", replace=terms)
    found = scenario(session)["disturbances"]
    assert [term["amplitude"] for term in found["link"]] == [1.0]
    assert [term["torque"] for term in found["motor"]] == [-2.0]


def test_a_loaded_scenario_restarts_time_in_a_new_epoch(session: httpx.Client) -> None:
    until(lambda: snapshot(session)["time_s"] > 0.2)
    before = snapshot(session)
    document = SCENARIOS["realistic"].model_dump(mode="json") | {"name": "mine"}
    ask(session, "load_scenario", scenario=document)
    after = snapshot(session)
    assert after["epoch"] == before["epoch"] + 1
    assert after["scenario"] == document
    assert after["state"] == "running"


def test_pause_step_and_resume(session: httpx.Client) -> None:
    ask(session, "pause")
    held = snapshot(session)
    assert (held["state"], snapshot(session)["time_s"]) == ("paused", held["time_s"])
    stepped = ask(session, "step", samples=250)
    assert stepped["time_s"] == pytest.approx(held["time_s"] + 0.250)
    ask(session, "resume")
    assert state(session) == "running"


def test_a_reset_of_a_running_session_goes_on_running_from_zero(session: httpx.Client) -> None:
    until(lambda: snapshot(session)["time_s"] > 0.5)
    before = snapshot(session)
    ask(session, "reset")
    after = snapshot(session)
    assert (after["state"], after["epoch"]) == ("running", before["epoch"] + 1)
    assert after["time_s"] < before["time_s"]


def test_stop_is_latched_and_only_a_reset_and_a_resume_lead_out(session: httpx.Client) -> None:
    ask(session, "stop")
    until(lambda: state(session) == "stopped")
    said = snapshot(session)["sentence"]
    assert said.startswith("Stopped by REST at ")
    assert "Reset" in said
    for command in ("resume", "pause", "step"):
        assert session.post(f"/api/session/{command}").status_code == 422
    ask(session, "tune", changes={"observer.bandwidth": 120.0})
    ask(session, "stop")
    assert state(session) == "stopped"
    ask(session, "reset")
    assert state(session) == "ready"
    ask(session, "resume")
    assert state(session) == "running"


def test_the_pace_asked_for_is_shown_and_reached(session: httpx.Client) -> None:
    ask(session, "set_pace", factor=0.25)
    assert snapshot(session)["pace"]["asked"] == 0.25


def test_of_commands_that_follow_each_other_the_last_wins(session: httpx.Client) -> None:
    def tune(bandwidth: float) -> int:
        return int(ask(session, "tune", changes={"observer.bandwidth": bandwidth})["tuning_id"])

    with ThreadPoolExecutor(8) as pages:
        numbers = dict(zip(range(60, 100), pages.map(tune, range(60, 100)), strict=True))
    last = max(numbers, key=lambda bandwidth: numbers[bandwidth])
    assert len(set(numbers.values())) == len(numbers)
    assert scenario(session)["tuning"]["observer"]["bandwidth"] == last
    assert snapshot(session)["tuning_id"] == numbers[last]


def test_what_a_slider_sends_becomes_one_line_of_the_log(session: httpx.Client) -> None:
    for bandwidth in range(101, 121):
        ask(session, "tune", changes={"observer.bandwidth": bandwidth})
    lines = until(lambda: [event["text"] for event in events(session) if event["text"].endswith("→ 120 rad/s")])
    assert lines == ["g 100 → 120 rad/s"]


def test_a_live_fault_has_a_reason_and_keeps_what_led_to_it(session: httpx.Client) -> None:
    ask(session, "set_disturbances", replace={"link": [{"kind": "constant", "torque": 200.0}]})
    until(lambda: state(session) == "fault")
    assert "Diverged at t = " in snapshot(session)["reason"]
    kept = until(lambda: [event for event in events(session) if event["text"].startswith("kept of the fault: ")])
    assert kept[-1]["text"].endswith("of this recording")
    assert session.post("/api/session/resume").status_code == 422
    ask(session, "load_scenario", name="nominal")
    assert state(session) == "ready"
