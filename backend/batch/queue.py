"""Batches computed one after the other in the background, those first that a stop of the server has left."""

import asyncio
import logging
from collections import deque
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from backend.batch.catalogue import BatchCatalogue, Row
from backend.batch.engine import Engine
from backend.batch.folder import BatchFolder
from backend.batch.folder_lock import FolderLock
from backend.batch.limits import Limits
from backend.batch.news import News
from backend.batch.running import UNEXPECTED, Running
from backend.batch.times import Times
from backend.compute.pool import Jobs
from backend.problem import Problem

logger = logging.getLogger(__name__)
RETRY_S = 10.0
CANCEL_LIMIT_S = 10.0


class BatchQueue:
    """The batches that wait, and the one that runs."""

    def __init__(
        self,
        folder: Path,
        limits: Limits,
        catalogue: BatchCatalogue,
        engine: Engine,
        results: Jobs,
        news: News,
        times: Times,
    ) -> None:
        self._folder, self._limits, self._catalogue, self._engine = folder, limits, catalogue, engine
        self._results, self._news, self._times = results, news, times
        self._waiting: deque[Row] = deque()
        self._woken = asyncio.Event()
        self._lock, self._taking = FolderLock(folder), asyncio.Lock()
        self._taken_up = asyncio.Event()
        self.held = asyncio.Event()
        """Set when this server is the one that runs the batches of the folder."""
        self._work: asyncio.Task[None] | None = None
        self.running: Running | None = None

    @property
    def length(self) -> int:
        """How many batches wait."""
        return len(self._waiting)

    def start(self) -> None:
        """Go on with what a stop has left, then with what is added."""
        self._work = asyncio.create_task(self._run_all())
        self._work.add_done_callback(_log_end)

    async def stop(self) -> None:
        """End the parts under way; the batch goes on at the next start."""
        if self._work is not None:
            self._work.cancel()
            await asyncio.gather(self._work, return_exceptions=True)
        await asyncio.to_thread(self._lock.give_back)

    async def hold(self) -> None:
        """Be the one that runs the batches of the folder. Raises Problem while another server is."""
        async with self._taking:
            if not self.held.is_set():
                await asyncio.to_thread(self._lock.take)
                self.held.set()

    def add(self, row: Row) -> None:
        """Let a batch wait for its turn, unless it does so already."""
        if all(row.id != other.id for other in (*self._waiting, *self._begun())):
            self._waiting.append(row)
            self._woken.set()

    async def cancel(self, batch: str) -> None:
        """End a batch if it waits or runs; the parts that are done stay. Raises Problem."""
        await self.hold()
        if not await self._set_within(self._taken_up, CANCEL_LIMIT_S):
            raise Problem(
                503, "Not taken up", "The batches that were left are not taken up yet; try again in a moment."
            )
        running = self.running
        if running is not None and running.row.id == batch:
            running.cancel()
            await self._within_limit(running)
        elif waiting := next((row for row in self._waiting if row.id == batch), None):
            self._waiting.remove(waiting)
            cancelled = replace(waiting, state="cancelled", ended_at=self._times.text())
            try:
                await asyncio.to_thread(self._catalogue.put, cancelled)
            except BaseException:
                self.add(waiting)
                raise
            self._news.tell(cancelled.id, cancelled.state, 0.0)

    async def ended(self, batch: str) -> None:
        """Wait until a batch that has just ended makes room for another one."""
        if self.running is not None and self.running.row.id == batch:
            await self.running.ended.wait()

    async def _run_all(self) -> None:
        await self._hold_sometime()
        self._waiting.extendleft(reversed(await self._left_over()))
        self._taken_up.set()
        while True:
            while self._waiting:
                await self._run(self._waiting.popleft())
            self._woken.clear()
            await self._woken.wait()

    async def _hold_sometime(self) -> None:
        """Wait until no other server runs the batches of the folder; what it leaves is then taken up."""
        is_told = False
        while not self.held.is_set():
            try:
                await self.hold()
            except Problem as problem:
                if not is_told:
                    logger.warning("no batch is computed here: %s", problem.detail)
                is_told = True
                await self._set_within(self.held, RETRY_S)

    async def _run(self, row: Row) -> None:
        begun = replace(row, state="running", started_at=row.started_at or self._times.text())
        running = self.running = Running(
            begun,
            BatchFolder(self._folder / row.id),
            self._engine,
            self._results,
            self._limits,
            self._changed,
            self._times,
            self._noted,
        )
        final: Row | None = None
        try:
            await self._put(begun)
            final = replace(await running.run(), ended_at=self._times.text())
            await self._put(final)
        except asyncio.CancelledError:  # the server stops
            with suppress(Problem):
                await asyncio.to_thread(self._catalogue.put, final or running.so_far())
            raise
        except Exception:  # the others go on, whatever it is
            logger.exception("batch %s failed", row.id)
            await self._put_failed(running.so_far())
        finally:
            self.running = None
            running.ended.set()

    def _begun(self) -> tuple[Row, ...]:
        return () if self.running is None else (self.running.row,)

    def _changed(self) -> None:
        if self.running is not None:
            self._news.progress(self.running.row.id, self.running.progress.share)

    def _noted(self, row: Row) -> None:
        with suppress(Problem):  # it is noted again soon
            self._catalogue.put(row)

    async def _put(self, row: Row) -> None:
        """Keep what becomes of a batch, as soon as the database can."""
        while True:
            try:
                await asyncio.to_thread(self._catalogue.put, row)
            except Problem as problem:
                logger.info("batch %s waits for the database: %s", row.id, problem.detail)
                await self._times.sleep(RETRY_S)
            else:
                break
        self._news.tell(row.id, row.state, 0.0 if self.running is None else self.running.progress.share)

    async def _put_failed(self, row: Row) -> None:
        try:
            await self._put(replace(row, state="failed", reason=UNEXPECTED, ended_at=self._times.text()))
        except Exception:  # it is taken up again at the next start
            logger.exception("what became of batch %s is not kept", row.id)

    async def _within_limit(self, running: Running) -> None:
        """Wait until what became of a batch is kept. Raises Problem if the database takes too long."""
        if not await self._set_within(running.ended, CANCEL_LIMIT_S):
            raise Problem(
                503,
                "Not kept",
                f"The batch {running.row.name!r} ends, but the database could not keep that within {CANCEL_LIMIT_S:g} s. "
                "It is kept as soon as the database can be used; look again then.",
            )

    async def _set_within(self, event: asyncio.Event, limit_s: float) -> bool:
        """Wait for an event, but not for ever; return whether it is set."""
        if event.is_set():
            return True
        is_set, limit = asyncio.create_task(event.wait()), asyncio.create_task(self._times.sleep(limit_s))
        try:
            await asyncio.wait({is_set, limit}, return_when=asyncio.FIRST_COMPLETED)
        finally:
            is_set.cancel()
            limit.cancel()
        return event.is_set()

    async def _left_over(self) -> Sequence[Row]:
        while True:
            try:
                rows = await asyncio.to_thread(self._catalogue.active)
            except Problem as problem:
                logger.info("batches wait for the database: %s", problem.detail)
                await self._times.sleep(RETRY_S)
            except Exception:  # new ones are computed nevertheless
                logger.exception("the batches that a stop has left wait for the next start")
                return []
            else:
                known = {row.id for row in self._waiting}
                return [row for row in rows if row.id not in known]


def _log_end(work: asyncio.Task[None]) -> None:
    if not work.cancelled() and (failure := work.exception()) is not None:
        logger.error("no batch is computed until the server is restarted", exc_info=failure)
