"""Versioned documents: no update is lost, no version vanishes, and what was not meant is refused. On SQLite and PostgreSQL."""

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import pytest
import sqlalchemy as sa

from backend.problem import Problem
from backend.store import kept, listing, versioned
from backend.store.database import Database
from backend.store.document import Document, Draft, Edit
from backend.store.expected import ANY, NEW, Expected, Stale
from tests.backend.counting import NAME, count_up, draft, numbers, read

EACH = 500


def put(database: Database, name: str, made: Draft, expected: Expected | None = None) -> Document:
    with database.begin() as connection:
        return versioned.put(connection, "preset", name, made, expected)


def edit(database: Database, name: str, asked: Edit, expected: Expected | None = ANY) -> tuple[Document, str]:
    with database.begin() as connection:
        return versioned.edit(connection, "preset", name, asked, expected, "me")


def names(database: Database, search: str = "", tag: str = "", archived: bool = False) -> list[str]:
    with database.connect() as connection:
        return [each.name for each in listing.listed(connection, "preset", search, tag, archived=archived)]


def test_of_a_thousand_edits_by_two_threads_none_is_lost(database: Database, database_url: str) -> None:
    put(database, NAME, draft(0))
    with ThreadPoolExecutor(2) as clients:
        list(clients.map(lambda _: count_up(database_url, EACH), range(2)))
    assert numbers(database) == list(range(2 * EACH + 1))
    assert read(database)[1] == Expected(revisions=frozenset({f"1-{2 * EACH + 1}"}))


def test_of_a_thousand_edits_by_two_processes_none_is_lost(database: Database, database_url: str) -> None:
    put(database, NAME, draft(0))
    command = [sys.executable, "-m", "tests.backend.counting", database_url, str(EACH)]
    clients = [subprocess.Popen(command, stdout=subprocess.DEVNULL) for _ in range(2)]
    assert [client.wait(300.0) for client in clients] == [0, 0]
    assert numbers(database) == list(range(2 * EACH + 1))


def test_of_many_who_make_the_same_document_one_does(database: Database, database_url: str) -> None:
    database.open()

    def make(number: int) -> bool:
        own = Database(database_url)
        try:
            put(own, NAME, draft(number), NEW)
        except Exception as refusal:  # noqa: BLE001 - Stale, or Clash where the transactions overlap
            return type(refusal).__name__ not in ("Stale", "Clash")
        finally:
            own.close()
        return True

    with ThreadPoolExecutor(8) as clients:
        assert sum(clients.map(make, range(8))) == 1
    assert len(numbers(database)) == 1


def test_a_stale_edit_changes_nothing_and_names_the_revision_it_knew(database: Database) -> None:
    put(database, NAME, draft(1))
    put(database, NAME, draft(2), Expected.revision(1))
    with pytest.raises(Stale) as stale:
        put(database, NAME, draft(3), Expected.revision(1))
    assert (stale.value.known, stale.value.document.revision) == (1, 2)
    with pytest.raises(Stale):
        edit(database, NAME, Edit(tags=("a",), name="other"), Expected.revision(1))
    with pytest.raises(Stale):
        put(database, NAME, draft(3), NEW)
    assert numbers(database) == [1, 2]
    assert names(database) == [NAME]


def test_a_change_of_what_exists_needs_a_revision(database: Database) -> None:
    put(database, NAME, draft(1))
    with pytest.raises(
        Problem, match=r'at revision 1\. Say which revision you change, with If-Match: "1-1"'
    ) as problem:
        put(database, NAME, draft(2))
    assert problem.value.status == 428
    assert numbers(database) == [1]


def test_a_name_used_again_has_another_tag(database: Database) -> None:
    known = Expected(revisions=frozenset({put(database, "a", draft(1)).tag}))
    edit(database, "a", Edit(name="b"))
    assert put(database, "a", draft(2)).revision == 1
    with pytest.raises(Stale):
        put(database, "a", draft(3), known)


def test_versions_never_vanish(database: Database) -> None:
    put(database, NAME, draft(1))
    put(database, NAME, draft(2), ANY)
    edit(database, NAME, Edit(archived=True))
    assert (names(database), names(database, archived=True)) == ([], [NAME])
    assert numbers(database) == [1, 2]
    put(database, NAME, draft(3))  # under the same name it comes back with all that it was
    assert (names(database), names(database, archived=True)) == ([NAME], [])
    assert numbers(database) == [1, 2, 3]


def test_every_edit_counts_the_revision_and_one_that_changes_nothing_does_not(database: Database) -> None:
    put(database, NAME, draft(1))
    asked = Edit(tags=("soft", "slow"), note="of today", labels={1: "first"})
    document, words = edit(database, NAME, asked)
    assert (document.revision, document.tags, document.newest.note) == (2, ("slow", "soft"), "of today")
    assert words == "tags: slow, soft; note: of today; version 1 named first"
    again, words = edit(database, NAME, Edit(tags=("slow", "soft"), note="of today"))
    assert (again.revision, words) == (2, "")


def test_what_was_edited_since_a_revision_is_told(database: Database) -> None:
    document = put(database, NAME, draft(1))
    put(database, NAME, draft(2), ANY)
    edit(database, NAME, Edit(tags=("soft",)))
    with database.connect() as connection:
        assert versioned.edits_since(connection, document.id, 1) == (1, ["tags: soft"])
        assert versioned.edits_since(connection, document.id, 2) == (2, ["tags: soft"])
        assert versioned.edits_since(connection, document.id, 9) == (None, [])


def test_a_name_that_another_has_and_a_version_that_is_not_there_are_refused_whole(database: Database) -> None:
    put(database, "a", draft(1))
    put(database, "b", draft(1))
    with pytest.raises(Problem, match="There is a preset 'b' already"):
        edit(database, "a", Edit(name="b", tags=("new",)))
    with pytest.raises(Problem, match="Preset 'a' has no version 7; expected 1 to 1"):
        edit(database, "a", Edit(tags=("new",), labels={7: "x"}))
    assert names(database, tag="new") == []


@pytest.mark.parametrize(
    ("search", "found"),
    [
        ("SOFT", ["c", "a"]),
        ("soft 2", ["c"]),
        ("%", ["d 100%"]),
        ("_", []),
        ("heavier", ["b"]),
        ("nominal", ["c"]),
        ("", None),
    ],
)
def test_a_search_finds_every_word_wherever_it_stands(database: Database, search: str, found: list[str] | None) -> None:
    made = [("a", Draft("{}", "sum 1", None, "me", tags=("Soft",))), ("b", Draft("{}", "sum", None, "me")),
            ("c", Draft("{}", "sum 2", "nominal", "me", note="softly")), ("d 100%", Draft("{}", "", None, "you"))]  # fmt: skip
    for name, each in made:
        put(database, name, each)
    edit(database, "b", Edit(labels={1: "before the heavier link"}))
    assert names(database, search) == (["d 100%", "c", "b", "a"] if found is None else found)
    assert names(database, tag="Soft") == ["a"]


@pytest.mark.parametrize("count", [1, 30])
def test_a_list_is_one_statement_however_long(database: Database, count: int) -> None:
    for number in range(count):
        put(database, f"preset {number}", Draft("{}", "", None, "me", tags=("a", "b")))
    statements: list[str] = []
    sa.event.listen(database.engine, "before_cursor_execute", lambda *told: statements.append(told[2]))
    assert len(names(database, "preset", "a")) == count
    assert len([each for each in statements if each != "BEGIN"]) == 1


def test_a_kept_value_is_replaced(database: Database) -> None:
    assert kept.get(database, "last") is None
    for value in ({"a": 1}, {"a": [2, "θ"]}):
        kept.put(database, "last", value)
        assert kept.get(database, "last") == value
