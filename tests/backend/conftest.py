"""One server for all tests of the package; each test that asks for `session` finds it freshly loaded and running."""

from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from backend.store.database import Database
from tests.backend.server import Server, until
from tests.postgres import PostgresServer, find_postgres


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out what needs a PostgreSQL server where there are no programs of one."""
    if find_postgres() is None:
        without = [item for item in items if item.get_closest_marker("postgres")]
        config.hook.pytest_deselected(items=without)
        items[:] = [item for item in items if item not in without]


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


@pytest.fixture(scope="session")
def postgres() -> Iterator[PostgresServer]:
    programs = find_postgres()
    assert programs is not None
    server = PostgresServer(programs)
    yield server
    server.stop()


@pytest.fixture(params=["sqlite", pytest.param("postgres", marks=pytest.mark.postgres)])
def database_url(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """Address of a new, empty database of each sort."""
    if request.param == "sqlite":
        return f"sqlite:///{tmp_path / 'vssea.sqlite'}"
    server: PostgresServer = request.getfixturevalue("postgres")
    return server.new_database(f"test_{abs(hash(tmp_path))}")


@pytest.fixture
def database(database_url: str) -> Iterator[Database]:
    opened = Database(database_url)
    yield opened
    opened.close()
