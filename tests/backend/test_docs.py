"""What the documents list is what the code has: settings, commands, routes, messages, channels and limits."""

import importlib
import json
import re
from pathlib import Path

import httpx
import pytest
from typer.main import get_command
from typer.testing import CliRunner

from backend.cli import app
from backend.settings import Settings
from vssea_core.channels import CHANNELS, LIMITS
from vssea_core.export.bundle import all_files
from vssea_core.export.ticks import INPUT_UNITS, OUTPUT_UNITS
from vssea_core.scenarios import NOMINAL

DOCS = Path(__file__).parents[2] / "docs"
PROTOCOL = (DOCS / "protocol.md").read_text("utf-8")


def table(text: str, heading: str) -> list[list[str]]:
    """The cells of the first table after `heading`, without its head."""
    lines = iter(text[text.index(heading) :].splitlines()[1:])
    rows = []
    for line in lines:
        if line.startswith("|"):
            rows.append([cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]])
        elif rows:
            break
    return rows[2:]


def quoted(text: str) -> set[str]:
    return set(re.findall(r"`([^`]+)`", text))


def test_every_setting_is_listed_with_its_option_default_and_meaning() -> None:
    rows = {row[0].strip("`"): row[1:] for row in table((DOCS / "settings.md").read_text("utf-8"), "# Settings")}
    assert list(rows) == [f"VSSEA_{name.upper()}" for name in Settings.model_fields]
    options = CliRunner().invoke(app, ["serve", "--help"], env={"COLUMNS": "200", "NO_COLOR": "1"}).stdout
    for name, field in Settings.model_fields.items():
        option, default, meaning = rows[f"VSSEA_{name.upper()}"]
        assert (option.strip("`") or "no option") == (f"--{name}" if f"--{name} " in options else "no option")
        assert meaning.startswith(str(field.description))
        if name not in (
            "data_dir",
            "database",
            "recordings_dir",
            "token",
            "batches_dir",
            "batch_workers",
            "batch_engine",
        ):
            shown = json.loads(default.strip("`")) if name not in ("host", "scenario") else default.strip("`")
            assert shown == (list(field.default) if isinstance(field.default, tuple) else field.default)


COMMAND_LINES = [
    (page.name, match[1].split("#")[0].strip())
    for page in (DOCS.parent / "README.md", *sorted(DOCS.glob("*.md")))
    for match in re.finditer(r"^    (?:\.venv/bin/)?vssea (.+)$", page.read_text("utf-8"), re.MULTILINE)
]


@pytest.mark.parametrize(("page", "line"), COMMAND_LINES)
def test_every_command_line_that_is_shown_names_commands_and_options_that_exist(page: str, line: str) -> None:
    words = line.split(">")[0].split()
    command = get_command(app)
    for word in words:
        inner = getattr(command, "commands", None)
        if inner is None or word.startswith("-"):
            break
        assert word in inner, f"{page}: there is no command {word} in vssea {line}"
        command = inner[word]
    options = {option for parameter in command.params for option in (*parameter.opts, *parameter.secondary_opts)}
    assert {word.split("=")[0] for word in words if word.startswith("-")} <= options


def test_every_command_is_in_the_protocol(http: httpx.Client) -> None:
    listed = [name for row in table(PROTOCOL, "## Commands") for name in sorted(quoted(row[0]))]
    assert sorted(listed) == sorted(http.get("/api/schema").json()["commands"])


def test_every_route_is_in_the_protocol(http: httpx.Client) -> None:
    served = {
        f"{method.upper()} {path}"
        for path, methods in http.get("/openapi.json").json()["paths"].items()
        for method in methods
    }
    listed = {entry.split("?")[0] for row in table(PROTOCOL, "## REST") for entry in quoted(row[0])}
    assert listed == served


@pytest.mark.parametrize(
    "name",
    ["hello", "state", "document", "event", "margins", "history", "pins", "trigger", "missed", "reply", "batches"],
)
def test_every_message_is_in_the_protocol(name: str) -> None:
    assert f'{{"type": "{name}"' in PROTOCOL


def test_every_parameter_of_a_query_is_in_the_protocol(http: httpx.Client) -> None:
    for path, methods in http.get("/openapi.json").json()["paths"].items():
        for details in methods.values():
            for parameter in details.get("parameters", []):
                assert parameter["name"] in PROTOCOL, f"{path}: {parameter['name']}"


def test_every_channel_and_limit_is_listed_in_order() -> None:
    text = (DOCS / "channels.md").read_text("utf-8")
    rows = table(text, "# Recorded channels")
    assert [[row[0], *(cell.strip("`") for cell in row[1:])] for row in rows] == [
        [str(number), channel.name, channel.symbol, channel.unit, channel.label, channel.group]
        for number, channel in enumerate(CHANNELS)
    ]
    limits = table(text, "## Limits")
    assert [[cell.strip("`") for cell in row] for row in limits] == [
        [str(limit.bit), limit.name, limit.sentence] for limit in LIMITS
    ]


def test_every_function_and_test_that_the_theory_names_exists() -> None:
    text = (DOCS / "theory.md").read_text("utf-8")
    named = {name for name in quoted(text) if name.startswith("vssea_core.")}
    assert len(named) > 40
    for name in named:
        module, _, function = name.rpartition(".")
        assert callable(getattr(importlib.import_module(module), function, None)), name
    tests = {name for name in quoted(text) if name.startswith("tests/")}
    assert len(tests) > 12
    for place in tests:
        file, _, function = place.partition("::")
        source = (DOCS.parent / file).read_text("utf-8")
        assert f"def {function}(" in source or not function, place


def test_every_input_and_output_of_the_exported_controller_is_listed_in_order() -> None:
    text = (DOCS / "export.md").read_text("utf-8")
    for heading, units in (("### Inputs", INPUT_UNITS), ("### Outputs", OUTPUT_UNITS)):
        rows = {row[0].strip("`"): row[1] for row in table(text, heading)}
        assert list(rows.items()) == list(units.items())


def test_every_file_of_an_export_is_listed() -> None:
    listed = [name for row in table((DOCS / "export.md").read_text("utf-8"), "# The tuned") for name in quoted(row[0])]
    assert {name.removeprefix("vssea_controller") for name in all_files(NOMINAL)} == {
        name.removeprefix("vssea_controller") for name in listed
    }
