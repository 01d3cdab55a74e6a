"""Excerpts in the database are what was kept, after any restart."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from backend.recordings.excerpts import Excerpts
from backend.session.excerpt import Excerpt, ExcerptsInMemory, ExcerptStore
from backend.store.database import Database

PIN = Excerpt(
    "2026-11-22T09-15-03-123Z", "pin", "softer", 2.3, 12.3, "page 1", "2026-11-22T09:15:15.500Z", period_s=4.0,
    words=("g 60 → 100 rad/s",), metrics={"peak_error": 2.5e-3}, tuning={"observer": {"kind": "off"}},
)  # fmt: skip
CAPTURE = replace(PIN, kind="trigger", recording=None, at_s=5.25, shown=False, period_s=None, words=())


@pytest.fixture(params=["database", "memory"])
def store(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[ExcerptStore]:
    if request.param == "memory":
        yield ExcerptsInMemory()
        return
    database = Database(f"sqlite:///{tmp_path / 'vssea.sqlite'}")
    yield Excerpts(database)
    database.close()


def test_what_is_kept_comes_back_whole_in_order(store: ExcerptStore) -> None:
    kept = [store.add(PIN), store.add(CAPTURE)]
    assert [replace(each, id=0) for each in kept] == [PIN, CAPTURE]
    assert kept[0].id < kept[1].id
    assert store.list() == kept


def test_label_and_whether_it_is_shown_can_change(store: ExcerptStore) -> None:
    other, kept = store.add(CAPTURE), store.add(PIN)
    changed = replace(kept, label="best", shown=False)
    store.change(changed)
    assert store.list() == [other, changed]


def test_what_is_let_go_is_gone_and_the_rest_stays(store: ExcerptStore) -> None:
    kept = [store.add(PIN), store.add(CAPTURE)]
    store.remove(kept[0].id)
    store.remove(999)
    assert store.list() == kept[1:]


def test_a_restart_finds_them(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'vssea.sqlite'}"
    before = Database(url)
    kept = Excerpts(before).add(PIN)
    before.close()
    after = Database(url)
    assert Excerpts(after).list() == [kept]
    after.close()
