"""One batch while it runs: the parts that are missing are computed and kept, until all are there or it is cancelled."""

import asyncio
import logging
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from backend.batch.catalogue import Row
from backend.batch.engine import Engine, PartFailed, PartFiles, PartTask
from backend.batch.folder import BatchFolder, Division
from backend.batch.limits import Limits, TooLarge
from backend.batch.listed import listed
from backend.batch.part_run import parts_of, run_parts
from backend.batch.progress import RunCounts, summed
from backend.batch.times import Times
from backend.batch.version import model_version
from backend.compute.pool import JobFailedError, JobRefusedError, Jobs

logger = logging.getLogger(__name__)
READ_LIMIT_S = 900.0
NOTED_EVERY_S = 5.0
"""What it has taken by then is kept so often, for the time after a kill."""
UNEXPECTED = "an internal error; the server's log has the details"
ANEW = "computed from its start: the parts that were kept are of another version of the model"


class Running:
    """Runs a batch once; `changed` is called after every part, `note` in a thread now and then."""

    def __init__(
        self,
        row: Row,
        folder: BatchFolder,
        engine: Engine,
        results: Jobs,
        limits: Limits,
        changed: Callable[[], None],
        times: Times,
        note: Callable[[Row], None] = lambda row: None,
    ) -> None:
        self.row, self._folder, self._engine, self._results = row, folder, engine, results
        self._limits, self._changed, self._clock, self._sleep = limits, changed, times.clock, times.sleep
        self._note, self._begun_s, self._noted_s = note, times.clock(), times.clock()
        self._size = 0
        self._work: asyncio.Task[None] | None = None
        self._is_cancelled = False
        self.progress = self._counted({}, 0)
        self.ended = asyncio.Event()
        """Set when what became of it is kept."""

    def document(self) -> dict[str, Any]:
        """Return it as REST gives it."""
        return listed(self.so_far(), self.progress, self._engine.waiting_for)

    def so_far(self) -> Row:
        """Return its row with what is known now."""
        facts = {
            "counts": dict(self.progress.counts), "parts_done": self.progress.parts_done, "rate": self.progress.rate,
            "engine": self._engine.name,
        }  # fmt: skip
        seconds = self.row.seconds + self._clock() - self._begun_s
        return replace(self.row, seconds=seconds, summary=self.row.summary | facts)

    def cancel(self) -> None:
        """End the parts under way; those that are done stay."""
        self._is_cancelled = True
        if self._work is not None:
            self._work.cancel()

    async def run(self) -> Row:
        """Compute what is missing and return what became of it. Cancelled, it ends the parts under way first."""
        self._work = asyncio.create_task(self._compute())
        if self._is_cancelled:
            self._work.cancel()
        try:
            await asyncio.wait({self._work})
        except asyncio.CancelledError:
            self._work.cancel()
            await asyncio.wait({self._work})
            raise
        state, reason = self._outcome(self._work)
        return replace(self.so_far(), state=state, reason=reason or self.row.reason)

    async def _compute(self) -> None:
        document = await asyncio.to_thread(self._folder.document)
        parts = parts_of(document, self.row.runs, self.row.part_size)
        kept = await self._kept()
        missing = [part for part in parts if part.number not in kept]
        if missing and not await self._is_of_this_version(len(kept)):
            kept, missing = {}, parts
        if kept:
            self._size = await asyncio.to_thread(self._folder.size)
            self.progress = self._counted(summed(kept.values()), len(kept))
        await run_parts(self._engine, missing, self._keep, self._sleep)

    async def _kept(self) -> dict[int, dict[str, int]]:
        """Return the runs by state of each part that is there; one that cannot be read is put aside, as if it were missing."""
        if not await asyncio.to_thread(self._folder.parts):
            return {}
        path = str(self._folder.path)
        found = await self._results.run("counts_by_part", path, time_limit_s=READ_LIMIT_S)
        for number in [number for number, counts in found.items() if counts is None]:
            await asyncio.to_thread(self._folder.put_aside, number)
            logger.warning("batch %s: part %d cannot be read and is computed again", self.row.id, number)
        return {number: counts for number, counts in found.items() if counts is not None and number < self.row.parts}

    async def _is_of_this_version(self, kept: int) -> bool:
        """Return whether parts that come now belong to the `kept` ones; else these are removed."""
        division = Division(self.row.part_size, model_version())
        if await asyncio.to_thread(self._folder.division) == division:
            return True
        await asyncio.to_thread(self._folder.begin_anew, division)
        if kept:
            logger.warning(
                "batch %s is computed from its start: its %d parts are of another version", self.row.id, kept
            )
            self.row = replace(self.row, reason=ANEW)
        return False

    async def _keep(self, part: PartTask, files: PartFiles) -> None:
        self._size += await asyncio.to_thread(self._folder.keep, part.number, files)
        self.progress.add(files.counts)
        self._changed()
        if self._clock() - self._noted_s >= NOTED_EVERY_S:
            self._noted_s = self._clock()
            await asyncio.to_thread(self._note, self.so_far())
        self._limits.check_kept(self._size)

    def _counted(self, counts: dict[str, int], parts: int) -> RunCounts:
        return RunCounts(self.row.runs, self.row.parts, counts, parts, self._clock, self._engine.threads)

    def _outcome(self, work: asyncio.Task[None]) -> tuple[str, str]:
        if work.cancelled():
            return "cancelled", ""
        match work.exception():
            case None:
                return "done", ""
            case PartFailed() | TooLarge() | JobFailedError() | JobRefusedError() as failure:
                reason = str(failure)
            case OSError() as failure:
                reason = f"{self._folder.path} cannot be read or written: {failure.strerror or failure}"
            case failure:
                logger.error("batch %s failed", self.row.id, exc_info=failure)
                reason = UNEXPECTED
        return "failed", reason
