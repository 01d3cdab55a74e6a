"""The scenario document: every field refuses what it must in one clear sentence, and says what it means."""

import json
import math
import subprocess
import sys

import pytest
from pydantic import ValidationError

from tests.core.document_fields import Place, limits, places
from vssea_core.scenario import Scenario
from vssea_core.scenarios import SCENARIOS

ALL = list(places())
NUMERIC = [place for place in ALL if limits(place.field)]
CHOICES = [place for place in ALL if not limits(place.field) and place.name not in ("name", "description")]
numeric = pytest.mark.parametrize("place", NUMERIC, ids=lambda place: place.id)


def refusal(document: object) -> str:
    """The one sentence on the one thing that is wrong."""
    with pytest.raises(ValidationError) as caught:
        Scenario.model_validate(document)
    errors = caught.value.errors()
    assert len(errors) == 1, errors
    assert "\n" not in errors[0]["msg"]
    return f"{'.'.join(str(step) for step in errors[0]['loc'])}: {errors[0]['msg']}"


def test_the_walk_finds_the_whole_document() -> None:
    found = {place.id for place in ALL}
    assert len(NUMERIC) > 70
    assert {
        "actuator.link.inertia",
        "timing.sample_time_s",
        "tuning.controller.layer_width",
        "tuning.observer.velocity_filter",
        "tuning.model.spring_constant",
        "reference.fade_in_s",
        "stiffness_reference.target",
        "disturbances.link.0.phase",
        "disturbances.motor.0.end_s",
        "initial.link_position",
        "duration_s",
    } <= found


@numeric
def test_a_number_is_accepted_at_its_default_and_refused_outside_its_range(place: Place) -> None:
    low, high = limits(place.field) or (0.0, 0.0)
    Scenario.model_validate(place.document(place.field.default))
    step = 1 if place.field.annotation is int else max(1e-6, 1e-6 * abs(high))
    assert place.name in refusal(place.document(low - step))
    assert "greater than or equal to" in refusal(place.document(low - step))
    assert "less than or equal to" in refusal(place.document(high + step))


@numeric
def test_a_number_refuses_whatever_is_no_finite_number(place: Place) -> None:
    for wrong in (math.nan, math.inf, -math.inf, "1", "", True, [1.0], {}):
        sentence = refusal(place.document(wrong))
        assert place.name in sentence, wrong
        assert "Input should be" in sentence, wrong


@pytest.mark.parametrize("place", CHOICES, ids=lambda place: place.id)
def test_a_choice_refuses_an_unknown_word(place: Place) -> None:
    refusal(place.document("no such word"))


@numeric
def test_a_parameter_says_its_unit_title_and_meaning(place: Place) -> None:
    extra = place.field.json_schema_extra
    assert isinstance(extra, dict)
    assert isinstance(extra["unit"], str)
    assert place.field.title
    assert place.field.description, f"{place.owner.__name__}.{place.name} says nothing of what it means"
    assert extra["basis"] in ("D", "P", "E", "C")
    low, high = limits(place.field) or (0.0, 0.0)
    typical = extra["typical"]
    assert isinstance(typical, list)
    assert low <= typical[0] < typical[1] <= high
    if place.field.default is not None:
        assert low <= place.field.default <= high


def owners() -> list[Place]:
    first_of_part = {(place.path[:-1], place.owner): place for place in ALL}
    return list(first_of_part.values())


@pytest.mark.parametrize(
    "place", owners(), ids=lambda place: f"{place.owner.__name__} at {'.'.join(map(str, place.path[:-1]))}"
)
def test_an_unknown_name_is_refused_anywhere(place: Place) -> None:
    wrong = place._replace(path=(*place.path[:-1], "dampning"))
    assert "dampning: Extra inputs are not permitted" in refusal(wrong.document(1.0))


@pytest.mark.parametrize("part", ["tuning.controller", "tuning.observer", "reference", "stiffness_reference"])
def test_an_unknown_kind_is_refused_with_the_known_ones(part: str) -> None:
    document: dict[str, object] = {"kind": "magic"}
    for step in reversed(part.split(".")):
        document = {step: document}
    assert "'kind'" in refusal(document)
    assert "expected" in refusal(document)


REFUSED_TOGETHER = {
    "continuous torque .* above the peak torque": {"actuator": {"motor": {"continuous_torque": 80.0}}},
    "not below stiffest": {"actuator": {"stiffness": {"softest": 500.0, "stiffest": 400.0}}},
    "choose the position observer": {"sensors": {"velocities": False}},
    "expected 20 to 1000 N·m/rad, the end stops": {"stiffness_reference": {"kind": "constant", "stiffness": 10.0}},
    "stiffness_reference.target is 2000": {"stiffness_reference": {"kind": "move", "target": 2000.0}},
    "is not after start_s": {"disturbances": {"link": [{"kind": "constant", "start_s": 3.0, "end_s": 2.0}]}},
    "shorten it or lengthen timing.sample_time_s": {"duration_s": 100.0, "timing": {"sample_time_s": 1e-4}},
    "at most 16 items": {"disturbances": {"motor": [{"kind": "constant"}] * 17}},
}


@pytest.mark.parametrize("sentence", REFUSED_TOGETHER, ids=lambda sentence: sentence)
def test_parts_that_do_not_fit_are_refused_with_what_to_do(sentence: str) -> None:
    with pytest.raises(ValidationError, match=sentence):
        Scenario.model_validate(REFUSED_TOGETHER[sentence])


@pytest.mark.parametrize("scenario", SCENARIOS.values(), ids=SCENARIOS)
def test_a_document_comes_back_from_json_as_it_was(scenario: Scenario) -> None:
    assert Scenario.model_validate_json(scenario.model_dump_json()) == scenario
    assert Scenario.model_validate(json.loads(json.dumps(scenario.model_dump(mode="json")))) == scenario


def test_a_document_does_not_change_once_made() -> None:
    with pytest.raises(ValidationError, match="frozen"):
        Scenario().duration_s = 5.0  # type: ignore[misc]


def test_reading_a_document_brings_in_neither_the_compiler_nor_the_design_tools() -> None:
    program = "import sys, vssea_core.scenario, vssea_core.channels; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    loaded = {name.split(".")[0] for name in done.stdout.split()}
    assert "pydantic" in loaded
    assert not loaded & {"numba", "scipy", "control", "numpy"}
