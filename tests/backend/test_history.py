"""Laws of the history, on documents of any shape: undo and redo are inverse, and nothing that was made is lost."""

from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from backend.session.history import QUIET_S, Entry, History, Pairs, Stamp

Document = dict[str, Any]
PARTS = ("tuning", "reference")
documents = st.fixed_dictionaries(
    {part: st.dictionaries(st.sampled_from("abc"), st.integers(0, 3), max_size=3) for part in PARTS}
)
changes = st.tuples(
    st.sampled_from(PARTS), st.sampled_from("abc"), st.integers(0, 3), st.sampled_from(["page 1", "page 2"])
)
STAMP = Stamp("2026-01-01T00:00:00.000Z", 1, 0.0, 1)


class Desk:
    """Someone who changes a document through a history, as the session does."""

    def __init__(self, document: Document, kept: int = 200) -> None:
        self.now, self.time_s = document, 0.0
        self.heard: dict[int, Document] = {}
        self.history: History[Document] = History(self._hear, lambda: self.time_s, kept)

    def _hear(self, entries: list[Entry[Document]]) -> None:
        self.heard |= {entry.number: entry.document() for entry in entries}

    def change(self, part: str, path: str, value: Any, by: str = "page 1", after_s: float = 1.0) -> bool:
        """Change one field; return whether that was a change."""
        self.time_s += after_s
        before = self.now
        if before[part].get(path) == value:
            return False
        self.now = before | {part: before[part] | {path: value}}
        pairs: Pairs = {path: (before[part].get(path), value)}
        self.history.record(
            by, part, pairs, before, self.now, STAMP, lambda found: [f"{p} {v}" for p, v in found.items()]
        )
        return True

    def undo(self) -> None:
        entry = self.history.undo()
        self.now = self.now | {entry.part: entry.before[entry.part]}

    def redo(self) -> None:
        entry = self.history.redo()
        self.now = self.now | {entry.part: entry.after[entry.part]}

    def listed(self) -> list[Document]:
        return self.history.last(1000)


@given(documents, st.lists(changes, max_size=12), st.integers(0, 12))
def test_undo_then_redo_is_the_identity(document: Document, made: list[Any], back: int) -> None:
    desk = Desk(document)
    states = [document, *(desk.now for change in made if desk.change(*change))]
    steps = min(back, len(states) - 1)
    for step in range(1, steps + 1):
        desk.undo()
        assert desk.now == states[-1 - step]
    for step in range(steps - 1, -1, -1):
        desk.redo()
        assert desk.now == states[-1 - step]
    assert desk.history.redoable is None
    assert not any(entry["undone"] for entry in desk.listed())


@given(documents, st.lists(changes, max_size=12))
def test_undo_of_everything_is_the_beginning(document: Document, made: list[Any]) -> None:
    desk = Desk(document)
    for change in made:
        desk.change(*change)
    while desk.history.undoable:
        desk.undo()
    assert desk.now == document
    assert all(entry["undone"] for entry in desk.listed())


@given(documents, st.lists(st.one_of(changes, st.sampled_from(["undo", "redo", "save"])), max_size=30))
def test_whatever_is_done_what_pages_heard_is_what_the_server_lists(document: Document, done: list[Any]) -> None:
    desk = Desk(document)
    for act in done:
        if act == "undo" and desk.history.undoable:
            desk.undo()
        elif act == "redo" and desk.history.redoable:
            desk.redo()
        elif act == "save":
            desk.history.save_point("here", "page 1", desk.now, STAMP)
        elif not isinstance(act, str):
            desk.change(*act)
    assert list(desk.heard.values()) == desk.listed()
    numbers = [entry["number"] for entry in desk.listed()]
    assert numbers == sorted(set(numbers))


@given(documents, st.lists(changes, min_size=1, max_size=8))
def test_save_points_survive_undo_and_hold_their_state(document: Document, made: list[Any]) -> None:
    desk = Desk(document)
    for change in made:
        desk.change(*change)
    state = desk.now
    saved = desk.history.save_point("good", "page 1", state, STAMP)
    while desk.history.undoable:
        desk.undo()
    found = desk.history.entry(saved.number)
    assert found is not None
    assert (found.after, found.undone, found.save_point) == (state, False, "good")


def test_a_change_after_an_undo_drops_what_could_be_redone_but_keeps_it_listed() -> None:
    desk = Desk({"tuning": {"a": 0}, "reference": {}})
    desk.change("tuning", "a", 1)
    desk.change("tuning", "a", 2)
    desk.undo()
    desk.change("tuning", "b", 5)
    assert desk.history.redoable is None
    assert [entry["undone"] for entry in desk.listed()] == [False, True, False]
    desk.undo()
    desk.undo()
    assert desk.now["tuning"] == {"a": 0}


def test_a_drag_is_one_entry_from_its_first_value_to_its_last() -> None:
    desk = Desk({"tuning": {"a": 0}, "reference": {}})
    for value in range(1, 30):
        desk.change("tuning", "a", value, after_s=0.03)
    (entry,) = desk.listed()
    assert entry["changes"] == {"a": [0, 29]}
    desk.undo()
    assert desk.now["tuning"] == {"a": 0}


def test_what_another_page_another_field_or_a_rest_parts_is_not_one_drag() -> None:
    desk = Desk({"tuning": {"a": 0}, "reference": {"a": 0}})
    desk.change("tuning", "a", 1, "page 1", 0.03)
    desk.change("tuning", "a", 2, "page 2", 0.03)
    desk.change("tuning", "b", 3, "page 2", 0.03)
    desk.change("reference", "a", 4, "page 2", 0.03)
    desk.change("reference", "a", 5, "page 2", QUIET_S + 0.01)
    desk.history.save_point("here", "page 2", desk.now, STAMP)
    desk.change("reference", "a", 6, "page 2", 0.03)
    assert len(desk.listed()) == 7


@pytest.mark.parametrize(
    ("before", "after", "is_drag"),
    [
        (1.0, 2.0, True), (None, 2.0, True), (True, False, False), ("sgn", "tanh", False),
        ([{"kind": "sine", "amplitude": 1.0}], [{"kind": "sine", "amplitude": 2.0}], True),
        ([{"kind": "sine", "amplitude": 1.0}], [{"kind": "constant", "torque": 2.0}], False),
        ([], [{"kind": "sine", "amplitude": 1.0}], False),
    ],
)  # fmt: skip
def test_only_numbers_are_dragged(before: Any, after: Any, is_drag: bool) -> None:
    desk = Desk({"tuning": {"a": before}, "reference": {}})
    desk.change("tuning", "a", after)
    desk.change("tuning", "a", before, after_s=0.03)
    assert (len(desk.listed()) == 1) is is_drag


def test_what_was_redone_is_not_joined_with_the_next_drag() -> None:
    desk = Desk({"tuning": {"a": 0}, "reference": {}})
    desk.change("tuning", "a", 1, after_s=0.03)
    desk.undo()
    desk.redo()
    desk.change("tuning", "a", 2, after_s=0.03)
    assert [entry["changes"] for entry in desk.listed()] == [{"a": [0, 1]}, {"a": [1, 2]}]


@settings(max_examples=30)
@given(st.integers(1, 20), st.integers(0, 60))
def test_memory_is_bounded_and_the_newest_stay_undoable(kept: int, count: int) -> None:
    desk = Desk({"tuning": {"a": 0}, "reference": {}}, kept)
    desk.history.save_point("start", "server", desk.now, STAMP)
    for value in range(1, count + 1):
        desk.change("tuning", "a", value)
    assert len(desk.listed()) <= kept
    if kept > 1:
        assert desk.listed()[0]["save_point"] == "start"
    for value in range(count, max(0, count - kept + 1), -1):
        assert desk.now["tuning"]["a"] == value
        desk.undo()
