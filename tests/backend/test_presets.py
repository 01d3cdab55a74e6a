"""Presets: saved, listed, applied, deleted, and kept with the last tuning over a restart of the server."""

from pathlib import Path

import httpx
import numpy as np

from tests.backend.server import Server
from vssea_core.control.tuning import StateFeedback, Tuning

FASTER = Tuning(controller=StateFeedback(natural_frequency=25.0))


def tuning(http: httpx.Client) -> object:
    return http.get("/api/session").json()["scenario"]["tuning"]


def test_a_saved_preset_is_listed_applied_and_deleted(session: httpx.Client) -> None:
    name = "tracking v3 · θ"
    before = tuning(session)
    assert session.put(f"/api/presets/{name}").json()["content"]["tuning"] == before
    session.post("/api/session/tune", json={"changes": {"observer.bandwidth": 55.0}}).raise_for_status()
    assert tuning(session) != before
    assert [preset["name"] for preset in session.get("/api/presets").json()] == [name]
    session.post(f"/api/presets/{name}/apply").raise_for_status()
    assert tuning(session) == before
    session.delete(f"/api/presets/{name}").raise_for_status()
    assert session.get("/api/presets").json() == []
    assert tuning(session) == before


def test_a_tuning_from_elsewhere_is_saved_without_being_applied(session: httpx.Client) -> None:
    before = tuning(session)
    document = FASTER.model_dump(mode="json")
    assert session.put("/api/presets/faster", json={"tuning": document}).json()["content"]["tuning"] == document
    assert tuning(session) == before


def test_the_commands_do_what_the_resources_do(session: httpx.Client) -> None:
    for command in ("save_preset", "apply_preset", "delete_preset"):
        session.post(f"/api/session/{command}", json={"name": "one"}).raise_for_status()
    assert session.get("/api/presets").json() == []


def test_a_restarted_server_has_its_presets_and_last_tuning_back_and_ends_cleanly(data_dir: Path) -> None:
    server = Server(data_dir).wait_until_running()
    server.post("/api/session/load_scenario", {"name": "realistic"}).raise_for_status()
    server.post("/api/session/tune", {"changes": {"observer.bandwidth": 77.0}}).raise_for_status()
    server.post("/api/session/save_preset", {"name": "mine"}).raise_for_status()
    server.post("/api/session/tune", {"changes": {"observer.bandwidth": 78.0}}).raise_for_status()
    ran = server.get("/api/session").json()["scenario"]
    segments = set(Path("/dev/shm").iterdir())
    children = server.children()
    assert server.terminate() == ""
    assert not [pid for pid in children.values() if Path(f"/proc/{pid}").exists()]
    assert len(segments - set(Path("/dev/shm").iterdir())) >= 2

    again = Server(data_dir).wait_until_running()
    try:
        assert [preset["name"] for preset in again.get("/api/presets").json()] == ["mine"]
        assert again.get("/api/session").json()["scenario"] == ran
        assert np.isclose(ran["tuning"]["observer"]["bandwidth"], 78.0)
    finally:
        assert again.terminate() == ""
