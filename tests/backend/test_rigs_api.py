"""Rigs over REST, on a session without processes: files, the check, and control by the key in a header."""

import asyncio
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import httpx
import pytest
from fastapi import FastAPI

from backend.api.problems import add_problem_handlers
from backend.api.resources import resources
from backend.api.rigs import rig_routes
from backend.compute.pool import JobFailedError
from backend.rigs.library import RigLibrary
from backend.rigs.rig_file import RigFile
from tests.backend.rig_bench import RigBench, on_rig_bench

EMULATOR = (Path(__file__).parents[2] / "backend/rigs/emulator.toml").read_text("utf-8")
BENCH = EMULATOR.replace('name = "emulator"', 'name = "bench"')
LINES = [
    {"what": "CAN bus", "found": "open", "expected": "open", "ok": True, "sentence": ""},
    {"what": "nodes", "found": "1", "expected": "1, 2, 3", "ok": False, "sentence": "Node 2 does not answer."},
]


class CheckWorker:
    def __init__(self) -> None:
        self.asked: list[tuple[str, RigFile, float]] = []
        self.stopped = 0
        self.lines: list[dict[str, Any]] | None = LINES

    async def run(self, job: str, rig: RigFile, gear_ratio: float, **_: Any) -> Any:
        self.asked.append((job, rig, gear_ratio))
        if self.lines is None:
            raise JobFailedError("the vssea rig check process ended unexpectedly; try again")
        return self.lines

    async def stop(self) -> None:
        self.stopped += 1


class Pool:
    def __init__(self) -> None:
        self.rig_check = CheckWorker()


Work = Callable[[httpx.AsyncClient, RigBench, CheckWorker], Awaitable[None]]


def over_rest(folder: Path, work: Work) -> None:
    async def run() -> None:
        library, pool = RigLibrary(folder / "rigs"), Pool()
        async with on_rig_bench(folder, rigs=library) as bench:
            app = FastAPI()
            add_problem_handlers(app)
            app.include_router(rig_routes(bench.session, pool, library))  # type: ignore[arg-type]
            app.include_router(resources(bench.session, pool, str(folder)))  # type: ignore[arg-type]
            transport = httpx.ASGITransport(app)
            async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1") as http:
                await work(http, bench, pool.rig_check)

    asyncio.run(run())


def test_the_built_in_rig_is_always_listed_and_others_are_kept_changed_and_deleted(data_dir: Path) -> None:
    async def work(http: httpx.AsyncClient, bench: RigBench, _: CheckWorker) -> None:
        emulator, _ = (await http.get("/api/rigs")).json()["rigs"]
        assert (emulator["name"], emulator["builtin"], emulator["rate_hz"], emulator["interface"]) == (
            "emulator", True, 500, "socketcand",
        )  # fmt: skip
        assert emulator["file"]["limits"]["motor_torque"] == 70.0
        kept = await http.put("/api/rigs/bench", content=BENCH)
        assert (kept.status_code, kept.json()["text"]) == (200, BENCH)
        assert [rig["name"] for rig in (await http.get("/api/rigs")).json()["rigs"]] == [
            "emulator",
            "simulated",
            "bench",
        ]
        assert (await http.get("/api/rigs/bench")).json() == kept.json()
        assert bench.events("rig") == ["file of rig bench saved"]
        assert (await http.delete("/api/rigs/bench")).status_code == 204
        assert (await http.get("/api/rigs/bench")).status_code == 404
        assert (await http.delete("/api/rigs/emulator")).status_code == 409

    over_rest(data_dir, work)


@pytest.mark.parametrize(
    ("text", "words"),
    [("name = ", "no TOML"), (BENCH.replace("rate_hz = 500", "rate_hz = 333"), "rate_hz"), (EMULATOR, "expected 'bench'"),
     (BENCH.replace("motor_speed", "motor_sped"), "unknown name")],
)  # fmt: skip
def test_a_file_that_is_not_right_is_refused_with_a_sentence_and_the_old_one_stays(
    data_dir: Path, text: str, words: str
) -> None:
    async def work(http: httpx.AsyncClient, _: RigBench, __: CheckWorker) -> None:
        await http.put("/api/rigs/bench", content=BENCH)
        answer = await http.put("/api/rigs/bench", content=text)
        assert (answer.status_code, answer.headers["content-type"]) == (422, "application/problem+json")
        assert words in answer.json()["detail"]
        assert (await http.get("/api/rigs/bench")).json()["text"] == BENCH
        assert (await http.put("/api/rigs/bench", content=b"\xff\xfe")).status_code == 400
        assert (await http.put("/api/rigs/bench", content="#" * 200_000)).status_code == 413

    over_rest(data_dir, work)


def test_a_check_is_told_line_by_line_in_a_process_that_ends_with_it(data_dir: Path) -> None:
    async def work(http: httpx.AsyncClient, bench: RigBench, worker: CheckWorker) -> None:
        answer = (await http.post("/api/rigs/emulator/check")).json()
        assert answer == {"ok": False, "lines": LINES}
        worker.lines = LINES[:1]
        assert (await http.post("/api/rigs/emulator/check")).json()["ok"]
        assert [(job, rig.name, ratio) for job, rig, ratio in worker.asked] == [("check", "emulator", 100.0)] * 2
        worker.lines = None
        assert (await http.post("/api/rigs/emulator/check")).status_code == 503
        assert worker.stopped == 3
        assert (await http.post("/api/rigs/nobody/check")).status_code == 404

    over_rest(data_dir, work)


def test_a_connected_rig_is_not_checked_and_its_file_stays_as_it_is(data_dir: Path) -> None:
    async def work(http: httpx.AsyncClient, bench: RigBench, worker: CheckWorker) -> None:
        await http.put("/api/rigs/bench", content=BENCH)
        await bench.ask("connect_rig", rig="bench")
        for method, path in (
            ("POST", "/api/rigs/emulator/check"),
            ("PUT", "/api/rigs/bench"),
            ("DELETE", "/api/rigs/bench"),
        ):
            answer = await http.request(method, path, content=BENCH if method == "PUT" else None)
            assert (answer.status_code, answer.json()["title"]) == (409, "Rig connected")
        assert worker.asked == []

    over_rest(data_dir, work)


def test_a_rest_caller_is_in_control_by_the_key_in_its_header(data_dir: Path) -> None:
    async def work(http: httpx.AsyncClient, bench: RigBench, _: CheckWorker) -> None:
        key = (await http.post("/api/session/connect_rig", json={"rig": "emulator"})).json()["key"]
        mine = {"X-VSSEA-Lease": key}
        home = "/api/session/home_stiffness"
        for headers in ({}, {"X-VSSEA-Page": "page 1"}, {"X-VSSEA-Lease": "guess"}):
            answer = await http.post(home, headers=headers)
            assert (answer.status_code, answer.json()["title"], answer.json()["operator"]) == (
                403,
                "Not in control",
                "REST",
            )
        assert (await http.post(home, headers=mine)).status_code == 200
        taken = await http.post("/api/session/take_control", json={"expires_s": 2.0}, headers=mine)
        assert taken.json() == {"key": key, "expires_s": 2.0}
        assert (await http.get("/api/session")).json()["control"]["expires_in_s"] == 2.0
        assert (await http.post("/api/session/release_control", headers=mine)).status_code == 200
        assert (await http.post("/api/session/stop")).status_code == 200

    over_rest(data_dir, work)
