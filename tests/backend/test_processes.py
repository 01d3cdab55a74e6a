"""A process that dies takes nothing with it: it is told, and its work goes on in a new one."""

import os
import signal
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.backend.live_page import LivePage
from tests.backend.server import Server, until


@pytest.fixture(scope="module")
def own(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """A server whose processes may be killed."""
    started = Server(tmp_path_factory.mktemp("data"))
    try:
        yield started.wait_until_running()
    finally:
        started.terminate()


def state(server: Server) -> Any:
    return server.get("/api/health").json()["session"]


def ended(pid: int) -> bool:
    """Whether a process is gone, or waits for nothing but to be noticed."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(") ", 1)[1][0] in "ZX"
    except OSError:
        return True


def killed(server: Server, role: str) -> int:
    """Kill a child and return its process id, once it is gone."""
    pid = until(lambda: server.children().get(role))
    os.kill(pid, signal.SIGKILL)
    until(lambda: ended(pid))
    return pid


def test_a_killed_simulation_worker_is_replaced_at_the_next_call(own: Server) -> None:
    assert own.post("/api/simulate").status_code == 200
    killed(own, "simulation")
    answer = own.post("/api/simulate")
    assert answer.status_code == 200, answer.text
    assert answer.json()["samples"] == 10_000
    assert state(own) == "running"


def test_a_worker_killed_at_work_is_told_and_the_next_call_works(own: Server) -> None:
    long = {"duration_s": 120.0, "timing": {"sample_time_s": 0.001}}
    own.post("/api/simulate")
    url = own.url + "/api/simulate?trajectory=csv"
    with ThreadPoolExecutor(3) as pages:  # one after another, so that one of them is at work when it is killed
        waiting = [pages.submit(httpx.post, url, json=long, timeout=120.0) for _ in range(3)]
        until(lambda: busy(own, "simulation"))
        killed(own, "simulation")
        answers = sorted((each.result(120.0) for each in waiting), key=lambda answer: answer.status_code)
    assert [answer.status_code for answer in answers] == [200, 200, 503]
    assert answers[-1].headers["content-type"] == "application/problem+json"
    assert "try again" in answers[-1].json()["detail"]
    assert own.post("/api/simulate").status_code == 200


def busy(server: Server, role: str) -> bool:
    pid = server.children().get(role)
    return pid is not None and " R " in Path(f"/proc/{pid}/stat").read_text()


def test_a_killed_design_worker_is_replaced_at_the_next_tuning(own: Server) -> None:
    own.post("/api/session/tune", {"changes": {"observer.bandwidth": 90.0}}).raise_for_status()
    killed(own, "design")
    tuned = own.post("/api/session/tune", {"changes": {"observer.bandwidth": 95.0}})
    assert tuned.status_code == 200, tuned.text
    assert state(own) == "running"


def test_a_killed_control_process_is_a_fault_and_a_reset_starts_it_anew(own: Server) -> None:
    with LivePage(own) as page:
        before = own.get("/api/session").json()
        killed(own, "control")
        until(lambda: state(own) == "fault")
        assert "ended unexpectedly" in own.get("/api/session").json()["reason"]
        refused = own.post("/api/session/tune", {"changes": {"observer.bandwidth": 60.0}})
        assert refused.status_code == 503
        assert refused.headers["content-type"] == "application/problem+json"
        with ThreadPoolExecutor(4) as pages:  # everybody presses it
            answers = list(pages.map(lambda _: own.post("/api/session/reset").status_code, range(4)))
        assert answers == [200] * 4
        assert state(own) == "ready"
        assert list(own.children()).count("control") == 1
        own.post("/api/session/resume").raise_for_status()
        after = own.get("/api/session").json()
        assert after["scenario"] == before["scenario"]
        assert after["epoch"] > before["epoch"]
        newest = page.next_sample_after(lambda frame: frame.epoch == after["epoch"])
        assert newest.t0 < 60.0
