"""A page that stops reading: the others notice nothing, and it is skipped ahead and told, or let go."""

import asyncio
import socket
from collections.abc import Iterator
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import httpx
import pytest

from backend.api import live
from tests.backend.frame_decoder import decoded
from tests.backend.live_page import LivePage
from tests.backend.server import Server

BURST = 10_000
BURSTS = 12  # far more than the buffers on the way hold


@pytest.fixture
def slow(server: Server, session: httpx.Client) -> Iterator[LivePage]:
    """A page with small buffers that reads only when told to."""
    plug = socket.socket()
    plug.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    plug.connect(("127.0.0.1", server.port))
    with LivePage(server, sock=plug, max_queue=1, close_timeout=0.2) as page:
        yield page


def test_a_stalled_page_holds_up_nobody_and_is_told_what_it_missed(server: Server, slow: LivePage) -> None:
    with LivePage(server) as other:
        other.ask("pause")
        written = [other.ask("step", samples=BURST)["ok"] for _ in range(BURSTS)]
        assert written == [True] * BURSTS
        frames = []
        while sum(frame.samples for frame in frames) < BURST * BURSTS:
            frames.append(decoded(other.next_frame()))
        for one, next_one in pairwise(frames):
            assert next_one.sequence == one.sequence + one.samples

        last = frames[-1].sequence + frames[-1].samples
        missed = slow.next_message("missed")["samples"]
        assert missed > BURST
        other.ask("resume")
        seen = [decoded(slow.next_frame())]
        while seen[-1].sequence < last:
            seen.append(decoded(slow.next_frame()))
        missed += sum(message["samples"] for message in slow.passed_over("missed"))
        assert sum(after.sequence - before.sequence - before.samples for before, after in pairwise(seen)) == missed
        assert slow.ask("ping")["ok"]


def test_a_stalled_page_can_still_stop(server: Server, slow: LivePage, session: httpx.Client) -> None:
    with LivePage(server) as other:
        other.ask("pause")
        for _ in range(BURSTS):
            other.ask("step", samples=BURST)
        slow.send("stop")
        stopped = other.next_message("state", lambda message: message["snapshot"]["state"] == "stopped")
        assert slow.hello["you"] in stopped["snapshot"]["sentence"]


class Stuck:
    """A socket whose other end takes nothing."""

    def __init__(self) -> None:
        self.closed: tuple[int, str] | None = None

    async def send_text(self, text: str) -> None:
        await asyncio.Event().wait()

    async def receive(self) -> dict[str, Any]:
        await asyncio.Event().wait()
        raise AssertionError

    async def close(self, code: int, reason: str) -> None:
        self.closed = code, reason


def _pins() -> dict[str, list[str]]:
    return {"pins": []}


def test_a_page_that_takes_nothing_is_let_go_with_a_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(live, "SEND_LIMIT_S", 0.01)
    stuck, log = Stuck(), SimpleNamespace(last=lambda count: [])
    parts = {
        "margins": SimpleNamespace(newest=None), "history": SimpleNamespace(greeting=dict), "pins": SimpleNamespace(message=_pins),
        "trigger": SimpleNamespace(message=dict), "log": log,
        "rig": SimpleNamespace(control=SimpleNamespace(join=lambda name: name), leave=lambda key: None),
    }  # fmt: skip
    session = SimpleNamespace(listeners=set(), run_id="run", snapshot=dict, document=dict, **parts)
    recorder = SimpleNamespace(document=dict)
    page = live.Page(stuck, session, recorder, "page 1")  # type: ignore[arg-type]
    asyncio.run(asyncio.wait_for(page.serve(0.0), 10.0))
    assert stuck.closed == (1013, "This page was too slow.")
    assert not session.listeners
