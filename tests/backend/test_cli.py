"""The command line: what it prints, and one sentence for whatever is wrong."""

import csv
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from backend.cli import app
from tests.backend.frame_decoder import decoded_all
from tests.backend.run_recorded import recorded
from vssea_core.scenario import Scenario
from vssea_core.scenarios import SCENARIOS
from vssea_core.simulation.metrics import metrics
from vssea_core.simulation.run import simulate

SHORT = SCENARIOS["realistic"].model_copy(update={"duration_s": 0.2})


def vssea(*arguments: str, stdin: str = "") -> Result:
    return CliRunner().invoke(app, arguments, input=stdin)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    written = tmp_path / "short.json"
    written.write_text(SHORT.model_dump_json(), "utf-8")
    return written


def test_a_ready_scenario_is_known_by_name() -> None:
    assert json.loads(vssea("simulate", "nominal").stdout)["metrics"] == metrics(simulate(SCENARIOS["nominal"]).rows)


def test_a_file_and_standard_input_are_the_same(file: Path) -> None:
    expected = metrics(simulate(SHORT).rows)
    assert json.loads(vssea("simulate", str(file)).stdout)["metrics"] == expected
    assert json.loads(vssea("simulate", "-", stdin=file.read_text("utf-8")).stdout)["metrics"] == expected


@pytest.mark.parametrize("every", [1, 3])
def test_the_trajectory_is_written_in_each_form(file: Path, every: int) -> None:
    rows = simulate(SHORT).rows[::every]
    outputs = {form: file.with_name(f"out.{form}") for form in ("csv", "json", "bin")}
    for output in outputs.values():
        outcome = vssea("simulate", str(file), "-o", str(output), "--every", str(every))
        assert outcome.exit_code == 0, outcome.stderr
        assert json.loads(outcome.stdout)["samples"] == 200
    assert np.array_equal(np.array(list(csv.reader(outputs["csv"].read_text().splitlines()))[1:], float), rows)
    assert np.array_equal(np.array(list(json.loads(outputs["json"].read_text())["trajectory"].values())).T, rows)
    frames = decoded_all(outputs["bin"].read_bytes())
    assert np.array_equal(np.concatenate([frame.values for frame in frames], axis=1), rows.T.astype("f4"))


UNSTABLE = json.dumps(
    {
        "timing": {"compute_delay_samples": 1},
        "tuning": {"controller": {"kind": "state_feedback", "natural_frequency": 500.0}},
    }
)


@pytest.mark.parametrize(
    ("arguments", "stdin", "words"),
    [
        (["simulate", "nothing.json"], "", "nothing.json cannot be read"),
        (["simulate", "."], "", "cannot be read"),
        (["simulate", "-"], "{", "not JSON"),
        (["simulate", "-"], "[]", "expected an object"),
        (["simulate", "-"], '{"duration_s": 1e9}', "duration_s is 1000000000.0; expected a number from 0.001 to 120 s"),
        (["simulate", "-"], '{"duration": 1}', "unknown name"),
        (["simulate", "-"], '{"duration_s": NaN}', "duration_s is nan"),
        (["simulate", "-"], UNSTABLE, "would be stable"),
        (["simulate", "nominal", "-o", "out.txt"], "", "expected a name ending in .csv, .json, .bin"),
        (["simulate", "nominal", "-o", "no/such/folder/out.csv"], "", "cannot be written"),
        (["serve", "--scenario", "nothing"], "", "expected one of nominal, realistic, paper_fig2"),
        (["serve", "--host", "0.0.0.0"], "", "set VSSEA_TOKEN"),
        (["serve", "--port", "99999"], "", "port"),
    ],
    ids=str,
)
def test_what_is_wrong_is_told_in_one_sentence(arguments: list[str], stdin: str, words: str) -> None:
    outcome = vssea(*arguments, stdin=stdin)
    assert outcome.exit_code == 2
    assert outcome.stdout == ""
    assert outcome.stderr.startswith("vssea: ")
    assert words in outcome.stderr
    assert outcome.stderr.count("\n") == 1


def test_an_unstable_tuning_is_simulated_when_allowed() -> None:
    assert vssea("simulate", "-", "--allow-unstable", stdin=UNSTABLE).exit_code == 0


def test_a_diverging_run_is_an_ending_and_no_error() -> None:
    load = '{"disturbances": {"link": [{"kind": "constant", "torque": 200, "start_s": 0.2}]}, "duration_s": 2}'
    outcome = vssea("simulate", "-", stdin=load)
    assert outcome.exit_code == 0
    assert "the deflection left" in json.loads(outcome.stdout)["ending"]


def test_the_module_serves_as_the_command(file: Path) -> None:
    command = [sys.executable, "-m", "backend.cli", "simulate", str(file)]
    environment = os.environ | {"PYTHONIOENCODING": "utf-8"}
    outcome = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    assert (outcome.returncode, outcome.stderr) == (0, "")
    assert json.loads(outcome.stdout)["name"] == Scenario.model_validate_json(file.read_text("utf-8")).name


def test_a_data_folder_that_cannot_be_used_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "data"
    folder.write_text("a file instead of a folder")
    monkeypatch.setenv("VSSEA_DATA_DIR", str(folder))
    outcome = vssea("serve")
    assert outcome.exit_code == 2
    assert f"vssea: {folder} cannot be the data folder" in outcome.stderr
    assert outcome.stderr.count("\n") == 1


def test_an_address_of_a_database_is_checked_and_never_repeated(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VSSEA_DATABASE", "mysql://me:secret@host/name")
    outcome = vssea("serve")
    assert outcome.exit_code == 2
    assert "database is no address of a database; expected sqlite:///" in outcome.stderr
    assert "secret" not in outcome.stderr


def test_the_report_of_a_recording_is_written_by_file_or_by_id(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VSSEA_RECORDINGS_DIR", str(tmp_path))
    recorded(tmp_path / "run.mcap", SHORT, 200)
    for place, name in ((str(tmp_path / "run.mcap"), "one.html"), ("run", "other.html")):
        outcome = vssea("report", place, "-o", str(tmp_path / name))
        assert outcome.exit_code == 0, outcome.stderr
        assert (tmp_path / name).read_text("utf-8").startswith("<!doctype html>")


@pytest.mark.parametrize(
    ("place", "sentence"),
    [
        (
            "nothing",
            "nothing.mcap cannot be read: No such file or directory; expected an .mcap file or a recording's id",
        ),
        ("text", "text.mcap is not a recording: it does not begin as an MCAP file"),
    ],
)
def test_what_is_no_recording_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, place: str, sentence: str
) -> None:
    monkeypatch.setenv("VSSEA_RECORDINGS_DIR", str(tmp_path))
    (tmp_path / "text.mcap").write_text("a text that is longer than the magic of such a file")
    outcome = vssea("report", place)
    assert outcome.exit_code == 2
    assert sentence in outcome.stderr
    assert outcome.stderr.count("\n") == 1
