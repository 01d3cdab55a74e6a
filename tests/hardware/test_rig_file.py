"""The file of a rig: what it must say, where it is kept, and that its document and example are right."""

import re
from pathlib import Path

import pytest
from pydantic import BaseModel
from typer.testing import CliRunner

from backend.cli import app
from backend.problem import Problem
from backend.rigs import rig_file as model
from backend.rigs.check import check_rig
from backend.rigs.library import BUILT_IN, RigLibrary, example_text, rig_file_of
from backend.rigs.rig_file import RigFile

DOCUMENT = (Path(__file__).parents[2] / "docs" / "rig-file.md").read_text("utf-8")
SECTIONS: dict[str, type[BaseModel]] = {
    "## Rig": model.RigFile,
    "## [bus]": model.Bus,
    "## [motor] and [stiffness]": model.Drive,
    "## [link]": model.LinkEncoder,
    "## [limits]": model.Limits,
    "## [homing]": model.Homing,
}


def rows(heading: str) -> list[list[str]]:
    """The cells of the first table after `heading`, without its head."""
    lines = DOCUMENT[DOCUMENT.index(f"\n{heading}\n") :].splitlines()[2:]
    first = next(number for number, line in enumerate(lines) if line.startswith("|"))
    found = []
    for line in lines[first + 2 :]:
        if not line.startswith("|"):
            break
        found.append([cell.strip() for cell in line.strip("|").split("|")])
    return found


@pytest.mark.parametrize("heading", SECTIONS)
def test_every_field_is_listed_with_its_default_and_meaning(heading: str) -> None:
    fields = SECTIONS[heading].model_fields
    listed = rows(heading)
    assert [row[0].strip("`") for row in listed] == list(fields)
    for (_, default, meaning), field in zip(listed, fields.values(), strict=True):
        assert meaning == field.description
        if field.is_required():
            assert default == "needed"
        elif field.default is None:
            assert default == "none"
        elif isinstance(field.default, BaseModel):
            assert default == "as below"
        elif isinstance(field.default, bool):
            assert default == f"`{str(field.default).lower()}`"
        elif isinstance(field.default, int | float):
            assert float(int(default.strip("`"), 16) if "0x" in default else default.strip("`")) == field.default
        else:
            assert default.strip("`").strip('"') in (str(field.default), "[]", "{}")


def test_the_example_is_a_rig_file_in_which_every_field_is_named() -> None:
    rig_file_of(example_text())
    for part in SECTIONS.values():
        for name in part.model_fields:
            if name not in ("span_tolerance", "still_s", "time_limit_s", "device_type", "subindex"):
                assert re.search(rf"^(# )?\[?{name}\b", example_text(), re.MULTILINE), name


def with_change(old: str, new: str) -> str:
    text = example_text()
    assert old in text
    return text.replace(old, new, 1)


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("node = 1\n", "node = 200\n", "motor.node is 200"),
        ("torque_limit = 74.0", "torqe_limit = 74.0", "known here: node, device_type, vendor"),
        ("node = 2\n", "node = 1\n", "nodes 1, 1, 3 are not all different"),
        (
            'source = "node"',
            'source = "motor_drive"',
            "link.node is needed where link.source is 'node', and only there",
        ),
        ("link_low = -1.5", "link_low = 2.0", "limits.link_low 2 rad is not below link_high 1.5 rad"),
        ("# without = [0x6007]", "without = [0x6040]", "motor.without"),
        ("rate_hz = 500", "rate_hz = ", "The file is no TOML.*line"),
    ],
)
def test_a_wrong_file_is_refused_in_a_sentence_and_what_was_kept_stays(
    old: str, new: str, sentence: str, tmp_path: Path
) -> None:
    library = RigLibrary(tmp_path / "rigs")
    library.put("bench", example_text())
    with pytest.raises(Problem, match=sentence) as refusal:
        library.put("bench", with_change(old, new))
    assert refusal.value.status == 422
    assert library.get("bench").text == example_text()
    assert [path.name for path in library.folder.iterdir()] == ["bench.toml"]


@pytest.mark.parametrize("name", BUILT_IN)
def test_a_built_in_rig_is_always_there_first_and_never_changed(name: str, tmp_path: Path) -> None:
    library = RigLibrary(tmp_path / "rigs")
    assert [(entry.name, entry.builtin) for entry in library.list()] == [(each, True) for each in BUILT_IN]
    library.put("bench", example_text())
    assert [entry.name for entry in library.list()] == [*BUILT_IN, "bench"]
    with pytest.raises(Problem, match="built-in"):
        library.put(name, example_text())
    with pytest.raises(Problem, match="built-in"):
        library.delete(name)
    (library.folder / f"{name}.toml").write_text(example_text())
    assert library.file(name).name == name
    assert [entry.name for entry in library.list()] == [*BUILT_IN, "bench"]


def test_a_simulated_rig_needs_no_bus_to_be_checked(tmp_path: Path) -> None:
    assert [line["ok"] for line in check_rig(RigLibrary(tmp_path).file("simulated"))] == [True]


def test_a_rig_is_listed_as_the_page_needs_it(tmp_path: Path) -> None:
    document = RigLibrary(tmp_path).get("emulator").document()
    assert document["address"] == "can0 at 127.0.0.1:29536"
    assert (document["interface"], document["rate_hz"], document["builtin"]) == ("socketcand", 500, True)
    assert RigFile.model_validate(document["file"]).motor.node == 1


def test_a_file_that_cannot_be_used_is_listed_with_the_reason(tmp_path: Path) -> None:
    library = RigLibrary(tmp_path)
    (tmp_path / "broken.toml").write_text("name = 'broken'\n")
    (tmp_path / "other.toml").write_text(example_text())
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe")
    entries = {entry.name: entry for entry in library.list()}
    assert "missing" in str(entries["broken"].problem)
    assert "name is 'bench', expected 'other'" in str(entries["other"].problem)
    assert "cannot be read" in str(entries["binary"].problem)
    with pytest.raises(Problem, match=r"Rig broken cannot be used: .*missing"):
        library.file("broken")


def test_a_file_of_another_name_and_an_unknown_name_are_refused(tmp_path: Path) -> None:
    library = RigLibrary(tmp_path)
    with pytest.raises(Problem, match="The file's name is 'bench', expected 'other'"):
        library.put("other", example_text())
    with pytest.raises(Problem, match="There is no rig 'other'; known: emulator") as refusal:
        library.delete("other")
    assert refusal.value.status == 404
    library.put("bench", example_text())
    library.delete("bench")
    assert not (tmp_path / "bench.toml").exists()


def test_the_command_writes_the_example_as_it_is() -> None:
    assert CliRunner().invoke(app, ["rig", "example"]).stdout == example_text()


def test_the_command_refuses_what_is_no_rig(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VSSEA_DATA_DIR", str(tmp_path))
    for which, sentence in (
        ("nowhere.toml", "cannot be read"),
        ("nobody", "There is no rig 'nobody'; known: emulator"),
    ):
        result = CliRunner().invoke(app, ["rig", "check", which])
        assert result.exit_code == 2
        assert sentence in result.stderr
