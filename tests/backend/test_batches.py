"""Batches over a real server: asked for, computed, read, and equal to single runs to the bit."""

import io
from collections.abc import Iterator
from typing import Any

import httpx
import numpy as np
import pyarrow as pa
import pyarrow.csv
import pyarrow.ipc
import pyarrow.parquet as pq
import pytest

from tests.backend.batch_documents import BATCHES, PATIENCE_S, batch, created, done, ended, grid, one
from tests.backend.frame_decoder import decoded
from tests.backend.live_page import LivePage
from tests.backend.server import Server, until
from tests.backend.test_api_errors import problem_of
from vssea_core.batch.document import Batch
from vssea_core.batch.part import columns_of
from vssea_core.batch.plan import BatchPlan
from vssea_core.channels import CHANNELS
from vssea_core.scenario import Scenario
from vssea_core.simulation.metrics import metrics
from vssea_core.simulation.run import simulate

INERTIA = "actuator.link.inertia"
SWEEP = batch(
    grid(INERTIA, 0.5, 2.0, 10, factor=True),
    {"kind": "list", "path": "tuning.observer.bandwidth", "values": [40.0, 80.0, 160.0]},
    name="sweep",
    description="heavier links",
)


@pytest.fixture
def http_batches(session: httpx.Client) -> Iterator[httpx.Client]:
    """The client; afterwards no batch is left."""
    yield session
    for each in session.get(BATCHES, params={"limit": 500}).json()["batches"]:
        session.post(f"{BATCHES}/{each['id']}/cancel").raise_for_status()
        session.delete(f"{BATCHES}/{each['id']}").raise_for_status()
    assert session.get(BATCHES).json()["total"] == 0


@pytest.fixture(scope="module")
def sweep(server: Server) -> Iterator[tuple[httpx.Client, dict[str, Any]]]:
    """A client, and the document of a batch of 30 runs that is done."""
    with httpx.Client(base_url=server.url, timeout=60.0, trust_env=False) as http:
        yield http, done(http, SWEEP)


def test_every_run_of_the_sweep_is_there_in_order(sweep: tuple[httpx.Client, dict[str, Any]]) -> None:
    http, found = sweep
    assert (found["name"], found["description"], found["runs"]) == ("sweep", "heavier links", 30)
    assert found["counts"] == {"done": 30, "ended": 0, "refused": 0}
    assert (found["progress"]["share"], found["progress"]["parts_done"]) == (1.0, found["parts"])
    assert found["created_at"] <= found["started_at"] <= found["ended_at"]
    table = pq.read_table(io.BytesIO(http.get(f"{BATCHES}/{found['id']}/results.parquet").content))
    plan = BatchPlan(Batch.model_validate(SWEEP))
    assert table.column_names == found["columns"] == list(columns_of(plan))
    assert table["run"].to_pylist() == list(range(30))
    assert [{path: row[path] for path in found["paths"]} for row in table.to_pylist()] == [
        plan.values(number) for number in range(30)
    ]


def test_its_rows_are_those_of_single_runs_to_the_bit(sweep: tuple[httpx.Client, dict[str, Any]]) -> None:
    http, found = sweep
    for number in (0, 13, 29):
        scenario = http.get(f"{BATCHES}/{found['id']}/runs/{number}/scenario").json()
        rows = simulate(Scenario.model_validate(scenario)).rows
        run = http.get(f"{BATCHES}/{found['id']}/runs/{number}").json()
        assert {name: run[name] for name in metrics(rows)} == metrics(rows)


def test_a_run_simulated_anew_is_what_simulate_gives(sweep: tuple[httpx.Client, dict[str, Any]]) -> None:
    http, found = sweep
    scenario = http.get(f"{BATCHES}/{found['id']}/runs/7/scenario").json()
    asked = http.post("/api/simulate", params={"trajectory": "binary", "every": 2}, json=scenario)
    frames = http.post(f"{BATCHES}/{found['id']}/runs/7/simulate", params={"every": 2})
    assert frames.status_code == asked.status_code == 200
    assert frames.content == asked.content
    assert decoded(frames.content).samples == 100


def test_pages_and_files_hold_the_same(sweep: tuple[httpx.Client, dict[str, Any]]) -> None:
    http, found = sweep
    place = f"{BATCHES}/{found['id']}/results"
    whole = pq.read_table(io.BytesIO(http.get(f"{place}.parquet").content))
    assert pa.ipc.open_stream(io.BytesIO(http.get(f"{place}.arrow").content)).read_all().equals(whole)
    text = pa.csv.read_csv(
        io.BytesIO(http.get(f"{place}.csv").content),
        convert_options=pa.csv.ConvertOptions(column_types=whole.schema, strings_can_be_null=False),
    )
    assert text.equals(whole)
    paged = []
    for offset in range(0, 40, 7):
        page = http.get(place, params={"offset": offset, "limit": 7}).json()
        assert (page["offset"], page["total"], page["columns"]) == (offset, 30, whole.column_names)
        paged += page["rows"]
    assert paged == [list(row.values()) for row in whole.to_pylist()]


def test_a_page_may_have_some_columns(sweep: tuple[httpx.Client, dict[str, Any]]) -> None:
    http, found = sweep
    place = f"{BATCHES}/{found['id']}/results"
    page = http.get(place, params={"columns": f"{INERTIA},rms_error", "offset": 28}).json()
    assert page["columns"] == [INERTIA, "rms_error"]
    assert [len(row) for row in page["rows"]] == [2, 2]
    detail = problem_of(http.get(place, params={"columns": "rms_eror"}), 422)["detail"]
    assert "There is no column 'rms_eror'; known here: run" in detail


def test_its_document_is_what_was_asked_for(sweep: tuple[httpx.Client, dict[str, Any]]) -> None:
    http, found = sweep
    document = http.get(f"{BATCHES}/{found['id']}/document").json()
    assert Batch.model_validate(document) == Batch.model_validate(SWEEP)


@pytest.mark.parametrize("place", ["", "/results", "/results.csv", "/document", "/runs/0", "/runs/0/scenario"])
def test_a_batch_that_is_not_there_is_told(session: httpx.Client, place: str) -> None:
    assert "GET /api/batches lists them" in problem_of(session.get(f"{BATCHES}/none{place}"), 404)["detail"]


def test_a_run_that_is_not_there_and_samples_that_are_not_kept_are_told(
    sweep: tuple[httpx.Client, dict[str, Any]],
) -> None:
    http, found = sweep
    assert "runs 0 to 29" in problem_of(http.get(f"{BATCHES}/{found['id']}/runs/30"), 404)["detail"]
    assert "keeps no trajectories" in problem_of(http.get(f"{BATCHES}/{found['id']}/trajectories.arrow"), 404)["detail"]


def test_an_estimate_says_what_it_will_take_and_starts_nothing(session: httpx.Client) -> None:
    before = session.get(BATCHES).json()["total"]
    document = batch(grid("tuning.observer.bandwidth", 20.0, 3000.0, 64))
    found = session.post(f"{BATCHES}/estimate", json=document).json()
    assert (found["runs"], found["samples"], found["in_lanes"]) == (64, 64 * 200, 1.0)
    assert found["seconds"] > 0.0
    assert found["bytes"] > 64 * 8 * 10
    assert [values["tuning.observer.bandwidth"] for values in found["first"]] == pytest.approx(
        [20.0, 67.3016, 114.603], 1e-4
    )
    assert found["refused"]
    assert all(sentence.startswith("Run ") and "bandwidth" in sentence for sentence in found["refused"])
    assert session.get(BATCHES).json()["total"] == before


@pytest.mark.parametrize(
    ("document", "words"),
    [
        (batch(grid("actuator.link.inertai", 0.1, 1.0, 3)), "nearest: actuator.link.inertia"),
        (batch(grid(INERTIA, 0.1, 1.0, 3), grid(INERTIA, 0.1, 1.0, 3)), "varied twice"),
        (batch(grid(INERTIA, 0.1, 1.0, 100_000), grid("seed", 0, 99, 100)), "raise VSSEA_BATCH_MOST_RUNS"),
        (batch(grid(INERTIA, -2.0, -1.0, 3)), "No run of this batch can start"),
        (batch(grid(INERTIA, 0.1, 1.0, 0)), "count"),
        ({"scenario": {}, "very": []}, "unknown name; known here: name, description, scenario, vary"),
        (
            batch(
                grid(INERTIA, 0.1, 1.0, 10_000),
                scenario={"duration_s": 120.0},
                keep={"trajectories": "all", "every": 1},
            ),
            "raise VSSEA_BATCH_MOST_GB",
        ),
        ([], "expected"),
    ],
)
def test_what_makes_no_sense_is_refused_and_starts_nothing(session: httpx.Client, document: Any, words: str) -> None:
    before = session.get(BATCHES).json()["total"]
    detail = problem_of(session.post(BATCHES, json=document), 422)["detail"]
    assert words in detail
    assert detail.endswith(". No batch was started.")
    assert session.get(BATCHES).json()["total"] == before


@pytest.mark.parametrize("place", [BATCHES, f"{BATCHES}/estimate"])
def test_an_empty_body_is_no_batch(session: httpx.Client, place: str) -> None:
    before = session.get(BATCHES).json()["total"]
    assert "The body is empty; expected" in problem_of(session.post(place, content=b""), 400)["detail"]
    assert session.get(BATCHES).json()["total"] == before


def test_samples_of_no_run_are_told_and_not_waited_for(http_batches: httpx.Client) -> None:
    found = done(http_batches, batch(grid(INERTIA, 0.1, 0.2, 3), keep={"trajectories": "ended"}))
    detail = problem_of(http_batches.get(f"{BATCHES}/{found['id']}/trajectories.parquet"), 422)["detail"]
    assert detail == "No run of this batch ended early, so no samples were kept."


def test_an_estimate_is_refused_with_the_field_of_the_document(session: httpx.Client) -> None:
    asked = batch(grid(INERTIA, 0.1, 1.0, 3), grid("actuator.lnk.inertia", 0.1, 1.0, 3))
    problem = problem_of(session.post(f"{BATCHES}/estimate", json=asked), 422)
    assert problem["detail"].startswith("actuator.lnk.inertia is no field of the scenario; nearest: ")
    assert "started" not in problem["detail"]
    assert [error["field"] for error in problem["errors"]] == ["vary.1.path"]


def test_refused_runs_are_listed_with_their_reason(http_batches: httpx.Client) -> None:
    document = batch({"kind": "list", "path": INERTIA, "values": [0.1, -1.0, 0.2]})
    found = done(http_batches, document)
    assert found["counts"] == {"done": 2, "ended": 0, "refused": 1}
    page = http_batches.get(f"{BATCHES}/{found['id']}/results").json()
    row = dict(zip(page["columns"], page["rows"][1], strict=True))
    assert (row["state"], row["rms_error"]) == ("refused", None)
    assert "expected a number from 0.005 to 5 kg" in row["reason"]
    detail = problem_of(http_batches.get(f"{BATCHES}/{found['id']}/runs/1/scenario"), 422)["detail"]
    assert row["reason"].lower() in detail.lower()


def test_the_same_key_starts_the_same_document_once(http_batches: httpx.Client) -> None:
    document = batch(grid(INERTIA, 0.1, 0.2, 3))
    first = created(http_batches, document, "a key")
    again = http_batches.post(BATCHES, json=document, headers={"Idempotency-Key": "a key"})
    assert (again.status_code, again.json()["id"]) == (200, first["id"])
    other = http_batches.post(BATCHES, json=document | {"seed": 1}, headers={"Idempotency-Key": "a key"})
    assert "expected a new key" in problem_of(other, 422)["detail"]
    assert http_batches.get(BATCHES).json()["total"] == 1
    ended(http_batches, first["id"])


def test_trajectories_are_those_of_single_runs(http_batches: httpx.Client) -> None:
    keep = {"trajectories": "all", "channels": ["link_position", "motor_torque"], "every": 5, "precision": "float64"}
    found = done(http_batches, batch(grid(INERTIA, 0.1, 0.2, 20), keep=keep))
    place = f"{BATCHES}/{found['id']}"
    table = pq.read_table(io.BytesIO(http_batches.get(f"{place}/trajectories.parquet").content))
    assert (
        pa.ipc.open_stream(io.BytesIO(http_batches.get(f"{place}/trajectories.arrow").content)).read_all().equals(table)
    )
    assert table.column_names == ["run", "time", "link_position", "motor_torque"]
    assert table["run"].to_pylist() == np.repeat(np.arange(20), 40).tolist()
    scenario = Scenario.model_validate(http_batches.get(f"{place}/runs/17/scenario").json())
    rows = simulate(scenario).rows[::5]
    names = [channel.name for channel in CHANNELS]
    for name in table.column_names[1:]:
        assert table[name].to_numpy()[17 * 40 : 18 * 40].tolist() == rows[:, names.index(name)].tolist()


def test_a_damaged_or_missing_part_is_named_and_resuming_computes_it_again(
    http_batches: httpx.Client, server: Server
) -> None:
    found = done(http_batches, batch(grid(INERTIA, 0.1, 0.2, 40)))
    place = f"{BATCHES}/{found['id']}"
    whole = http_batches.get(f"{place}/results").json()
    part = server.errors.parent / "batches" / found["id"] / "part-00001.parquet"
    part.write_bytes(part.read_bytes()[:-20])
    for wanted in ("results", "results.parquet", "runs/17"):
        detail = problem_of(http_batches.get(f"{place}/{wanted}"), 422)["detail"]
        assert "The file part-00001.parquet of this batch's results is damaged; resume the batch" in detail
    part.unlink()
    for wanted in ("results", "results.parquet", "runs/17"):
        detail = problem_of(http_batches.get(f"{place}/{wanted}"), 422)["detail"]
        assert "1 are missing (1); resume the batch" in detail
    assert http_batches.post(f"{place}/resume").json()["id"] == found["id"]
    assert ended(http_batches, found["id"])["state"] == "done"
    assert http_batches.get(f"{place}/results").json() == whole


@pytest.mark.parametrize("wanted", ["document", "runs/0", "runs/0/scenario"])
def test_a_document_that_is_gone_is_told(http_batches: httpx.Client, server: Server, wanted: str) -> None:
    found = done(http_batches, batch(grid(INERTIA, 0.1, 0.2, 3)))
    (server.errors.parent / "batches" / found["id"] / "batch.json").unlink()
    detail = problem_of(http_batches.get(f"{BATCHES}/{found['id']}/{wanted}"), 404)["detail"]
    assert "Put the file back, or delete the batch." in detail


def test_a_page_hears_of_each_state(http_batches: httpx.Client, server: Server) -> None:
    page = LivePage(server)
    try:
        found = created(http_batches, batch(grid(INERTIA, 0.1, 0.2, 3)))
        for state, share in (("queued", 0.0), ("running", 0.0), ("done", 1.0)):
            heard = page.next_message("batches", lambda news, state=state: news["state"] == state)
            assert heard == {"type": "batches", "id": found["id"], "state": state, "share": share}
        http_batches.delete(f"{BATCHES}/{found['id']}").raise_for_status()
        assert page.next_message("batches")["state"] == "deleted"
    finally:
        page.socket.close()


def test_a_cancelled_batch_keeps_its_parts_and_may_then_be_deleted(http_batches: httpx.Client) -> None:
    long = created(http_batches, batch(grid(INERTIA, 0.1, 0.2, 100_000), scenario={"duration_s": 5.0}))
    waiting = created(http_batches, batch(grid(INERTIA, 0.1, 0.2, 3)))
    place = f"{BATCHES}/{long['id']}"
    assert http_batches.post(f"{BATCHES}/{waiting['id']}/cancel").json()["state"] == "cancelled"
    until(lambda: one(http_batches, long["id"])["progress"]["parts_done"], PATIENCE_S)
    assert "cancel it first" in problem_of(http_batches.delete(place), 409)["detail"]
    now = one(http_batches, long["id"])
    assert (now["state"], now["rate"] > 0.0, now["seconds_left"] > 0.0) == ("running", True, True)
    assert http_batches.get(f"{place}/results").json()["total"] >= now["part_size"]
    left = http_batches.post(f"{place}/cancel").json()
    assert left["state"] == "cancelled"
    assert left["progress"]["done"] == http_batches.get(f"{place}/results").json()["total"] < 100_000
    assert http_batches.post(f"{place}/cancel").json() == left
    assert [each["id"] for each in http_batches.get(BATCHES, params={"state": "cancelled"}).json()["batches"]] == [
        waiting["id"],
        long["id"],
    ]
    assert http_batches.delete(place).json() == {}
    assert http_batches.get(place).status_code == 404
    assert http_batches.post(f"{BATCHES}/{waiting['id']}/resume").json()["id"] == waiting["id"]
    assert ended(http_batches, waiting["id"])["counts"]["done"] == 3
