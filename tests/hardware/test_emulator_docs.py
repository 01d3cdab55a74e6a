"""docs/emulator.md lists what the emulator has."""

import re
from pathlib import Path

from typer.testing import CliRunner

from backend.cli import app
from backend.emulator.faults import FAULTS
from tests.hardware.emulator_bench import Bench

TEXT = (Path(__file__).parents[2] / "docs" / "emulator.md").read_text("utf-8")


def test_every_fault_is_listed_with_its_usual_value() -> None:
    rows = dict(re.findall(r"^\| `([a-z_]+)` \|([^|]*)\|", TEXT, re.MULTILINE))
    assert set(rows) == set(FAULTS)
    for name, meaning in FAULTS.items():
        usual = re.search(r"\(([^()]+)\)$", meaning)
        if usual and rows[name].strip():
            assert f"({usual[1]})" in rows[name].replace("`", "")


def test_every_command_is_shown() -> None:
    shown = CliRunner().invoke(app, ["emulator", "--help"], env={"COLUMNS": "200", "NO_COLOR": "1"}).stdout
    commands = re.findall(r"^│ ([a-z]+) ", shown[shown.index("Commands") :], re.MULTILINE)
    assert sorted(commands) == ["clear", "fault", "faults", "load", "peaks", "state", "watch"]
    for command in commands:
        assert f"vssea emulator {command}" in TEXT


def test_every_peak_is_explained() -> None:
    for name in Bench().emulator.peaks():
        if name.startswith("peak_") or name in ("safe_after_s", "re_enabled"):
            assert f"`{name}`" in TEXT
