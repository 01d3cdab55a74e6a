"""What runs, kept for the next start. A database in trouble is told once in the log; the session goes on without it."""

import asyncio
from typing import TYPE_CHECKING

from backend.presets.documents import Documents
from backend.presets.last import Last, keep_last, read_last
from backend.problem import Problem

if TYPE_CHECKING:
    from backend.session.session import Session

SAVE_AFTER_S = 1.0


class KeptRun:
    """Reads the last run at the start, writes the present one as it changes."""

    def __init__(self, presets: Documents, session: "Session") -> None:
        self._presets, self._session = presets, session
        self._was_read = False
        self._timer: asyncio.TimerHandle | None = None
        self._told: str | None = None

    async def read(self) -> Last | None:
        """Return what ran last, None if nothing did or it cannot be read."""
        try:
            last = await asyncio.to_thread(read_last, self._presets.database, self._presets)
        except Problem as problem:
            # What could not be read must not be written over by a session that began without it.
            self._tell(problem, " What runs now is not kept for the next start.")
            return None
        self._was_read = True
        return last

    def soon(self) -> None:
        """Keep what runs once changes rest; what runs on a rig is not begun with again."""
        if self._session.rig.file is not None:
            return
        if self._timer is not None:
            self._timer.cancel()
        session = self._session
        self._timer = asyncio.get_running_loop().call_later(SAVE_AFTER_S, lambda: session.spawn(self._rested()))

    async def now(self) -> None:
        """Keep at once what waits to be kept."""
        if self._timer is not None:
            self._timer.cancel()
            await self._rested()

    async def _rested(self) -> None:
        self._timer = None
        await self.write()

    async def write(self) -> None:
        """Keep what runs, unless the last run could not be read."""
        if not self._was_read:
            return
        session = self._session
        try:
            await asyncio.to_thread(keep_last, self._presets.database, session.beginning, session.preset)
        except Problem as problem:
            self._tell(problem, "")
        else:
            self._told = None

    def _tell(self, problem: Problem, consequence: str) -> None:
        if problem.title != self._told:
            self._told = problem.title
            self._session.note("preset", f"{problem.detail}{consequence}", "server", "warning")
