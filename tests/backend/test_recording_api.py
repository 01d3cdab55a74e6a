"""Recordings of a live session over REST: found, drawn, taken home, imported again, and simulated again to the bit."""

import io
import json
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pyarrow.parquet as pq
import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from tests.backend.server import Server, until
from tests.backend.test_api_errors import problem_of
from vssea_core.channels import CHANNELS

LIST = "/api/recordings"


@pytest.fixture(scope="module")
def taken(server: Server) -> Iterator[tuple[httpx.Client, str]]:
    """A client, and the id of a complete recording with live changes of tuning, reference and stiffness."""
    with httpx.Client(base_url=server.url, timeout=120.0, trust_env=False) as http:

        def post(command: str, **arguments: Any) -> None:
            http.post(f"/api/session/{command}", json=arguments).raise_for_status()

        def past(time_s: float) -> bool:
            return float(http.get("/api/session").json()["time_s"]) > time_s

        post("reset")
        post("load_scenario", name="nominal")
        if http.get("/api/session").json()["state"] != "running":
            post("resume")
        until(lambda: past(0.4))
        post("tune", changes={"observer.bandwidth": 60.0})
        until(lambda: past(0.8))
        post("set_reference", changes={"kind": "move", "target": 0.4})
        post("set_stiffness", changes={"stiffness": 300.0})
        until(lambda: past(1.5))
        run = http.get(LIST).json()["recorder"]["recording"]
        post("reset")
        until(lambda: http.get(f"{LIST}/{run}").json()["summary"] is not None, 60.0)
        yield http, run


def json_of(http: httpx.Client, path: str, **query: Any) -> dict[str, Any]:
    answer = http.get(path, params=query)
    assert answer.status_code == 200, answer.text
    found: dict[str, Any] = answer.json()
    return found


def published(http: httpx.Client, run: str, channels: list[str]) -> np.ndarray:
    """What the public reader finds in the recording's file."""
    content = io.BytesIO(http.get(f"{LIST}/{run}/export", params={"form": "mcap"}).content)
    messages = make_reader(content, decoder_factories=[DecoderFactory()]).iter_decoded_messages(topics=["/telemetry"])
    return np.array([[getattr(message, name) for name in channels] for _, _, _, message in messages])


def test_a_recording_is_listed_with_its_figures(taken: tuple[httpx.Client, str]) -> None:
    http, run = taken
    listed = json_of(http, LIST)
    entry = next(each for each in listed["recordings"] if each["id"] == run)
    assert (entry["state"], entry["origin"], entry["scenario"], entry["lost"]) == ("complete", "live", "nominal", 0)
    assert entry["duration_s"] > 1.4
    assert entry["summary"]["metrics"]["peak_torque"] > 0.0
    assert 2 <= len(entry["summary"]["picture"]["time"]) <= 120
    assert listed["disk"]["used_bytes"] >= entry["size_bytes"]
    assert [each["id"] for each in json_of(http, LIST, origin="import")["recordings"]].count(run) == 0


def test_its_details_are_what_was_done(taken: tuple[httpx.Client, str]) -> None:
    http, run = taken
    found = json_of(http, f"{LIST}/{run}")
    assert [each["part"] for each in found["tunings"]] == ["tuning", "reference", "stiffness_reference"]
    assert found["scenario"]["tuning"]["observer"]["bandwidth"] == 100.0
    assert found["final"]["tuning"]["observer"]["bandwidth"] == 60.0
    assert [channel["name"] for channel in found["channels"]][: len(CHANNELS)] == [channel.name for channel in CHANNELS]
    assert {"tune", "set_reference", "set_stiffness"} <= {each["command"] for each in found["commands"]}
    assert found["events"]


def test_its_samples_are_drawn_as_they_are_in_the_file(taken: tuple[httpx.Client, str]) -> None:
    http, run = taken
    channels = ["error", "motor_torque"]
    answer = http.get(f"{LIST}/{run}/samples", params={"channels": ",".join(channels), "to_s": 1.0, "points": 5000})
    assert answer.headers["content-type"] == "application/octet-stream"
    size = struct.unpack_from("<I", answer.content)[0]
    head = json.loads(answer.content[4 : 4 + size])
    expected = published(http, run, ["time", *channels])[:1001]
    time = np.frombuffer(answer.content, "<f8", head["samples"], 4 + size)
    rows = np.frombuffer(answer.content, "<f4", offset=4 + size + time.nbytes).reshape(2, -1)
    assert head["exact"]
    assert np.array_equal(time, expected[:, 0])
    assert np.array_equal(rows.T, expected[:, 1:].astype(np.float32))


def test_its_exports_are_its_samples(taken: tuple[httpx.Client, str], tmp_path: Path) -> None:
    http, run = taken
    expected = published(http, run, ["time", "error"])
    answer = http.get(f"{LIST}/{run}/export", params={"form": "parquet", "channels": "error"})
    assert answer.headers["content-disposition"] == f'attachment; filename="{run}.parquet"'
    table = pq.read_table(io.BytesIO(answer.content))
    assert np.array_equal(np.column_stack([column.to_numpy() for column in table.columns]), expected)
    text = http.get(f"{LIST}/{run}/export", params={"form": "csv", "channels": "error"}).text
    assert np.array_equal(np.loadtxt(io.StringIO(text), delimiter=",", skiprows=1), expected)
    assert json_of(http, f"{LIST}/{run}/export", form="json")["facts"]["samples"] == len(expected)


def test_it_is_simulated_again_to_the_bit(taken: tuple[httpx.Client, str]) -> None:
    http, run = taken
    answer = http.post(f"{LIST}/{run}/simulate", json={})
    assert answer.status_code == 202
    task = answer.json()
    assert task["kind"] == "simulate_recording"
    until(lambda: json_of(http, f"/api/tasks/{task['id']}")["state"] not in ("queued", "running"), 120.0)
    told = json_of(http, f"/api/tasks/{task['id']}/result")
    assert told["first_difference_s"] is None
    assert {each["peak"] for each in told["residual"].values()} == {0.0}
    kept = json_of(http, f"{LIST}/{told['recording']}")
    assert (kept["id"], kept["origin"], kept["of"]) == (f"{run}-simulated", "simulation", run)
    names = [channel.name for channel in CHANNELS]
    assert published(http, kept["id"], names).tobytes() == published(http, run, names).tobytes()


def test_a_log_is_imported_and_a_dry_run_keeps_nothing(taken: tuple[httpx.Client, str]) -> None:
    http, run = taken
    text = http.get(f"{LIST}/{run}/export", params={"form": "csv"}).content
    before = len(json_of(http, LIST)["recordings"])
    told = http.post(f"{LIST}/import", params={"dry_run": True}, content=text).json()
    assert told["ignored"] == []
    assert len(json_of(http, LIST)["recordings"]) == before
    columns = {"q": {"channel": "link_position", "factor": 2.0}}
    query = {"name": "by hand", "columns": json.dumps(columns), "sample_rate_hz": 100.0}
    kept = http.post(f"{LIST}/import", params=query, content=b"q,x\n1,5\n2,6\n").json()
    assert (kept["origin"], kept["state"]) == ("import", "complete")
    assert published(http, kept["id"], ["time", "link_position"]).tolist() == [[0.0, 2.0], [0.01, 4.0]]
    assert http.delete(f"{LIST}/{kept['id']}").status_code == 200
    problem_of(http.get(f"{LIST}/{kept['id']}"), 404)


def test_name_note_tags_and_star_are_kept_and_a_stale_edit_is_refused(taken: tuple[httpx.Client, str]) -> None:
    http, run = taken
    tag = http.get(f"{LIST}/{run}").headers["etag"]
    edited = http.patch(
        f"{LIST}/{run}", json={"name": "best", "tags": ["a", "a", "b"], "starred": True}, headers={"If-Match": tag}
    )
    assert (edited.json()["name"], edited.json()["tags"], edited.json()["starred"]) == ("best", ["a", "b"], True)
    assert edited.headers["etag"] != tag
    problem_of(http.patch(f"{LIST}/{run}", json={"note": "x"}, headers={"If-Match": tag}), 412)
    assert [each["id"] for each in json_of(http, LIST, search="best b", starred=True)["recordings"]] == [run]
    problem_of(http.delete(f"{LIST}/{run}"), 409)
    assert http.patch(f"{LIST}/{run}", json={"starred": False}).json()["name"] == "best"


def test_what_is_computed_of_it_is_answered(taken: tuple[httpx.Client, str]) -> None:
    http, run = taken
    spectrum = json_of(http, f"{LIST}/{run}/spectrum", channels="error,motor_torque", from_s=0.1, to_s=1.2)
    assert set(spectrum["density"]) == {"error", "motor_torque"}
    reference = json_of(http, f"{LIST}/{run}/reference", to_s=1.0)
    assert reference["kind"] == "recorded"
    changes = json_of(http, f"{LIST}/{run}/difference", against=run, at_s=0.0)["changes"]
    assert "g 100 → 60 rad/s" in [each["words"] for each in changes]
    report = http.get(f"{LIST}/{run}/report")
    assert report.headers["content-type"] == "text/html; charset=utf-8"
    assert "default-src 'none'" in report.headers["content-security-policy"]


def test_a_recorded_course_can_be_followed(taken: tuple[httpx.Client, str]) -> None:
    http, run = taken
    reference = json_of(http, f"{LIST}/{run}/reference", to_s=1.0)
    assert http.post("/api/session/set_reference", json={"replace": reference}).status_code == 200


@pytest.mark.parametrize(
    ("method", "path", "body", "status"),
    [
        ("GET", "/nothing", None, 404),
        ("GET", "/..%2Fx", None, 404),
        ("PATCH", "/nothing", {}, 404),
        ("DELETE", "/nothing", None, 404),
        ("POST", "/nothing/simulate", {}, 404),
        ("GET", "/RUN/samples?channels=nothing", None, 422),
        ("GET", "/RUN/samples", None, 422),
        ("GET", "/RUN/samples?channels=error&points=1", None, 422),
        ("GET", "/RUN/samples?channels=error&from_s=2&to_s=1", None, 422),
        ("GET", "/RUN/samples?channels=error&from_s=nan", None, 422),
        ("GET", "/RUN/export?form=xml", None, 422),
        ("GET", "/RUN/export?form=mcap&from_s=900", None, 422),
        ("GET", "/RUN/export?form=csv&from_s=900", None, 422),
        ("GET", "/RUN/spectrum?channels=", None, 422),
        ("GET", "/RUN/difference?against=nothing", None, 404),
        ("GET", "/RUN/reference?channel=motor_torque", None, 422),
        ("PATCH", "/RUN", {"colour": "red"}, 422),
        ("PATCH", "/RUN", {"starred": "yes"}, 422),
        ("PATCH", "/RUN", [1], 422),
        ("POST", "/RUN/simulate", {"until": 1}, 422),
        ("POST", "/RUN/simulate", {"to_s": "soon"}, 422),
        ("POST", "/RUN/simulate", [1], 422),
        ("POST", "/RUN/scene", {"time_s": 1.0}, 409),
        ("POST", "/import", None, 422),
        ("POST", "/import?columns=x", None, 422),
        ("POST", "/import?columns=[1]", None, 422),
    ],
)
def test_what_cannot_be_done_is_one_problem(
    taken: tuple[httpx.Client, str], method: str, path: str, body: Any, status: int
) -> None:
    http, run = taken
    problem_of(http.request(method, LIST + path.replace("RUN", run), json=body), status)


def test_a_stale_kind_of_tag_is_refused(taken: tuple[httpx.Client, str]) -> None:
    http, run = taken
    problem = problem_of(http.patch(f"{LIST}/{run}", json={}, headers={"If-Match": '"12-4"'}), 422)
    assert problem["errors"][0]["field"] == "If-Match"
