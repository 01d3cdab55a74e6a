"""The live websocket: binary telemetry and JSON messages out, commands in. One coroutine sends to each page."""

import asyncio
import json
import logging
from collections import deque
from contextlib import suppress
from itertools import count
from typing import Any

from fastapi import APIRouter, WebSocket
from starlette.websockets import WebSocketDisconnect

from backend.problem import UNEXPECTED, Problem
from backend.recordings.recorder import Recorder
from backend.session.session import Session
from backend.telemetry.frames import frames
from vssea_core import __version__
from vssea_core.channels import CHANNELS

logger = logging.getLogger(__name__)
SUBPROTOCOL = "vssea-1"
BATCH_S = 1.0 / 30.0
SEND_LIMIT_S = 10.0
"""A page that takes nothing for so long is let go; one that goes on reading before is moved to the newest data."""
CLOSE_LIMIT_S = 2.0
LONGEST_HISTORY_S = 60.0
FAR_BEHIND_S = 2.0
QUEUED_MESSAGES = 400
LONGEST_MESSAGE = 200_000
COMMANDS_AT_ONCE = 64
NEVER_TOO_MANY = frozenset({"stop", "hold", "disarm", "jog", "renew_control"})
"""What calms a rig, or keeps it from stopping for want of a sign of life."""
PROTOCOL_ERROR, TRY_AGAIN = 1002, 1013


class Page:
    """One connected page."""

    def __init__(self, socket: WebSocket, session: Session, recorder: Recorder, name: str) -> None:
        self._socket, self._session, self._recorder, self.name = socket, session, recorder, name
        self._key = ""
        self._messages: deque[dict[str, Any]] = deque(maxlen=QUEUED_MESSAGES)
        self._news = asyncio.Event()
        self._commands: set[asyncio.Task[None]] = set()
        self._next = 0

    def post(self, message: dict[str, Any]) -> None:
        """Queue a message; of states, documents and margins only the newest is kept."""
        if message["type"] in ("state", "document", "margins", "recorder"):
            for queued in self._messages:
                if queued["type"] == message["type"]:
                    self._messages.remove(queued)
                    break
        self._messages.append(message)
        self._news.set()

    async def serve(self, history_s: float) -> None:
        """Greet, then send and receive until either side ends."""
        session = self._session
        self._key = session.rig.control.join(self.name)
        session.listeners.add(self.post)
        sender = asyncio.create_task(self._send_all(history_s))
        receiver = asyncio.create_task(self._receive_all())
        try:
            await asyncio.wait((sender, receiver), return_when=asyncio.FIRST_COMPLETED)
        finally:
            session.listeners.discard(self.post)
            session.rig.leave(self._key)  # who has gone is not in control
            for task in (sender, receiver, *self._commands):
                task.cancel()
            for ended in await asyncio.gather(sender, receiver, *self._commands, return_exceptions=True):
                if isinstance(ended, Exception):
                    logger.error("%s failed", self.name, exc_info=ended)

    async def _send_all(self, history_s: float) -> None:
        session = self._session
        hello = {
            "type": "hello", "protocol": 1, "run": session.run_id, "you": self.name, "version": __version__,
            "channels": [channel._asdict() for channel in CHANNELS], "snapshot": session.snapshot(),
            "document": session.document(), "events": session.log.last(100), "margins": session.margins.newest,
            "recorder": self._recorder.document(), **session.history.greeting(),
            "pins": session.pins.message()["pins"], "trigger": session.trigger.message(),
        }  # fmt: skip
        with suppress(WebSocketDisconnect, RuntimeError, TimeoutError):
            await self._send(json.dumps(hello))
            await self._send_history(history_s)
            due = asyncio.get_running_loop().time()
            while True:
                await self._send_messages()
                await self._send_samples()
                now = asyncio.get_running_loop().time()
                due = max(due + BATCH_S, now)
                with suppress(TimeoutError):
                    async with asyncio.timeout_at(due):
                        await self._news.wait()
        with suppress(RuntimeError, WebSocketDisconnect, TimeoutError):
            async with asyncio.timeout(CLOSE_LIMIT_S):
                await self._socket.close(TRY_AGAIN, "This page was too slow.")

    async def _send_messages(self) -> None:
        self._news.clear()
        while self._messages:
            await self._send(json.dumps(self._messages.popleft(), ensure_ascii=False))

    async def _send_history(self, history_s: float) -> None:
        period_s = self._session.scenario.timing.sample_time_s
        wanted = round(min(history_s, LONGEST_HISTORY_S) / period_s)
        piece = self._session.ring.last(wanted)
        self._next = piece.first + len(piece.samples)
        for frame in frames(piece, history=True):
            await self._send(frame)
            await asyncio.sleep(0)

    async def _send_samples(self) -> None:
        """Send what is new; if this page fell far behind, skip to the newest and say what it missed."""
        ring = self._session.ring
        period_s = self._session.scenario.timing.sample_time_s
        behind = ring.written - self._next
        missed = behind if behind * period_s > FAR_BEHIND_S and behind > ring_burst(period_s) else 0
        if missed:
            self._next += missed
        piece = ring.since(self._next)
        self._next = piece.first + len(piece.samples)
        missed += piece.lost
        if missed:
            await self._send(json.dumps({"type": "missed", "samples": missed}))
        for frame in frames(piece):
            await self._send(frame)

    async def _send(self, content: str | bytes) -> None:
        async with asyncio.timeout(SEND_LIMIT_S):
            if isinstance(content, str):
                await self._socket.send_text(content)
            else:
                await self._socket.send_bytes(content)

    async def _receive_all(self) -> None:
        with suppress(WebSocketDisconnect):
            while True:
                event = await self._socket.receive()
                if event["type"] == "websocket.disconnect":
                    return
                text = event.get("text")
                if text is None or len(text) > LONGEST_MESSAGE or not self._take(text):
                    await self._socket.close(PROTOCOL_ERROR, "Expected JSON commands as docs/protocol.md has them.")
                    return

    def _take(self, text: str) -> bool:
        """Start a command; return whether the message was one. STOP goes before everything else."""
        try:
            message = json.loads(text)
        except (ValueError, RecursionError):
            return False
        if not isinstance(message, dict) or not isinstance(message.get("command"), str):
            return False
        task = asyncio.create_task(self._answer(message))
        self._commands.add(task)
        task.add_done_callback(self._commands.discard)
        return True

    async def _answer(self, message: dict[str, Any]) -> None:
        number, command = message.get("id"), message["command"]
        try:
            if command == "ping":
                result: dict[str, Any] = {}
            elif len(self._commands) > COMMANDS_AT_ONCE and command not in NEVER_TOO_MANY:
                raise Problem(
                    429, "Too many at once", f"More than {COMMANDS_AT_ONCE} commands are waiting; send fewer."
                )
            else:
                result = await self._session.command(command, message.get("arguments"), self.name, self._key)
        except Problem as problem:
            self.post({"type": "reply", "id": number, "ok": False, "problem": problem.document()})
        except Exception:  # every command is answered, else the page waits for nothing
            logger.exception("command %s failed", command)
            self.post({"type": "reply", "id": number, "ok": False, "problem": UNEXPECTED.document()})
        else:
            self.post({"type": "reply", "id": number, "ok": True, "result": result})


def ring_burst(period_s: float) -> int:
    """Return the samples that may come at once without a page being slow (a step while paused)."""
    return max(10_000, round(FAR_BEHIND_S / period_s))


def live(session: Session, recorder: Recorder) -> APIRouter:
    """Return the websocket route."""
    router = APIRouter()
    numbers = count(1)

    @router.websocket("/api/live")
    async def connect(socket: WebSocket) -> None:
        offered = socket.scope.get("subprotocols", [])
        if offered and SUBPROTOCOL not in offered:
            await socket.close(PROTOCOL_ERROR, f"Expected the subprotocol {SUBPROTOCOL}.")
            return
        history_s = _seconds(socket.query_params.get("history_s"))
        page = Page(socket, session, recorder, f"page {next(numbers)}")
        await socket.accept(SUBPROTOCOL if offered else None)
        await page.serve(history_s)

    return router


def _seconds(text: str | None) -> float:
    try:
        value = float(text or 10.0)
    except ValueError:
        return 10.0
    return min(max(value, 0.0), LONGEST_HISTORY_S) if value == value else 10.0
