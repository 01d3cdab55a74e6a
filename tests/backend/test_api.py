"""REST: what there is, and that a simulation over HTTP is the simulation of the core."""

import csv
import io
from typing import Any

import httpx
import numpy as np
import pytest

from tests.backend.frame_decoder import decoded_all
from vssea_core.channels import CHANNELS, LIMITS
from vssea_core.scenario import Scenario
from vssea_core.scenarios import SCENARIOS
from vssea_core.simulation.metrics import metrics
from vssea_core.simulation.run import simulate

SHORT: dict[str, Any] = SCENARIOS["realistic"].model_dump(mode="json") | {"duration_s": 1.5}
RUNS_AWAY = {"disturbances": {"link": [{"kind": "constant", "torque": 200.0, "start_s": 0.2}]}, "duration_s": 2.0}


def local(document: dict[str, Any]) -> Any:
    return simulate(Scenario.model_validate_json(httpx.Response(200, json=document).content))


def test_the_schema_lists_channels_limits_and_commands(http: httpx.Client) -> None:
    schema = http.get("/api/schema").json()
    assert [tuple(channel.values()) for channel in schema["channels"]] == [tuple(channel) for channel in CHANNELS]
    assert [limit["name"] for limit in schema["limits"]] == [limit.name for limit in LIMITS]
    assert {"tune", "stop", "reset"} <= set(schema["commands"])
    bandwidth = schema["scenario"]["$defs"]["PositionObserver"]["properties"]["bandwidth"]
    assert {"unit", "symbol", "equation", "basis", "step", "scale", "typical", "minimum", "maximum", "default"} <= set(
        bandwidth
    )


def test_every_ready_scenario_is_served_whole(http: httpx.Client) -> None:
    served = {scenario["name"]: Scenario.model_validate(scenario) for scenario in http.get("/api/scenarios").json()}
    assert served == SCENARIOS
    for name in SCENARIOS:
        assert Scenario.model_validate(http.get(f"/api/scenarios/{name}").json()) == SCENARIOS[name]


def test_health_says_what_the_session_does(session: httpx.Client) -> None:
    assert session.get("/api/health").json() | {"version": ""} == {"status": "ok", "version": "", "session": "running"}


def test_metrics_over_http_are_those_of_the_core(http: httpx.Client) -> None:
    answer = http.post("/api/simulate", json=SHORT).json()
    assert answer["metrics"] == metrics(local(SHORT).rows)
    assert (answer["samples"], answer["ending"]) == (1500, None)
    assert "trajectory" not in answer


@pytest.mark.parametrize("every", [1, 7])
def test_a_json_trajectory_is_exact(http: httpx.Client, every: int) -> None:
    answer = http.post("/api/simulate", params={"trajectory": "json", "every": every}, json=SHORT).json()
    assert list(answer["trajectory"]) == [channel.name for channel in CHANNELS]
    assert np.array_equal(np.array(list(answer["trajectory"].values())).T, local(SHORT).rows[::every])
    assert answer["period_s"] == pytest.approx(0.001 * every)


def test_a_csv_trajectory_is_exact_and_its_heading_has_units(http: httpx.Client) -> None:
    answer = http.post("/api/simulate", params={"trajectory": "csv"}, json=SHORT)
    assert answer.headers["content-type"].startswith("text/csv")
    heading, *rows = csv.reader(io.StringIO(answer.text))
    assert heading[:2] == ["time [s]", "reference [rad]"]
    assert np.array_equal(np.array(rows, float), local(SHORT).rows)


def test_binary_trajectories_are_telemetry_frames(http: httpx.Client) -> None:
    answer = http.post("/api/simulate", params={"trajectory": "binary", "every": 3}, json=SHORT)
    frames = decoded_all(answer.content)
    assert [frame.samples for frame in frames] == [500]
    assert frames[0].dt == pytest.approx(0.003)
    values = np.concatenate([frame.values for frame in frames], axis=1)
    assert np.array_equal(values, local(SHORT).rows[::3].T.astype(np.float32))


def test_a_run_that_diverges_answers_with_its_ending_and_the_next_one_goes_on(http: httpx.Client) -> None:
    answer = http.post("/api/simulate", json=RUNS_AWAY)
    assert answer.status_code == 200
    assert answer.json()["ending"] == local(RUNS_AWAY).ending
    assert "the deflection left" in answer.json()["ending"]
    assert http.post("/api/simulate", json=SHORT).json()["ending"] is None


def test_an_unstable_tuning_is_simulated_only_when_asked(http: httpx.Client) -> None:
    unstable = SHORT | {
        "tuning": SHORT["tuning"] | {"controller": {"kind": "state_feedback", "natural_frequency": 400.0}}
    }
    assert http.post("/api/simulate", json=unstable).status_code == 422
    assert http.post("/api/simulate", params={"allow_unstable": True}, json=unstable).status_code == 200


def test_an_empty_body_is_the_default_scenario(http: httpx.Client) -> None:
    assert http.post("/api/simulate").json()["samples"] == 10_000
