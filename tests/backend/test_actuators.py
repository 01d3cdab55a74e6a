"""The actuator library: plants with provenance, loaded into the live scenario, and their calibration."""

from typing import Any

import httpx
import numpy as np
import pytest
from scipy.optimize import least_squares

from tests.backend.test_api_errors import problem_of
from vssea_core.actuator.calibration import fitted_spring, unloaded_stiffness
from vssea_core.actuator.spring import leaf, stiffness_motor_position

POSITIONS = (32.0, 40.0, 60.0, 95.0, 114.0)


def saved(http: httpx.Client, name: str, **changes: Any) -> dict[str, Any]:
    """The live plant under a name, with changed content."""
    http.put(f"/api/actuators/{name}", json={}, headers={"If-None-Match": "*"})
    content = http.get(f"/api/actuators/{name}").json()["content"] | changes
    answer = http.put(f"/api/actuators/{name}", json=content, headers={"If-Match": "*"})
    answer.raise_for_status()
    return dict(answer.json())


def test_the_live_plant_is_saved_with_where_its_values_come_from(session: httpx.Client) -> None:
    session.post("/api/session/load_scenario", json={"name": "paper_fig2"}).raise_for_status()
    session.put("/api/actuators/of the paper", json={"tags": ["paper"]}).raise_for_status()
    found = session.get("/api/actuators/of the paper").json()
    assert found["content"]["actuator"] == session.get("/api/session").json()["scenario"]["actuator"]
    provenance = found["content"]["provenance"]
    assert provenance["stiffness.inertia"]["source"] == "datasheet"
    assert provenance["link.inertia"]["source"] == "assumed"  # 0.12, not the default
    assert found["summary"] == "link 0.12, motor 3.3 kg·m²; 20 to 1000 N·m/rad"
    assert [line["name"] for line in session.get("/api/actuators", params={"tag": "paper"}).json()] == ["of the paper"]


def test_a_loaded_plant_restarts_the_scenario_and_leaves_the_tuning(session: httpx.Client) -> None:
    actuator = session.get("/api/session").json()["scenario"]["actuator"]
    actuator["link"]["inertia"] = 0.3
    saved(session, "heavy", actuator=actuator)
    before = session.get("/api/session").json()
    difference = session.get("/api/actuators/heavy/difference").json()
    assert [each["words"] for each in difference["changes"]] == ["J_l 0.1 → 0.3 kg·m²"]
    session.post("/api/actuators/heavy/apply").raise_for_status()
    after = session.get("/api/session").json()
    assert after["scenario"]["actuator"]["link"]["inertia"] == 0.3
    assert after["scenario"]["tuning"] == before["scenario"]["tuning"]
    assert after["epoch"] == before["epoch"] + 1


def test_a_plant_that_the_scenario_does_not_fit_is_refused_and_the_old_one_goes_on(session: httpx.Client) -> None:
    actuator = session.get("/api/session").json()["scenario"]["actuator"]
    saved(session, "stiff", actuator=actuator | {"stiffness": actuator["stiffness"] | {"softest": 500.0}})
    before = session.get("/api/session").json()["epoch"]
    assert "expected 500 to 1000 N·m/rad" in problem_of(session.post("/api/actuators/stiff/apply"), 422)["detail"]
    assert session.get("/api/session").json()["epoch"] == before


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ({"calibration": [{"stiffness_motor_position": 60.0, "stiffness": 100.0}]}, "give it too"),
        ({"actuator": {}, "provenance": {"link.colour": {}}}, "link.colour is no parameter of an actuator"),
        ({"actuator": {}, "provenance": {"link.inertia": {"source": "hearsay"}}}, "'datasheet'"),
        ({"actuator": {}, "calibration": [{"stiffness_motor_position": 0.0, "stiffness": 1.0}]}, "greater than 0"),
        ({"actuator": {"link": {"inertia": 50.0}}}, "expected a number from 0.005 to 5 kg·m²"),
        ({"tuning": {}}, "unknown name"),
    ],
    ids=str,
)
def test_a_refused_actuator_is_not_kept(session: httpx.Client, body: dict[str, Any], words: str) -> None:
    assert words in problem_of(session.put("/api/actuators/never", json=body), 422)["detail"]
    problem_of(session.get("/api/actuators/never"), 404)


def test_the_calibration_shows_model_and_deviation_and_the_constant_that_fits(session: httpx.Client) -> None:
    constant = session.get("/api/session").json()["scenario"]["actuator"]["stiffness"]["spring_constant"]
    points = [
        {"stiffness_motor_position": x, "stiffness": 1.1 * constant / (2.0 * x**3), "note": f"{x}"} for x in POSITIONS
    ]
    version = saved(session, "calibrated", calibration=points)["version"]
    found = session.get("/api/actuators/calibrated/calibration").json()
    assert found["version"] == version
    assert [row["note"] for row in found["rows"]] == [point["note"] for point in points]
    assert np.allclose([row["deviation_percent"] for row in found["rows"]], 10.0)
    assert found["rms_percent"] == pytest.approx(10.0)
    assert found["fit"]["spring_constant"] == pytest.approx(1.1 * constant)
    assert found["fit"]["rms_percent"] == pytest.approx(0.0, abs=1e-9)


def test_an_actuator_without_points_has_no_fit(session: httpx.Client) -> None:
    saved(session, "bare")
    found = session.get("/api/actuators/bare/calibration").json()
    assert (found["rows"], found["fit"], found["rms_percent"]) == ([], None, None)


def test_the_fitted_constant_has_the_least_relative_deviations() -> None:
    measured = [
        6.0e7 * factor / (2.0 * x**3) for x, factor in zip(POSITIONS, (1.02, 0.95, 1.0, 1.07, 0.99), strict=True)
    ]
    fit = fitted_spring(POSITIONS, measured)

    def deviations(unknown: Any) -> Any:
        return np.array([unknown[0] * 1e7 / (2.0 * x**3 * k) - 1.0 for x, k in zip(POSITIONS, measured, strict=True)])

    found = least_squares(deviations, [1.0], xtol=1e-14, ftol=1e-14, gtol=1e-14)
    assert fit.spring_constant == pytest.approx(found.x[0] * 1e7, rel=1e-8)
    assert fit.rms == pytest.approx(np.sqrt(np.mean(found.fun**2)), rel=1e-8)


def test_the_unloaded_stiffness_is_that_of_the_spring() -> None:
    for position in POSITIONS:
        stiffness = unloaded_stiffness(position, 6.2e7)
        assert stiffness == pytest.approx(6.2e7 * leaf(0.0, position).stiffness)
        assert stiffness_motor_position(stiffness, 6.2e7) == pytest.approx(position)


@pytest.mark.parametrize(("positions", "stiffnesses"), [((), ()), ((60.0,), ()), ((60.0,), (-1.0,)), ((0.0,), (5.0,))])
def test_a_fit_needs_positive_points(positions: tuple[float, ...], stiffnesses: tuple[float, ...]) -> None:
    with pytest.raises(ValueError, match="expected positive positions and as many stiffnesses"):
        fitted_spring(positions, stiffnesses)
