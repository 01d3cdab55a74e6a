"""The client: what it asks a server, what it makes of the answers, and one sentence for whatever goes wrong."""

import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet
import pytest

from backend.client import VsseaClient, VsseaError
from tests.backend.fake_server import Answer, FakeServer, fake_server
from vssea_core.batch.document import Batch, Grid
from vssea_core.scenarios import NOMINAL

BATCH = {"id": "b1", "state": "queued", "name": "batch"}
TABLE = pa.table({"run": [0, 1], "tuning.model.link_inertia": [0.1, 0.2], "rms_error": [1e-3, float("nan")]})


@pytest.fixture
def fake(monkeypatch: pytest.MonkeyPatch) -> Iterator[FakeServer]:
    monkeypatch.delenv("VSSEA_TOKEN", raising=False)
    with fake_server() as server:
        yield server


@pytest.fixture
def client(fake: FakeServer) -> VsseaClient:
    return VsseaClient(fake.address, timeout_s=20.0)


def parquet(table: pa.Table) -> bytes:
    content = io.BytesIO()
    pa.parquet.write_table(table, content)
    return content.getvalue()


def refusal(status: int, sentence: str, *errors: dict[str, Any]) -> Answer:
    problem = {"type": "about:blank", "title": "Refused", "status": status, "detail": sentence, "errors": list(errors)}
    return Answer(problem, status, "application/problem+json")


@pytest.mark.parametrize(
    "given",
    [
        Batch(vary=(Grid(path="seed", low=0, high=3, count=4),)),
        Batch(vary=(Grid(path="seed", low=0, high=3, count=4),)).model_dump(mode="json"),
        Batch(vary=(Grid(path="seed", low=0, high=3, count=4),)).model_dump_json(),
    ],
    ids=["model", "dict", "text"],
)
def test_a_batch_is_created_from_a_model_a_dict_or_text(fake: FakeServer, client: VsseaClient, given: Any) -> None:
    fake.on("POST /api/batches", Answer(BATCH, 201))
    assert client.batches.create(given, key="monday") == BATCH
    assert Batch.model_validate(fake.asked[0].body).vary == (Grid(path="seed", low=0, high=3, count=4),)
    assert fake.asked[0].headers["Idempotency-Key"] == "monday"
    assert fake.asked[0].headers["Content-Type"] == "application/json"


def test_a_batch_is_created_from_a_file(fake: FakeServer, client: VsseaClient, tmp_path: Path) -> None:
    fake.on("POST /api/batches", Answer(BATCH, 201))
    (tmp_path / "batch.json").write_text('{"name": "from a file"}', "utf-8-sig")
    client.batches.create(tmp_path / "batch.json")
    assert fake.asked[0].body == {"name": "from a file"}
    assert "Idempotency-Key" not in fake.asked[0].headers


def test_the_token_is_sent_as_the_guard_wants_it(fake: FakeServer, monkeypatch: pytest.MonkeyPatch) -> None:
    fake.on("GET /api/health", Answer({"status": "ok"}))
    VsseaClient(fake.address).health()
    VsseaClient(fake.address, token="a token of this call").health()
    monkeypatch.setenv("VSSEA_TOKEN", "a token of the environment")
    VsseaClient(fake.address).health()
    given = [asked.headers.get("Authorization") for asked in fake.asked]
    assert given == [None, "Bearer a token of this call", "Bearer a token of the environment"]


def test_the_token_goes_to_no_other_server(fake: FakeServer) -> None:
    with fake_server() as other:
        fake.on("GET /api/health", Answer(status=302, headers={"Location": f"{other.address}/api/health"}))
        with pytest.raises(VsseaError, match="answered with status 302"):
            VsseaClient(fake.address, token="a token of this call").health()
        assert other.asked == []


def test_a_refusal_is_raised_with_its_sentence_and_fields(fake: FakeServer, client: VsseaClient) -> None:
    field = {"field": "vary.0.path", "value": "tuning.observer.bandwith", "message": "unknown"}
    fake.on("POST /api/batches/estimate", refusal(422, "There is no such field.", field))
    with pytest.raises(VsseaError, match=r"^There is no such field\.$") as raised:
        client.batches.estimate({})
    assert (raised.value.status, raised.value.errors) == (422, (field,))


@pytest.mark.parametrize(("status", "body"), [(502, b"<html>Bad gateway</html>"), (500, b""), (404, b'["no problem"]')])
def test_an_error_of_something_else_is_told_with_what_was_asked(
    fake: FakeServer, client: VsseaClient, status: int, body: bytes
) -> None:
    fake.on("GET /api/health", Answer(body, status, "text/html"))
    with pytest.raises(VsseaError, match=f"^GET {fake.address}/api/health was answered with status {status}"):
        client.health()


def test_an_answer_of_something_else_is_told(fake: FakeServer, client: VsseaClient) -> None:
    fake.on("GET /api/health", Answer(b"<html>Welcome</html>", media_type="text/html"))
    with pytest.raises(VsseaError, match="was not answered by a VSSEA server"):
        client.health()


def test_no_server_is_told_with_what_to_do() -> None:
    with fake_server() as gone:
        pass
    with pytest.raises(VsseaError, match=rf"^{gone.address} cannot be reached: .*; is `vssea serve` running there\?$"):
        VsseaClient(gone.address).health()


@pytest.mark.parametrize("address", ["localhost:8000", "ftp://localhost", "http://", "/api"])
def test_what_is_no_address_is_told(address: str) -> None:
    with pytest.raises(VsseaError, match="is no address of a server; expected such as"):
        VsseaClient(address)


@pytest.mark.parametrize(
    ("given", "words"),
    [("{", "the document is not JSON"), ([1], "expected a dict, JSON text"), (Path("no/such.json"), "cannot be read")],
)
def test_what_is_no_document_is_told_and_not_sent(
    fake: FakeServer, client: VsseaClient, given: Any, words: str
) -> None:
    with pytest.raises(VsseaError, match=words):
        client.batches.create(given)
    assert fake.asked == []


def test_documents_may_hold_numbers_and_arrays_of_numpy_and_models(fake: FakeServer, client: VsseaClient) -> None:
    fake.on("POST /api/batches", Answer(BATCH, 201))
    values = {"kind": "list", "path": "seed", "values": np.arange(3)}
    ends = {"kind": "grid", "path": "duration_s", "low": np.float32(0.5), "high": np.float64(2.0), "count": np.int64(4)}
    client.batches.create({"scenario": NOMINAL, "vary": [values, ends], "seed": np.int64(7)})
    sent = fake.asked[0].body
    assert sent["scenario"] == NOMINAL.model_dump(mode="json")
    assert sent["vary"] == [
        values | {"values": [0, 1, 2]}, {**ends, "low": 0.5, "high": 2.0, "count": 4}
    ]  # fmt: skip
    assert sent["seed"] == 7


WITHIN_ITSELF: dict[str, Any] = {}
WITHIN_ITSELF["vary"] = WITHIN_ITSELF


@pytest.mark.parametrize(
    ("document", "words"),
    [
        ({"seed": {1, 2}}, "it holds a set; expected numbers, texts, lists and dicts"),
        ({(1, 2): 3}, "keys must be str"),
        ({"seed": float("nan")}, "expected finite numbers"),
        ({"values": np.array([1.0, np.inf])}, "expected finite numbers"),
        (WITHIN_ITSELF, "and nothing within itself"),
    ],
    ids=["set", "key", "nan", "array", "within itself"],
)
def test_what_json_cannot_hold_is_told_and_not_sent(
    fake: FakeServer, client: VsseaClient, document: Any, words: str
) -> None:
    with pytest.raises(VsseaError, match=words):
        client.batches.create(document)
    assert fake.asked == []


def test_what_a_header_cannot_hold_is_told_without_the_token(fake: FakeServer, client: VsseaClient) -> None:
    for key in ("two\nlines", "\N{SNOWMAN}"):
        with pytest.raises(VsseaError, match="a key or token is no text for a header; expected ASCII"):
            client.batches.create({}, key=key)
    with pytest.raises(VsseaError, match="a key or token") as raised:
        VsseaClient(fake.address, token="secret\n").health()
    assert "secret" not in str(raised.value)
    assert fake.asked == []


def test_waiting_tells_how_far_it_is_until_the_batch_has_ended(fake: FakeServer, client: VsseaClient) -> None:
    states = [BATCH | {"state": state} for state in ("queued", "running", "running", "done")]
    fake.on("GET /api/batches/b1", *map(Answer, states))
    told: list[dict[str, Any]] = []
    assert client.batches.wait("b1", progress=told.append, every_s=0.0) == states[-1]
    assert told == states


def test_a_cancelled_batch_is_waited_for_no_longer(fake: FakeServer, client: VsseaClient) -> None:
    fake.on("GET /api/batches/b1", Answer(BATCH | {"state": "cancelled"}))
    assert client.batches.wait("b1", every_s=0.0)["state"] == "cancelled"


def test_waiting_for_a_batch_that_fails_raises_its_reason(fake: FakeServer, client: VsseaClient) -> None:
    fake.on("GET /api/batches/b1", Answer(BATCH | {"state": "failed", "reason": "the disk is full"}))
    with pytest.raises(VsseaError, match=r"^batch b1 failed: the disk is full$"):
        client.batches.wait("b1", every_s=0.0)


def test_waiting_ends_at_its_limit(fake: FakeServer, client: VsseaClient) -> None:
    fake.on("GET /api/batches/b1", Answer(BATCH | {"state": "running"}))
    with pytest.raises(VsseaError, match=r"^batch b1 is still running after 0 s; wait for it again$"):
        client.batches.wait("b1", every_s=0.0, limit_s=0.0)


@pytest.mark.parametrize("name", ["results", "trajectories"])
def test_tables_come_home_whole_or_by_column(fake: FakeServer, client: VsseaClient, name: str) -> None:
    fake.on(f"GET /api/batches/b1/{name}.parquet", Answer(parquet(TABLE), media_type="application/vnd.apache.parquet"))
    take = getattr(client.batches, name)
    assert take("b1").to_pydict()["run"] == [0, 1]
    assert take("b1").schema == TABLE.schema
    assert take("b1", columns=["rms_error"]).column_names == ["rms_error"]


@pytest.mark.parametrize("columns", [["nope"], ["run", "nope"], ("run", "rms_error", "nope")])
def test_a_column_that_is_not_there_is_told_with_those_that_are(
    fake: FakeServer, client: VsseaClient, columns: Any
) -> None:
    fake.on("GET /api/batches/b1/results.parquet", Answer(parquet(TABLE), media_type="application/vnd.apache.parquet"))
    with pytest.raises(
        VsseaError, match=r"^there is no column 'nope'; known here: run, tuning.model.link_inertia, rms"
    ):
        client.batches.results("b1", columns=columns)


@pytest.mark.parametrize(
    "content", [b"", b"PAR1 and no more", parquet(TABLE)[:-20] + b"PAR1"], ids=["empty", "short", "cut"]
)
def test_a_table_that_cannot_be_read_is_told(fake: FakeServer, client: VsseaClient, content: bytes) -> None:
    fake.on("GET /api/batches/b1/results.parquet", Answer(content, media_type="application/vnd.apache.parquet"))
    with pytest.raises(VsseaError, match=r"^the answer to GET /api/batches/b1/results.parquet cannot be read: "):
        client.batches.results("b1")


@pytest.mark.parametrize(
    "content", [b"", b"time [s]\nsoon\n", b"time [s],limits\n1.0\n"], ids=["empty", "text", "short"]
)
def test_a_trajectory_that_cannot_be_read_is_told(fake: FakeServer, client: VsseaClient, content: bytes) -> None:
    fake.on("POST /api/simulate?trajectory=csv&every=1&allow_unstable=false", Answer(content, media_type="text/csv"))
    with pytest.raises(VsseaError, match=r"^the answer to POST /api/simulate cannot be read: "):
        client.simulate({})


def test_results_are_saved_under_their_name_once_they_are_whole(
    fake: FakeServer, client: VsseaClient, tmp_path: Path
) -> None:
    fake.on("GET /api/batches/b1/results.csv", Answer(b"run\n0\n", media_type="text/csv"))
    assert client.batches.save("b1", tmp_path / "out.csv").read_bytes() == b"run\n0\n"
    fake.on("GET /api/batches/b1/results.csv", Answer(b"run\n0", media_type="text/csv", missing=7))
    with pytest.raises(VsseaError, match="broke off, 7 bytes are missing"):
        client.batches.save("b1", tmp_path / "out.csv")
    assert [file.name for file in tmp_path.iterdir()] == ["out.csv"]
    assert (tmp_path / "out.csv").read_bytes() == b"run\n0\n"
    fake.on("GET /api/batches/b1/results.csv", Answer(b"run\n0\n", media_type="text/csv"))
    assert client.batches.save("b1", tmp_path / "OUT.CSV").name == "OUT.CSV"
    with pytest.raises(VsseaError, match=r"expected a name ending in .parquet, .csv, .arrow"):
        client.batches.save("b1", tmp_path / "out.xlsx")


def test_a_run_is_simulated_again_from_its_scenario(fake: FakeServer, client: VsseaClient) -> None:
    fake.on("GET /api/batches/b1/runs/7/scenario", Answer({"name": "the seventh"}))
    csv = b"time [s],link_position [rad],limits\n0.0,0.1,0\n0.005,nan,1\n"
    fake.on("POST /api/simulate?trajectory=csv&every=5&allow_unstable=true", Answer(csv, media_type="text/csv"))
    table = client.batches.simulate("b1", 7, every=5)
    assert fake.asked[-1].body == {"name": "the seventh"}
    assert table.column_names == ["time", "link_position", "limits"]
    assert table.column("time").to_pylist() == [0.0, 0.005]
    assert {str(field.type) for field in table.schema} == {"double"}
    assert str(table.column("link_position").to_pylist()) == "[0.1, nan]"


def test_the_rest_of_the_routes_is_asked_as_the_protocol_says(fake: FakeServer, client: VsseaClient) -> None:
    fake.on("GET /api/batches?state=done&offset=10&limit=5", Answer([BATCH]))
    fake.on("GET /api/batches/a%2Fb", Answer(BATCH))
    fake.on("GET /api/batches/b1/document", Answer({"name": "as sent"}))
    fake.on("GET /api/batches/b1/runs/3", Answer({"run": 3}))
    fake.on("POST /api/batches/b1/cancel", Answer(BATCH))
    fake.on("POST /api/batches/b1/resume", Answer(BATCH))
    fake.on("DELETE /api/batches/b1", Answer(status=204))
    fake.on("GET /api/scenarios/realistic", Answer({"name": "realistic"}))
    fake.on("POST /api/simulate?trajectory=none&allow_unstable=false", Answer({"metrics": {}}))
    assert client.batches.list(state="done", offset=10, limit=5) == [BATCH]
    assert client.batches.get("a/b") == BATCH
    assert client.batches.document("b1") == {"name": "as sent"}
    assert client.batches.run("b1", 3) == {"run": 3}
    assert client.batches.cancel("b1") == BATCH
    assert client.batches.resume("b1") == BATCH
    client.batches.delete("b1")
    assert client.scenario("realistic") == {"name": "realistic"}
    assert client.metrics(client.scenario("realistic")) == {"metrics": {}}
