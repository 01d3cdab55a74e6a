"""Margins of the tuning in force, computed in a worker after each change; only the newest question is answered."""

import asyncio
import logging
from collections.abc import Callable
from typing import Any

from backend.compute.pool import JobFailedError, JobRefusedError, Worker
from vssea_core.scenario import Scenario

logger = logging.getLogger(__name__)
Message = dict[str, Any]
TIME_LIMIT_S = 20.0


class LiveMargins:
    """Keeps the margins of the newest scenario that was asked about."""

    def __init__(self, worker: Worker, tell: Callable[[Message], None]) -> None:
        self._worker, self._tell = worker, tell
        self._wanted: tuple[Scenario, int] | None = None
        self._runner: asyncio.Task[None] | None = None
        self.newest: Message | None = None

    def ask(self, scenario: Scenario, tuning_id: int) -> None:
        """Compute the margins of `scenario` as soon as the worker is free, unless something newer is asked before."""
        self._wanted = scenario, tuning_id
        if self._runner is None or self._runner.done():
            self._runner = asyncio.create_task(self._answer())

    async def stop(self) -> None:
        """Give up what is being computed."""
        if self._runner is not None:
            self._runner.cancel()
            await asyncio.gather(self._runner, return_exceptions=True)

    async def _answer(self) -> None:
        while self._wanted is not None:
            (scenario, tuning_id), self._wanted = self._wanted, None
            try:
                found = await self._worker.run("margins_of", scenario, time_limit_s=TIME_LIMIT_S)
            except (JobRefusedError, JobFailedError) as failure:
                logger.warning("margins were not computed: %s", failure)
                found = {"available": False, "reason": f"not computed: {failure}"}
            self.newest = {"type": "margins", "tuning_id": tuning_id, **found}
            self._tell(self.newest)
