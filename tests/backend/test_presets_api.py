"""Presets over REST and the live websocket: versions, revisions, differences, and applying only what differs."""

import json
import sqlite3
from contextlib import closing
from typing import Any

import httpx
import pytest

from tests.backend.live_page import LivePage
from tests.backend.server import Server
from tests.backend.test_api_errors import problem_of

NAME = "tracking v4 · θ"


def tune(http: httpx.Client, **changes: Any) -> None:
    named = {path.replace("__", "."): value for path, value in changes.items()}
    http.post("/api/session/tune", json={"changes": named}).raise_for_status()


def live(http: httpx.Client) -> dict[str, Any]:
    return dict(http.get("/api/session").json()["scenario"]["tuning"])


def save(http: httpx.Client, name: str = NAME, etag: str | None = None, **body: Any) -> httpx.Response:
    return http.put(f"/api/presets/{name}", json=body, headers={"If-Match": etag} if etag else {})


def fresh(http: httpx.Client, name: str = NAME) -> str:
    """A preset of two versions that no other test has used; returns its ETag."""
    tune(http, observer__bandwidth=100.0)
    first = http.put(f"/api/presets/{name}", json={"note": "as found"}, headers={"If-None-Match": "*"})
    first.raise_for_status()
    tune(http, observer__bandwidth=60.0)
    second = save(http, name, first.headers["etag"])
    second.raise_for_status()
    return str(second.headers["etag"])


def test_saving_again_makes_a_version_and_the_list_shows_the_newest(session: httpx.Client) -> None:
    etag = fresh(session, "list")
    (line,) = session.get("/api/presets", params={"search": "list"}).json()
    assert (line["name"], line["etag"], line["scenario"], line["archived"]) == ("list", etag, "nominal", False)
    assert line["summary"] == "state feedback, poles 20 rad/s; velocity observer 60 rad/s"
    whole = session.get("/api/presets/list").json()
    assert [version["number"] for version in whole["versions"]][-2:] == [line["version"] - 1, line["version"]]
    assert whole["content"]["tuning"] == live(session)
    assert whole["content"]["scenario"]["name"] == "nominal"
    assert whole["content"]["provenance"] | {"at_s": 0, "vssea": ""} == {
        "source": "live", "vssea": "", "recording": None, "at_s": 0, "by": "REST",
    }  # fmt: skip
    assert whole["fit"] == {"unknown": [], "missing": [], "refused": []}
    old = session.get("/api/presets/list", params={"version": line["version"] - 1}).json()
    assert (old["content"]["tuning"]["observer"]["bandwidth"], old["note"]) == (100.0, "as found")


def test_what_others_changed_meanwhile_is_said_and_kept(session: httpx.Client) -> None:
    etag = fresh(session)
    tune(session, observer__bandwidth=75.0, controller__natural_frequency=25.0)
    other = save(session, etag=etag, author="someone else")
    session.patch(
        f"/api/presets/{NAME}", json={"tags": ["theirs"]}, headers={"If-Match": other.headers["etag"]}
    ).raise_for_status()
    tune(session, observer__bandwidth=80.0)
    answer = save(session, etag=etag)
    problem = answer.json()
    assert (answer.status_code, problem["title"]) == (412, "Changed meanwhile")
    changes = problem["current"]["changes"]
    assert sorted(changes) == ["g 60 → 75 rad/s", "p 20 → 25 rad/s", "tags: theirs"]
    assert all(words in problem["detail"] for words in (*changes, "someone else", "Nothing was saved."))
    now = session.get(f"/api/presets/{NAME}").json()
    assert (now["version"], now["revision"]) == (problem["current"]["version"], problem["current"]["revision"])
    assert now["content"]["tuning"]["observer"]["bandwidth"] == 75.0
    assert save(session, etag=problem["current"]["etag"]).status_code == 200


@pytest.mark.parametrize("method", ["PUT", "PATCH", "POST"])
def test_a_change_without_a_revision_is_refused_and_one_with_star_is_not(session: httpx.Client, method: str) -> None:
    fresh(session)
    path = f"/api/presets/{NAME}" + ("/versions/1/restore" if method == "POST" else "")
    body = {"tags": [method]} if method == "PATCH" else {}
    before = session.get("/api/presets").json()
    assert problem_of(session.request(method, path, json=body), 428)["title"] == "Revision needed"
    assert session.get("/api/presets").json() == before
    assert session.request(method, path, json=body, headers={"If-Match": "*"}).status_code == 200


def test_an_etag_of_a_get_serves_and_what_is_none_is_refused(session: httpx.Client) -> None:
    fresh(session)
    etag = session.get(f"/api/presets/{NAME}").headers["etag"]
    problem_of(save(session, etag="yesterday"), 422)
    assert save(session, etag=f'"0-1", W/{etag}').status_code == 200
    answer = session.put(f"/api/presets/{NAME}", json={}, headers={"If-None-Match": "*"})
    assert answer.status_code == 412
    problem_of(save(session, "never saved", etag=etag), 412)


def test_a_difference_leads_from_what_runs_a_version_or_another_preset(session: httpx.Client) -> None:
    fresh(session, "one")
    tune(session, observer__bandwidth=150.0, controller__kind="sliding_mode", controller__switching_gain=7e4)
    save(session, "other").raise_for_status()
    found = session.get("/api/presets/one/difference").json()
    assert [(each["path"], each["from"], each["to"]) for each in found["changes"]] == [
        ("controller.kind", "sliding_mode", "state_feedback"), ("observer.bandwidth", 150.0, 60.0),
    ]  # fmt: skip
    assert found["changes"][1] | {"from": 0, "to": 0} == {
        "path": "observer.bandwidth", "label": "bandwidth", "symbol": "g", "unit": "rad/s", "from": 0, "to": 0,
        "words": "g 150 → 60 rad/s",
    }  # fmt: skip
    newest = session.get("/api/presets/one").json()["version"]
    older = session.get("/api/presets/one/difference", params={"against": newest - 1}).json()
    assert [each["words"] for each in older["changes"]] == ["g 100 → 60 rad/s"]
    back = session.get("/api/presets/other/difference", params={"against": "one"}).json()
    assert [(each["path"], each["from"], each["to"]) for each in back["changes"]] == [
        ("controller.kind", "state_feedback", "sliding_mode"), ("controller.switching_gain", None, 7e4),
        ("observer.bandwidth", 60.0, 150.0),
    ]  # fmt: skip
    assert session.get("/api/presets/one/difference", params={"against": "one"}).json()["same"]


def test_only_what_differs_is_sent_and_another_change_meanwhile_stays(session: httpx.Client) -> None:
    fresh(session)
    tune(session, controller__natural_frequency=30.0, schedule__poles_exponent=0.25)
    applied = session.post(f"/api/presets/{NAME}/apply", json={"version": 1, "paths": ["observer.bandwidth"]}).json()
    assert applied["applied"] == {"observer.bandwidth": 100.0}
    assert (live(session)["controller"]["natural_frequency"], live(session)["schedule"]["poles_exponent"]) == (
        30.0,
        0.25,
    )
    number = applied["tuning_id"]
    applied = session.post(f"/api/presets/{NAME}/apply", json={"version": 1}).json()
    assert applied["applied"] == {"controller.natural_frequency": 20.0, "schedule.poles_exponent": 0.0}
    assert applied["tuning_id"] == number + 1
    again = session.post(f"/api/presets/{NAME}/apply", json={"version": 1}).json()
    assert again == {"tuning_id": number + 1, "applied": {}}


def test_another_kind_comes_with_its_values_in_one_change(session: httpx.Client) -> None:
    changes = {
        "controller.kind": "sliding_mode",
        "controller.switching_gain": 3e4,
        "observer.kind": "position",
        "observer.bandwidth": 90.0,
    }
    session.post("/api/session/tune", json={"changes": changes}).raise_for_status()
    saved = live(session)
    save(session, "kinds").raise_for_status()
    session.post("/api/session/load_scenario", json={"name": "nominal"}).raise_for_status()
    before = session.get("/api/session").json()["tuning_id"]
    part = session.post("/api/presets/kinds/apply", json={"paths": ["controller.switching_gain"]})
    assert "choose it too" in problem_of(part, 422)["errors"][0]["message"]
    applied = session.post("/api/presets/kinds/apply", json={}).json()
    assert live(session) == saved
    assert applied["tuning_id"] == before + 1


def test_a_path_that_does_not_differ_is_refused(session: httpx.Client) -> None:
    fresh(session)
    problem = problem_of(
        session.post(f"/api/presets/{NAME}/apply", json={"version": 1, "paths": ["model.link_inertia"]}), 422
    )
    assert problem["errors"][0] == {
        "field": "model.link_inertia", "value": None, "message": "it does not differ; what differs: observer.bandwidth",
    }  # fmt: skip
    assert live(session)["observer"]["bandwidth"] == 60.0


def test_a_restored_version_is_the_newest_and_the_others_stay(session: httpx.Client) -> None:
    etag = fresh(session, "restored")
    labelled = session.patch("/api/presets/restored", json={"labels": {"1": "soft link"}}, headers={"If-Match": etag})
    answer = session.post(
        "/api/presets/restored/versions/1/restore", headers={"If-Match": labelled.headers["etag"]}
    ).json()
    assert (answer["version"], answer["note"]) == (3, "version 1 “soft link” restored")
    assert answer["content"]["tuning"]["observer"]["bandwidth"] == 100.0
    assert answer["content"]["provenance"]["source"] == "restored"
    assert [version["label"] for version in answer["versions"]] == ["soft link", None, None]
    assert live(session)["observer"]["bandwidth"] == 60.0
    problem_of(session.post("/api/presets/restored/versions/9/restore", headers={"If-Match": "*"}), 404)


def test_an_archived_preset_is_found_in_the_archive_and_comes_back(session: httpx.Client) -> None:
    fresh(session, "old")
    session.delete("/api/presets/old").raise_for_status()
    assert session.get("/api/presets").json() == []
    assert "old" in [line["name"] for line in session.get("/api/presets", params={"archived": True}).json()]
    etag = session.get("/api/presets/old").headers["etag"]
    back = session.patch(
        "/api/presets/old", json={"archived": False, "name": "old and new"}, headers={"If-Match": etag}
    )
    assert (back.json()["name"], back.json()["archived"]) == ("old and new", False)
    problem_of(session.get("/api/presets/old"), 404)


@pytest.mark.parametrize(
    ("body", "field"),
    [
        ({"tuning": {"observer": {"kind": "velocity", "bandwidth": 1e9}}}, "tuning.observer.bandwidth"),
        ({"scenario": {"duration_s": -1.0}}, "scenario.duration_s"),
        ({"tags": ["a,b"]}, "tags.0"),
        ({"tags": "a"}, "tags"),
        ({"note": 5}, "note"),
        ({"author": ""}, "author"),
        ({"colour": "red"}, "colour"),
    ],
    ids=str,
)
def test_a_refused_body_saves_nothing_and_names_the_field(
    session: httpx.Client, body: dict[str, Any], field: str
) -> None:
    assert problem_of(save(session, "never", **body), 422)["errors"][0]["field"] == field
    assert session.get("/api/presets").json() == []


@pytest.mark.parametrize("name", ["...", "a\x01b", "x" * 81])
def test_a_name_that_no_address_can_carry_is_refused(session: httpx.Client, name: str) -> None:
    problem_of(session.post("/api/session/save_preset", json={"name": name}), 422)
    assert session.get("/api/presets").json() == []


def test_a_scenario_alone_is_saved_with_its_own_tuning(session: httpx.Client) -> None:
    scenario = session.get("/api/scenarios/paper_fig2").json()
    content = save(session, "of the paper", scenario=scenario).json()["content"]
    assert (content["scenario"], content["tuning"], content["provenance"]["source"]) == (
        scenario,
        scenario["tuning"],
        "rest",
    )


def test_two_pages_that_save_one_preset_are_told_of_each_other(session: httpx.Client, server: Server) -> None:
    fresh(session, "shared")
    with LivePage(server) as one, LivePage(server) as two:
        known = one.hello["document"]["preset"]
        assert (known["name"], known["tuning"]) == ("shared", live(session))
        one.ask("tune", changes={"observer.bandwidth": 66.0})
        reply = one.ask("save_preset", name="shared", revision=known["revision"])
        assert (reply["ok"], reply["result"]["author"]) == (True, one.hello["you"])
        told = two.next_message("document", lambda message: message["preset"]["revision"] > known["revision"])
        assert told["preset"]["version"] == reply["result"]["version"]
        two.ask("tune", changes={"observer.bandwidth": 67.0})
        stale = two.ask("save_preset", name="shared", revision=known["revision"])
        assert (stale["ok"], stale["problem"]["status"]) == (False, 412)
        assert stale["problem"]["current"]["changes"] == ["g 60 → 66 rad/s"]
        assert two.ask("save_preset", name="shared")["problem"]["status"] == 428
        assert two.ask("save_preset", name="shared", revision=stale["problem"]["current"]["revision"])["ok"]


def test_tags_of_the_preset_in_force_do_not_make_the_next_save_stale_and_a_newer_version_does(
    session: httpx.Client, server: Server
) -> None:
    etag = fresh(session, "in force")
    with LivePage(server) as page:
        tagged = session.patch("/api/presets/in force", json={"tags": ["a"]}, headers={"If-Match": etag})
        now = page.next_message("document")["preset"]
        assert now["revision"] == tagged.json()["revision"]
        other = session.get("/api/scenarios/paper_fig2").json()["tuning"]
        save(session, "in force", tagged.headers["etag"], tuning=other).raise_for_status()
        now = page.next_message("document")["preset"]
        assert (now["revision"], now["version"]) == (tagged.json()["revision"], tagged.json()["version"])
        assert page.ask("save_preset", name="in force", revision=now["revision"])["problem"]["status"] == 412


def test_a_preset_saved_by_another_version_is_applied_as_far_as_it_fits(session: httpx.Client, server: Server) -> None:
    """Such content comes by an upgrade of the program: here it is written into the database by hand."""
    fresh(session, "foreign")
    number = session.get("/api/presets/foreign").json()["version"]
    foreign = session.get("/api/presets/foreign").json()["content"]
    foreign["tuning"]["observer"] |= {"bandwidth": 1e7, "colour": "red"}
    foreign["tuning"]["controller"]["natural_frequency"] = 31.0
    rewrite(server, "foreign", number, foreign)
    found = session.get("/api/presets/foreign").json()
    assert found["fit"]["unknown"] == ["tuning.observer.colour"]
    difference = session.get("/api/presets/foreign/difference").json()
    assert [each["path"] for each in difference["changes"]] == ["controller.natural_frequency"]
    assert difference["refused"] == [
        {"field": "tuning.observer.bandwidth", "message": "expected a number from 1 to 2000 rad/s"}
    ]
    whole = problem_of(session.post("/api/presets/foreign/apply", json={}), 422)
    assert "tuning.observer.bandwidth does not fit" in whole["detail"]
    assert live(session)["controller"]["natural_frequency"] == 20.0
    chosen = session.post("/api/presets/foreign/apply", json={"paths": ["controller.natural_frequency"]}).json()
    assert chosen["applied"] == {"controller.natural_frequency": 31.0}
    problem_of(session.post(f"/api/presets/foreign/versions/{number}/restore", headers={"If-Match": "*"}), 422)


def rewrite(server: Server, name: str, number: int, content: dict[str, Any]) -> None:
    with closing(sqlite3.connect(server.errors.parent / "vssea.sqlite")) as connection, connection:
        connection.execute(
            "UPDATE versions SET content = ? WHERE number = ? AND document_id = (SELECT id FROM documents WHERE name = ?)",
            (json.dumps(content), number, name),
        )


@pytest.mark.parametrize(
    ("named", "told"), [("page 3", "page 3"), (None, "REST"), ("page 3 <b>", "REST"), ("root", "REST")]
)
def test_the_log_says_which_page_made_a_call(session: httpx.Client, named: str | None, told: str) -> None:
    headers = {} if named is None else {"X-VSSEA-Page": named}
    session.put("/api/presets/whose", json={}, headers=headers | {"If-Match": "*"}).raise_for_status()
    session.patch("/api/presets/whose", json={"tags": [told]}, headers=headers | {"If-Match": "*"}).raise_for_status()
    session.post(
        "/api/session/tune", json={"changes": {"observer.bandwidth": 77.0}}, headers=headers
    ).raise_for_status()
    events = session.get(
        "/api/session/events?last=3"
    ).json()  # one of them may be of a slider that has just come to rest
    assert {event["by"] for event in events[-2:] if event["kind"] == "preset"} == {told}
    assert session.get("/api/presets/whose").json()["author"] == told
    assert session.get("/api/session/history?last=1").json()[0]["by"] == told
