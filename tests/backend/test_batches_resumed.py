"""A batch over a server that is killed, and over workers that are: nothing is lost, and the bits are the same."""

import io
import os
import signal
from collections.abc import Iterator
from pathlib import Path

import httpx
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from tests.backend.batch_documents import BATCHES, PATIENCE_S, batch, created, ended, grid, one
from tests.backend.server import Server, until

SWEEP = batch(grid("actuator.link.inertia", 0.5, 2.0, 20_000, factor=True), scenario={"duration_s": 0.5})


@pytest.fixture
def servers(tmp_path: Path) -> Iterator[list[Server]]:
    """The servers that a test starts, all on one data folder; the last one is ended afterwards."""
    started = [Server(tmp_path, VSSEA_BATCH_WORKERS="2")]
    yield started
    started[-1].terminate()


def client(server: Server) -> httpx.Client:
    return httpx.Client(base_url=server.wait_until_running().url, timeout=60.0, trust_env=False)


def results(http: httpx.Client, name: str) -> pa.Table:
    return pq.read_table(io.BytesIO(http.get(f"{BATCHES}/{name}/results.parquet").content))


def test_a_killed_server_goes_on_where_it_was_and_a_killed_worker_costs_nothing(
    servers: list[Server], tmp_path: Path
) -> None:
    with client(servers[0]) as http:
        name = created(http, SWEEP, "a key")["id"]
        until(lambda: one(http, name)["progress"]["parts_done"] >= 2, PATIENCE_S)
        servers[0].kill()
    folder = tmp_path / "batches" / name
    kept = {path.name: path.stat().st_mtime_ns for path in folder.glob("*.parquet")}
    assert 2 <= len(kept) < 16

    servers.append(Server(tmp_path, VSSEA_BATCH_WORKERS="2"))
    with client(servers[1]) as http:
        found = ended(http, name)
        assert (found["state"], found["counts"]["done"], found["parts"]) == ("done", 20_000, 16)
        assert {path: (folder / path).stat().st_mtime_ns for path in kept} == kept
        again = http.post(BATCHES, json=SWEEP, headers={"Idempotency-Key": "a key"})
        assert (again.status_code, again.json()["id"]) == (200, name)

        other = created(http, SWEEP)["id"]
        until(lambda: one(http, other)["progress"]["parts_done"] >= 1, PATIENCE_S)
        os.kill(servers[1].children()["batch 1"], signal.SIGKILL)
        found = ended(http, other)
        assert (found["state"], found["counts"]["done"]) == ("done", 20_000)
        first, second = results(http, name), results(http, other)
        assert first["run"].to_pylist() == list(range(20_000))
        assert second.equals(first)
