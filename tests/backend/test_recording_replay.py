"""A recording simulated again is what was recorded, to the bit; what cannot be simulated is told with what can."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from backend.recordings.layout import CHANGES, SCENARIO
from backend.recordings.reader import Recording
from backend.recordings.replayed_scenario import paths_between, replayed_scenario
from backend.recordings.simulated import keep_simulation, residual
from tests.backend.run_recorded import Change, noise_rows, recorded, with_gaps
from vssea_core.changes import set_values
from vssea_core.channels import CHANNELS
from vssea_core.scenario import Scenario, TimedChange
from vssea_core.scenarios import NOMINAL, SCENARIOS
from vssea_core.simulation.run import simulate

LIVE: list[Change] = [
    (333, "tuning", {"observer.bandwidth": 60.0}),
    (333, "stiffness_reference", {"stiffness": 300.0}),
    (1001, "reference", {"amplitude": 0.3}),
    (1001, "reference", {"frequency_hz": 0.5}),
    (1200, "disturbances", {"link": [{"kind": "noise", "rms": 1.0, "bandwidth_hz": 5.0}]}),
    (1500, "reference", {"kind": "move", "target": 0.4}),
    (1777, "tuning", {"controller.kind": "sliding_mode", "controller.surface_pole": 15.0}),
    (1900, "stiffness_reference", {"kind": "move", "target": 500.0, "start_s": 0.1}),
    (2100, "tuning", {"model.link_inertia": 0.12}),
    (2101, "reference", {"kind": "jog", "velocity": 0.2}),
]
SHORT = NOMINAL.model_copy(update={"duration_s": 1.0})


@pytest.mark.parametrize("name", ["nominal", "realistic"])
def test_a_run_with_live_changes_is_simulated_again_to_the_bit(tmp_path: Path, name: str) -> None:
    run = recorded(tmp_path / "run.mcap", SCENARIOS[name], 3000, LIVE)
    replayed = replayed_scenario(run)
    rows = simulate(replayed.scenario, replayed.tuning_id).rows
    names = [channel.name for channel in CHANNELS]
    assert rows.tobytes() == np.ascontiguousarray(run.read(names).rows).tobytes()
    assert len(replayed.scenario.sequence) == len(LIVE)


def test_what_the_sequence_did_is_not_done_twice(tmp_path: Path) -> None:
    planned = NOMINAL.model_copy(
        update={"sequence": (TimedChange(at_s=0.4, changes={"tuning.observer.bandwidth": 60.0}),)}
    )
    run = recorded(tmp_path / "run.mcap", NOMINAL, 1000, [(400, "tuning", {"observer.bandwidth": 60.0})])
    document = run.documents(SCENARIO)[0]["scenario"] | {"sequence": planned.model_dump(mode="json")["sequence"]}
    run.documents = lambda channel: (  # type: ignore[method-assign]
        [{"at_s": 0.0, "tuning_id": 7, "scenario": document}]
        if channel == SCENARIO
        else Recording(run.path).documents(channel)
    )
    replayed = replayed_scenario(run)
    assert [change.at_s for change in replayed.scenario.sequence] == [0.4]
    assert residual(run, simulate(replayed.scenario, 7).rows, 1e-3)["first_difference_s"] is None


def test_the_simulation_is_kept_as_a_recording_of_its_own(tmp_path: Path) -> None:
    run = recorded(tmp_path / "run.mcap", NOMINAL, 1500, LIVE[:3])
    replayed = replayed_scenario(run)
    rows = simulate(replayed.scenario, replayed.tuning_id).rows
    told = keep_simulation(run, replayed, rows, tmp_path / "run-simulated.mcap")
    assert told["first_difference_s"] is None
    assert told["samples"] == 1500
    assert all(each["rms"] == each["peak"] == 0.0 for each in told["residual"].values())
    assert told["residual"]["motor_torque"]["unit"] == "N·m"
    kept = Recording(tmp_path / "run-simulated.mcap")
    assert (kept.head["origin"], kept.head["of"], kept.is_finished) == ("simulation", run.head["id"], True)
    assert np.array_equal(kept.read(["error"]).rows, run.read(["error"]).rows)
    assert [change["at_s"] for change in kept.documents(CHANGES)] == [0.333, 0.333, pytest.approx(1.001)]


def test_the_residual_is_recorded_less_simulated_where_both_are(tmp_path: Path) -> None:
    rows = noise_rows(100)
    found = with_gaps(tmp_path / "run.mcap", [(0, rows[:40]), (60, rows[60:])])
    simulated = rows.copy()
    simulated[70:, 4] -= 2.0
    simulated[80, 2] = rows[80, 2] + 3.0
    told = residual(found, simulated, 1e-3)
    assert told["samples"] == 80
    assert told["first_difference_s"] == pytest.approx(0.07)
    assert told["residual"]["error"]["peak"] == pytest.approx(2.0)
    assert told["residual"]["error"]["rms"] == pytest.approx(2.0 * np.sqrt(30 / 80))
    assert told["residual"]["link_position"]["rms"] == pytest.approx(3.0 / np.sqrt(80))
    assert told["residual"]["motor_torque"]["peak"] == 0.0


def test_a_shorter_span_is_simulated_when_it_is_asked_for(tmp_path: Path) -> None:
    run = recorded(tmp_path / "run.mcap", NOMINAL, 1500, LIVE[:3])
    replayed = replayed_scenario(run, 0.9)
    rows = simulate(replayed.scenario, replayed.tuning_id).rows
    assert len(rows) == 901
    assert residual(run, rows, 1e-3)["first_difference_s"] is None


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ({"tuning": {"observer": {"kind": "position", "bandwidth": 60.0}}}, {}),
        ({}, {"tuning": {"controller": {"kind": "sliding_mode", "surface_pole": 15.0}}}),
        ({}, {"reference": {"kind": "jog", "velocity": 0.2}}),
        ({}, {"disturbances": {"link": [{"kind": "pulse"}]}}),
    ],
)
def test_the_paths_between_two_documents_lead_from_one_to_the_other(
    before: dict[str, Any], after: dict[str, Any]
) -> None:
    one, other = (Scenario.model_validate(each).model_dump(mode="json") for each in (before, after))
    for there, back in ((one, other), (other, one)):
        walked = Scenario.model_validate(there).model_dump(mode="json")
        for part in ("tuning", "reference", "stiffness_reference", "disturbances"):
            set_values(walked, Scenario, paths_between(there[part], back[part], part))
        assert walked == back


MANY: list[Change] = [(10 * n, "tuning", {"observer.bandwidth": 60.0 + n}) for n in range(1, 35)]
STOPPED = {"at_s": 0.5, "kind": "state", "message": "Stopped by page 1 at 0.5 s", "severity": "warning"}


@pytest.mark.parametrize(
    ("changes", "events", "sentence", "until_s"),
    [
        (
            MANY,
            [],
            "up to 0.309 s, and it lasts 0.999 s: at most 30 changes are simulated again, and more were made",
            0.309,
        ),
        (
            [],
            [STOPPED],
            "up to 0.499 s, and it lasts 0.999 s: STOP was pressed at 0.5 s, and a scenario has no STOP",
            0.499,
        ),
    ],
)
def test_what_is_beyond_a_scenario_is_refused_with_what_can_be_simulated(
    tmp_path: Path,
    changes: list[Change],
    events: list[dict[str, Any]],
    sentence: str,
    until_s: float,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("backend.recordings.replayed_scenario.MOST_CHANGES", 30)
    run = recorded(tmp_path / "run.mcap", SHORT, 1000, changes, events)
    with pytest.raises(ValueError, match=f'{sentence}; ask for that span with {{"to_s": {until_s}}}'):
        replayed_scenario(run)
    replayed = replayed_scenario(run, until_s)
    told = residual(run, simulate(replayed.scenario, replayed.tuning_id).rows, 1e-3)
    assert told["first_difference_s"] is None
    assert told["samples"] == round(until_s / 1e-3) + 1
    with pytest.raises(ValueError, match=r"and 0.9 s were asked for"):
        replayed_scenario(run, 0.9)


def test_a_dragged_slider_is_simulated_again_to_the_bit(tmp_path: Path) -> None:
    drag: list[Change] = [(10 * n, "tuning", {"observer.bandwidth": 60.0 + n}) for n in range(1, 90)]
    run = recorded(tmp_path / "run.mcap", SHORT, 1000, drag)
    replayed = replayed_scenario(run)
    told = residual(run, simulate(replayed.scenario, replayed.tuning_id).rows, 1e-3)
    assert told["first_difference_s"] is None
    assert told["samples"] == 1000


def test_a_stop_before_its_event_is_told_by_its_command(tmp_path: Path) -> None:
    stop = {"at_s": 0.25, "command": "stop", "ok": True}
    run = recorded(tmp_path / "run.mcap", SHORT, 1000, commands=[stop])
    with pytest.raises(ValueError, match=r"up to 0.249 s"):
        replayed_scenario(run)


def test_a_long_recording_is_refused_with_the_longest_simulation(tmp_path: Path) -> None:
    rows = noise_rows(2)
    found = with_gaps(tmp_path / "run.mcap", [(0, rows), (130_000, noise_rows(2, 130_000))])
    run = recorded(tmp_path / "short.mcap", SHORT, 10)
    found.documents = run.documents  # type: ignore[method-assign]
    with pytest.raises(ValueError, match=r"up to 119.999 s, and it lasts 130.001 s: a simulation lasts at most 120 s"):
        replayed_scenario(found)


def test_a_part_that_begins_later_is_refused(tmp_path: Path) -> None:
    found = with_gaps(tmp_path / "run.mcap", [(500, noise_rows(10, 500))])
    run = recorded(tmp_path / "short.mcap", SHORT, 10)
    found.documents = run.documents  # type: ignore[method-assign]
    with pytest.raises(ValueError, match=r"begins at t = 0.5 s, and what the actuator did before is not in it"):
        replayed_scenario(found)


def test_a_recording_without_scenario_or_samples_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="holds no scenario to simulate; choose a recording of the live session"):
        replayed_scenario(with_gaps(tmp_path / "run.mcap", [(0, noise_rows(10))]))
    with pytest.raises(ValueError, match="has no samples; choose another recording"):
        replayed_scenario(recorded(tmp_path / "empty.mcap", SHORT, 0))


def test_a_scenario_of_another_version_is_refused_by_its_field(tmp_path: Path) -> None:
    run = recorded(tmp_path / "run.mcap", SHORT, 10)
    document = SHORT.model_dump(mode="json") | {"gadget": 1}
    run.documents = lambda channel: [{"scenario": document}] if channel == SCENARIO else []  # type: ignore[method-assign]
    with pytest.raises(ValueError, match="does not fit this version: gadget is 1; unknown name"):
        replayed_scenario(run)
