"""What happened in a recording: the scenario at any time, the tunings, the events and the commands."""

import json
from typing import Any

from pydantic import ValidationError

from backend.recordings.layout import CHANGES, COMMANDS, EVENTS, SCENARIO
from backend.recordings.reader import SAME_INSTANT_S, Recording
from vssea_core.field_errors import field_errors, sentence_of
from vssea_core.scenario import Scenario

Document = dict[str, Any]


def scenario_document(recording: Recording, at_s: float | None = None) -> Document | None:
    """Return the scenario at the recording's begin, or as the changes up to `at_s` [s] left it; None if it is not known."""
    begun = recording.documents(SCENARIO)
    scenario: Document = dict(begun[0]["scenario"]) if begun and begun[0].get("scenario") else {}
    if not scenario:
        return None
    if at_s is not None:
        for change in recording.documents(CHANGES):
            if change["at_s"] <= at_s + SAME_INSTANT_S:
                scenario[change["part"]] = change["document"]
    return scenario


def known_scenario(recording: Recording, at_s: float | None = None) -> Scenario:
    """Return the scenario, validated. Raises ValueError if the recording has none, or one of another version that does not fit."""
    document = scenario_document(recording, at_s)
    if document is None:
        raise ValueError(
            f"{name_of(recording)} holds no scenario, as {_why_none(recording)}; choose a recording of the live session"
        )
    return validated(document, name_of(recording))


def validated(document: Document, whose: str) -> Scenario:
    """Return a document as a Scenario. Raises ValueError with one sentence if it does not fit."""
    try:
        return Scenario.model_validate_json(json.dumps(document))
    except ValidationError as error:
        words = sentence_of(field_errors(error, Scenario))
        raise ValueError(f"the scenario of {whose} does not fit this version: {words}") from error


def name_of(recording: Recording) -> str:
    """Return what a sentence calls the recording."""
    return recording.head.get("name") or recording.head.get("scenario") or recording.path.stem


def tunings(recording: Recording) -> list[Document]:
    """Return every change in force, with when, by whom and in words."""
    return [
        {name: change.get(name) for name in ("at_s", "tuning_id", "by", "part", "words")}
        for change in recording.documents(CHANGES)
    ]


def events(recording: Recording) -> list[Document]:
    """Return the events as the session's log has them."""
    return [
        {
            "number": event.get("number", 0), "wall_time": event.get("wall_time", ""), "epoch": event.get("epoch", 0),
            "time_s": event["at_s"], "kind": event.get("kind", ""), "text": event.get("message", ""),
            "by": event.get("by", ""), "severity": event.get("severity", "info"),
        }
        for event in recording.documents(EVENTS)
    ]  # fmt: skip


def commands(recording: Recording) -> list[Document]:
    """Return the commands, refused ones too."""
    return [{key: value for key, value in told.items() if key != "n"} for told in recording.documents(COMMANDS)]


def _why_none(recording: Recording) -> str:
    return "it was imported" if recording.head.get("origin") == "import" else "what it began with was not written"
