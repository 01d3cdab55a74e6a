"""What runs, kept for the next start. A database in trouble is told once in the log; the session goes on without it."""

import asyncio
from typing import TYPE_CHECKING

from backend.presets.documents import Documents
from backend.presets.last import Last, keep_last, read_last
from backend.problem import Problem

if TYPE_CHECKING:
    from backend.session.session import Session


class KeptRun:
    """Reads the last run at the start, writes the present one as it changes."""

    def __init__(self, presets: Documents, session: "Session") -> None:
        self._presets, self._session = presets, session
        self._was_read = False
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
