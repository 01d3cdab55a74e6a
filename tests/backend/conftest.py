"""One server for all tests of the package; each test that asks for `session` finds it freshly loaded and running."""

from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from tests.backend.server import Server, until


@pytest.fixture(scope="session")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    started = Server(tmp_path_factory.mktemp("data"))
    try:
        yield started.wait_until_running()
    finally:
        started.terminate()


@pytest.fixture(scope="session")
def http(server: Server) -> Iterator[httpx.Client]:
    with httpx.Client(base_url=server.url, timeout=60.0, trust_env=False) as client:
        yield client


@pytest.fixture
def session(http: httpx.Client) -> httpx.Client:
    """The client, with the nominal scenario just loaded, running at full pace, and no presets."""
    http.post("/api/session/reset").raise_for_status()
    http.post("/api/session/load_scenario", json={"name": "nominal"}).raise_for_status()
    http.post("/api/session/set_pace", json={"factor": 1.0}).raise_for_status()
    for preset in http.get("/api/presets").json():
        http.delete(f"/api/presets/{preset['name']}").raise_for_status()
    if http.get("/api/session").json()["state"] != "running":
        http.post("/api/session/resume").raise_for_status()
    until(lambda: http.get("/api/session").json()["state"] == "running")
    return http


@pytest.fixture
def data_dir(tmp_path: Path) -> Path:
    return tmp_path / "data"
