"""The export over REST and from the command line is that of the core."""

import csv
import io
import json
import zipfile
from pathlib import Path
from typing import Any

import httpx
import pytest
from typer.testing import CliRunner

from backend.cli import app
from vssea_core.export.bundle import all_files, c_files
from vssea_core.export.numbers import controller_numbers
from vssea_core.scenario import Scenario
from vssea_core.scenarios import REALISTIC

DOCUMENT: dict[str, Any] = REALISTIC.model_dump(mode="json")
UNSTABLE = DOCUMENT | {
    "tuning": DOCUMENT["tuning"] | {"controller": {"kind": "state_feedback", "natural_frequency": 400.0}}
}


def test_json_over_http_is_the_document_of_the_core(http: httpx.Client) -> None:
    answer = http.post("/api/export", json=DOCUMENT)
    assert answer.headers["content-type"] == "application/json"
    assert answer.json() == controller_numbers(REALISTIC)


def test_the_archive_holds_the_c_files_of_the_core(http: httpx.Client) -> None:
    answer = http.post("/api/export", params={"form": "c"}, json=DOCUMENT)
    assert answer.headers["content-type"] == "application/zip"
    assert "vssea_controller.zip" in answer.headers["content-disposition"]
    held = zipfile.ZipFile(io.BytesIO(answer.content))
    assert {name: held.read(name) for name in held.namelist()} == {
        f"vssea_controller/{name}": content for name, content in c_files(REALISTIC).items()
    }


def test_the_mat_file_is_one_of_version_5(http: httpx.Client) -> None:
    answer = http.post("/api/export", params={"form": "mat"}, json=DOCUMENT)
    assert answer.content.startswith(b"MATLAB 5.0 MAT-file")


def test_the_live_tuning_is_exported_as_it_stands(session: httpx.Client) -> None:
    session.post("/api/session/tune", json={"changes": {"observer.bandwidth": 137.0}}).raise_for_status()
    live = session.get("/api/export").json()
    assert live["tuning"]["observer"]["bandwidth"] == 137.0
    scenario = Scenario.model_validate(session.get("/api/session").json()["scenario"])
    assert live == controller_numbers(scenario)


@pytest.mark.parametrize(
    ("parameters", "document", "words"),
    [
        ({"form": "cpp"}, DOCUMENT, "form"),
        ({}, {"duration_s": -1.0}, "duration_s is -1.0"),
        ({}, UNSTABLE, "would be stable"),
        ({"form": "c"}, UNSTABLE, "would be stable"),
    ],
    ids=["form", "value", "unstable", "unstable C"],
)
def test_what_cannot_be_exported_is_told_in_the_one_shape(
    http: httpx.Client, parameters: dict[str, str], document: dict[str, Any], words: str
) -> None:
    answer = http.post("/api/export", params=parameters, json=document)
    assert answer.status_code == 422
    assert answer.headers["content-type"] == "application/problem+json"
    assert words in answer.json()["detail"]


def vssea(*arguments: str, stdin: str = "") -> Any:
    return CliRunner().invoke(app, ["export", *arguments], input=stdin)


def test_the_command_writes_every_file(tmp_path: Path) -> None:
    folder = tmp_path / "new" / "folder"
    outcome = vssea("realistic", "-o", str(folder))
    assert outcome.exit_code == 0, outcome.stderr
    assert {file.name: file.read_bytes() for file in folder.iterdir()}.keys() == all_files(REALISTIC).keys()
    assert [Path(line) for line in outcome.stdout.split()] == [folder / name for name in all_files(REALISTIC)]
    assert json.loads((folder / "controller.json").read_text("utf-8")) == controller_numbers(REALISTIC)
    heading, *rows = csv.reader((folder / "test_vectors.csv").read_text().splitlines())
    assert heading[0] == "theta_l [rad]"
    assert len(rows) == 300


@pytest.mark.parametrize(
    ("arguments", "stdin", "words"),
    [
        (["nothing.json", "-o", "out"], "", "nothing.json cannot be read"),
        (["-", "-o", "out"], "{", "not JSON"),
        (["-", "-o", "out"], json.dumps(UNSTABLE), "would be stable"),
        (["nominal", "-o", "/dev/null/out"], "", "cannot be made"),
    ],
    ids=["file", "JSON", "unstable", "folder"],
)
def test_what_is_wrong_is_told_in_one_sentence_and_nothing_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], stdin: str, words: str
) -> None:
    monkeypatch.chdir(tmp_path)
    outcome = vssea(*arguments, stdin=stdin)
    assert outcome.exit_code == 2
    assert outcome.stdout == ""
    assert outcome.stderr.startswith("vssea: ")
    assert outcome.stderr.count("\n") == 1
    assert words in outcome.stderr
    assert not list(tmp_path.iterdir())
