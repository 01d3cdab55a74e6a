"""Presets as files: what is written is read back the same; what does not fit is named, and then nothing is kept."""

import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from backend.presets.contents import ACTUATOR, PRESET, ActuatorContent, PresetContent, live_actuator, live_preset
from backend.presets.documents import Documents
from backend.presets.exchange import exported, keep, read
from backend.problem import Problem
from backend.store.database import Database
from backend.store.document import Edit
from backend.store.expected import ANY
from vssea_core.control.tuning import NoObserver, PositionObserver, StateFeedback, Tuning, VelocityObserver
from vssea_core.scenarios import NOMINAL, SCENARIOS

words = st.text(st.characters(exclude_categories=["C"], exclude_characters="/\\,"), min_size=1, max_size=12).filter(
    lambda text: text.strip(".")
)
tunings = st.builds(
    Tuning,
    controller=st.builds(StateFeedback, natural_frequency=st.floats(0.5, 500.0), damping=st.floats(0.2, 2.0)),
    observer=st.one_of(
        st.builds(VelocityObserver, bandwidth=st.floats(1.0, 2000.0)),
        st.builds(PositionObserver, bandwidth=st.floats(1.0, 2000.0), predict=st.booleans()),
        st.just(NoObserver()),
    ),
)
contents = st.builds(PresetContent, tuning=tunings, scenario=st.sampled_from([None, *SCENARIOS.values()]))
libraries = st.dictionaries(
    words, st.tuples(st.lists(contents, min_size=1, max_size=3), st.sets(words, max_size=2), st.text(max_size=20), st.booleans()),
    max_size=3,
)  # fmt: skip


def of(folder: Path, name: str = "vssea") -> Documents:
    return Documents(Database(f"sqlite:///{folder / name}.sqlite"), PRESET)


@pytest.fixture
def presets(database: Database) -> Documents:
    return Documents(database, PRESET)


def file_of(presets: Documents) -> dict[str, Any]:
    return dict(json.loads(exported(presets, None, all_versions=True)))


@settings(max_examples=20, deadline=None)
@given(library=libraries)
def test_an_export_imported_elsewhere_is_the_same_export(
    tmp_path_factory: pytest.TempPathFactory, library: Any
) -> None:
    folder = tmp_path_factory.mktemp("stores")
    here, there = of(folder, "here"), of(folder, "there")
    for name, (versions, tags, note, archived) in library.items():
        for content in versions:
            here.put(name, content, ANY, "me", note, tuple(tags))
        here.edit(name, Edit(labels={1: "first"}, archived=archived), ANY, "me")
    file = file_of(here)
    keep(there, read(there, file), "REST")
    assert file_of(there)["presets"] == file["presets"]
    keep(there, read(there, file), "REST")  # what is there already is not kept twice
    assert file_of(there)["presets"] == file["presets"]
    for documents in (here, there):
        documents.database.close()


def test_new_versions_of_a_known_preset_are_added_and_its_own_stay(presets: Documents) -> None:
    for number in (1, 2):
        presets.put("a", live_preset(NOMINAL, number, "me"), ANY, "me", f"note {number}")
    file = file_of(presets)
    file["presets"][0]["versions"][0] |= {"saved_at": "2020-01-01T00:00:00.000Z", "note": "of another machine"}
    (incoming,) = read(presets, file)
    assert (incoming.exists, incoming.document()["new"]) == (True, 1)
    (found,) = keep(presets, [incoming], "REST")
    assert (found.document.count, found.version.number, found.version.note) == (3, 3, "of another machine")


def test_every_field_of_a_hand_written_file_that_does_not_fit_is_named(presets: Documents) -> None:
    by_hand = {
        "name": "mine",
        "tuning": {"observer": {"kind": "position", "bandwidth": 80.0, "band": 3}, "colour": "red"},
    }
    (incoming,) = read(presets, by_hand)
    told = incoming.document()
    assert told["unknown"] == ["tuning.colour", "tuning.observer.band"]
    assert {"scenario", "tuning.controller", "tuning.observer.shape"} <= set(told["missing"])
    assert (told["refused"], told["new"], presets.list()) == ([], 1, [])
    (found,) = keep(presets, [incoming], "REST")
    assert found.part == Tuning(observer=PositionObserver(bandwidth=80.0))
    assert found.content.provenance.source == "import"


@pytest.mark.parametrize(
    ("tuning", "field", "words"),
    [
        (
            {"observer": {"kind": "position", "bandwidth": 1e6}},
            "tuning.observer.bandwidth",
            "a number from 1 to 2000 rad/s",
        ),
        ({"observer": {"bandwidth": 10.0}}, "tuning.observer.kind", "missing"),
        ({"observer": {"kind": "magic"}}, "tuning.observer.kind", "'velocity'"),
        ({"model": 5}, "tuning.model", "object"),
        ({"schedule": {"poles_exponent": "0.5"}}, "tuning.schedule.poles_exponent", "from -1 to 1"),
    ],
    ids=str,
)
def test_a_refused_field_anywhere_keeps_the_whole_file_out(
    presets: Documents, tuning: dict[str, Any], field: str, words: str
) -> None:
    file = [{"name": "good", "tuning": {}}, {"name": "bad", "tuning": tuning}]
    incoming = read(presets, file)
    assert [each["field"] for each in incoming[1].document()["refused"]] == [field]
    with pytest.raises(Problem, match="Nothing was imported") as problem:
        keep(presets, incoming, "REST")
    (error,) = problem.value.errors
    assert error.field == f"bad: {field}"
    assert words in error.message
    assert presets.list() == []


@pytest.mark.parametrize(
    ("file", "words"),
    [
        (5, "no preset"),
        ({"format": "vssea-actuator", "actuators": []}, "its format is 'vssea-actuator'; expected vssea-preset"),
        ({"format": "vssea-preset", "schema": 2, "presets": []}, "newer version: its schema is 2"),
        ({"name": "x"}, "holds no tuning"),
        ({"tuning": {}}, "name is None"),
        ({"presets": [{"name": "a/b", "versions": [{"content": {}}]}]}, "presets.0.name is 'a/b'"),
        ({"presets": [{"name": "a", "versions": []}]}, "presets.0.versions"),
    ],
    ids=str,
)
def test_a_file_of_something_else_is_refused_in_one_sentence(presets: Documents, file: Any, words: str) -> None:
    with pytest.raises(Problem) as problem:
        read(presets, file)
    assert words in problem.value.detail
    assert presets.list() == []


def test_the_list_of_the_first_versions_is_read_with_its_times(presets: Documents) -> None:
    old = [{"name": "a", "saved_at": "2025-05-05T05:05:05.000Z", "tuning": Tuning().model_dump(mode="json")}]
    keep(presets, read(presets, old), "REST")
    assert [(line["name"], line["saved_at"]) for line in presets.list()] == [("a", "2025-05-05T05:05:05.000Z")]


def test_an_actuator_goes_through_a_file_with_all_that_is_known_of_it(database: Database, tmp_path: Path) -> None:
    content = live_actuator(SCENARIOS["realistic"]).model_dump(mode="json")
    content["provenance"]["motor.inertia"] = {"source": "measured", "note": "swing test", "uncertainty": 0.04}
    content["calibration"] = [{"stiffness_motor_position": 67.7, "stiffness": 99.0, "note": "cold"}]
    here = Documents(database, ACTUATOR)
    here.put("rig", ActuatorContent.model_validate(content), None, "me")
    there = Documents(Database(f"sqlite:///{tmp_path / 'other.sqlite'}"), ACTUATOR)
    keep(there, read(there, json.loads(exported(here, "rig", all_versions=False))), "REST")
    assert there.get("rig").raw == content
    there.database.close()
