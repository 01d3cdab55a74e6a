"""The control process as the web process sees it: started, told, listened to, and noticed when it dies."""

import asyncio
from collections.abc import Callable
from contextlib import suppress
from itertools import count
from multiprocessing.process import BaseProcess

from backend.loop.messages import Command, Done, Ready, Refused, Report
from backend.problem import Problem, refused
from backend.processes import CONTEXT, started

ENTRY = "backend.loop.process:run_control_process"
RIG_ENTRY = "backend.loop.rig_process:run_rig_process"
ANSWER_LIMIT_S = 2.0
FAREWELL_LIMIT_S = 10.0
START_LIMIT_S = 120.0
LEAVE_LIMIT_S = 3.0


class ControlLink:
    """Sends commands and awaits what became of them; reports of the state go to `listener`, its end to `lost`.

    Who awaits a command goes on before the reports that came after its answer are told.
    """

    def __init__(self, listener: Callable[[Report], None], lost: Callable[[], None]) -> None:
        self._listener, self._lost = listener, lost
        self._numbers = count(1)
        self._waiting: dict[int, asyncio.Future[Done]] = {}
        self._process: BaseProcess | None = None
        self._ready: asyncio.Future[None] | None = None

    async def start(self, *shared: str, epoch: int, entry: str = ENTRY) -> None:
        """Start the process and return when its kernels are compiled; its first run is the one after `epoch`.

        `shared` are the names of its shared memory: ring, stop flag and, for a rig, signs of life.

        Raises Problem if it ends or takes too long.
        """
        await self.stop()  # never two writers
        self._ready = asyncio.get_running_loop().create_future()
        self._pipe, theirs = CONTEXT.Pipe()
        self._process = await asyncio.to_thread(started, "vssea control", entry, *shared, epoch, theirs)
        theirs.close()
        asyncio.get_running_loop().add_reader(self._pipe.fileno(), self._receive)
        try:
            async with asyncio.timeout(START_LIMIT_S):
                await self._ready
        except TimeoutError as error:
            self._process.kill()
            raise _silent() from error

    async def command(self, command: Command, limit_s: float = ANSWER_LIMIT_S) -> Done:
        """Return when the command took effect. Raises Problem if it was refused or the process does not answer."""
        if self._ready is None or not self._ready.done():
            raise Problem(503, "Starting", "The session is still starting; try again in a moment.")
        number = next(self._numbers)
        future: asyncio.Future[Done] = asyncio.get_running_loop().create_future()
        self._waiting[number] = future
        try:
            self._pipe.send((number, command))
            async with asyncio.timeout(limit_s):
                return await future
        except (OSError, TimeoutError) as error:
            raise _silent() from error
        finally:
            self._waiting.pop(number, None)

    @property
    def ended(self) -> bool:
        """Whether the process has ended by itself: its end of the pipe is closed."""
        return self._process is not None and self._pipe.closed

    async def stop(self, farewell: Command | None = None) -> None:
        """Close the pipe, which ends the process, and make sure that it ended; `farewell` is said before, if it listens."""
        process, self._process = self._process, None  # from here on its end is no loss
        if process is None:
            return
        if farewell is not None:
            with suppress(Problem):
                await self.command(farewell, FAREWELL_LIMIT_S)
        self._close()
        await asyncio.to_thread(process.join, LEAVE_LIMIT_S)
        if process.exitcode is None:
            process.kill()

    def _receive(self) -> None:
        try:
            while self._pipe.poll():
                self._take(self._pipe.recv())
        except (EOFError, OSError):
            self._close()
            for future in (self._ready, *self._waiting.values()):
                if future is not None and not future.done():
                    future.set_exception(_silent())
            if self._process is not None:
                asyncio.get_running_loop().call_soon(self._lost)

    def _take(self, report: Report) -> None:
        if isinstance(report, Ready):
            if self._ready is not None and not self._ready.done():
                self._ready.set_result(None)
        elif isinstance(report, Done | Refused):
            future = self._waiting.get(report.number)
            if future is None or future.done():
                return
            if isinstance(report, Done):
                future.set_result(report)
            else:
                future.set_exception(refused(f"{report.sentence[:1].upper()}{report.sentence[1:].rstrip('.')}."))
            return
        asyncio.get_running_loop().call_soon(self._listener, report)

    def _close(self) -> None:
        if not self._pipe.closed:
            asyncio.get_running_loop().remove_reader(self._pipe.fileno())
            self._pipe.close()


def _silent() -> Problem:
    return Problem(503, "No answer", "The control process does not answer; press Reset, or restart the server.")
