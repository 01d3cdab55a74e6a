"""The writer process as the web process holds it. A thread sends, so that a slow disk never makes the web process wait."""

import asyncio
from collections.abc import Callable, Sequence
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from queue import SimpleQueue
from threading import Thread
from typing import TYPE_CHECKING

from backend.processes import CONTEXT, started
from backend.recordings.messages import Answer, Begin, Item
from backend.settings import Settings

if TYPE_CHECKING:
    Resumed = tuple[Begin | None, str | None, int, int]

ENTRY = "backend.recordings.writer:run_writer"
LEAVE_LIMIT_S = 5.0


class WriterLink:
    """One life of the writer process. `ended` is set when it is over."""

    def __init__(self, take: Callable[[Answer], None]) -> None:
        self._take = take
        self.ended = asyncio.Event()
        self._queue: SimpleQueue[Item | None] = SimpleQueue()
        self._process: BaseProcess | None = None
        self._pipe: Connection | None = None
        self._sender: Thread | None = None

    async def start(self, ring_name: str, settings: Settings, resumed: "Resumed", waiting: Sequence[Item]) -> None:
        """Start the process; it goes on from `resumed`, and is told again what `waiting` holds."""
        for item in waiting:
            self._queue.put(item)
        self._pipe, theirs = CONTEXT.Pipe()
        part_s, keep_free = 60.0 * settings.recording_part_minutes, round(1e9 * settings.recordings_keep_free_gb)
        self._process = await asyncio.to_thread(
            started,
            "vssea recorder",
            ENTRY,
            ring_name,
            str(settings.recordings_folder),
            part_s,
            keep_free,
            resumed,
            theirs,
        )
        theirs.close()
        asyncio.get_running_loop().add_reader(self._pipe.fileno(), self._receive)
        self._sender = Thread(target=self._send_all, args=(self._pipe,), name="to the recorder", daemon=True)
        self._sender.start()

    def send(self, item: Item) -> None:
        """Queue an item."""
        self._queue.put(item)

    async def stop(self) -> None:
        """Send what is queued, close the pipe, and wait until the writer has finished its file."""
        self._queue.put(None)
        if self._sender is not None:
            await asyncio.to_thread(self._sender.join, LEAVE_LIMIT_S)
        self._close()
        process, self._process = self._process, None
        if process is None:
            return
        await asyncio.to_thread(process.join, LEAVE_LIMIT_S)
        if process.exitcode is None:
            process.kill()

    def _receive(self) -> None:
        pipe = self._pipe
        try:
            while pipe is not None and not pipe.closed and pipe.poll():
                self._take(pipe.recv())
        except (EOFError, OSError):
            self._close()
            self._queue.put(None)
            self.ended.set()

    def _close(self) -> None:
        if self._pipe is not None and not self._pipe.closed:
            asyncio.get_running_loop().remove_reader(self._pipe.fileno())
            self._pipe.close()

    def _send_all(self, pipe: Connection) -> None:
        """Send until told to end; what a dead writer did not get is sent again to the next one."""
        while (item := self._queue.get()) is not None:
            try:
                pipe.send(item)
            except (OSError, ValueError):
                return
