"""Presets: saved, listed, applied, deleted, and kept with the last tuning over a restart of the server."""

from pathlib import Path

import httpx
import numpy as np
import pytest
from backend.presets.store import PresetStore

from backend.problem import Problem
from tests.backend.server import Server
from vssea_core.control.tuning import StateFeedback, Tuning
from vssea_core.scenarios import SCENARIOS

FASTER = Tuning(controller=StateFeedback(natural_frequency=25.0))


def tuning(http: httpx.Client) -> object:
    return http.get("/api/session").json()["scenario"]["tuning"]


def test_a_saved_preset_is_listed_applied_and_deleted(session: httpx.Client) -> None:
    name = "tracking v3 · θ"
    before = tuning(session)
    assert session.put(f"/api/presets/{name}").json()["tuning"] == before
    session.post("/api/session/tune", json={"changes": {"observer.bandwidth": 55.0}}).raise_for_status()
    assert tuning(session) != before
    assert [(preset["name"], preset["tuning"]) for preset in session.get("/api/presets").json()] == [(name, before)]
    session.post(f"/api/presets/{name}/apply").raise_for_status()
    assert tuning(session) == before
    session.delete(f"/api/presets/{name}").raise_for_status()
    assert session.get("/api/presets").json() == []
    assert tuning(session) == before


def test_a_tuning_from_elsewhere_is_saved_without_being_applied(session: httpx.Client) -> None:
    before = tuning(session)
    document = FASTER.model_dump(mode="json")
    assert session.put("/api/presets/faster", json={"tuning": document}).json()["tuning"] == document
    assert tuning(session) == before


def test_the_commands_do_what_the_resources_do(session: httpx.Client) -> None:
    for command in ("save_preset", "apply_preset", "delete_preset"):
        session.post(f"/api/session/{command}", json={"name": "one"}).raise_for_status()
    assert session.get("/api/presets").json() == []


def test_saving_again_replaces(tmp_path: Path) -> None:
    store = PresetStore(tmp_path)
    store.save("a", Tuning())
    store.save("a", FASTER)
    assert [(preset.name, preset.tuning) for preset in store.list()] == [("a", FASTER)]
    store.close()


def test_the_store_keeps_presets_and_the_last_scenario(tmp_path: Path) -> None:
    store = PresetStore(tmp_path / "new" / "folder")
    store.save("a", FASTER)
    for scenario in SCENARIOS.values():
        store.save_last(scenario, "a")
    store.close()
    again = PresetStore(tmp_path / "new" / "folder")
    assert again.get("a").tuning == FASTER
    last = again.last()
    assert last is not None
    assert (last.scenario, last.preset) == (SCENARIOS["paper_fig2"], "a")
    again.delete("a")
    with pytest.raises(Problem, match="There is no preset 'a'; known: none saved yet"):
        again.get("a")
    again.close()


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
