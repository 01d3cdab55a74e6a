"""The batches of a server: asked for, computed one after the other, taken up again after a stop, cancelled, deleted."""

import asyncio
import hashlib
import logging
import secrets
import time
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Protocol

from backend.batch.catalogue import ACTIVE, BatchCatalogue, Row
from backend.batch.engine import Engine
from backend.batch.folder import BatchFolder
from backend.batch.limits import Limits
from backend.batch.listed import listed
from backend.batch.news import News, Tell
from backend.batch.running import Running
from backend.compute.pool import JobFailedError, JobRefusedError
from backend.problem import Problem, refused
from backend.store.troubles import Clash
from vssea_core.batch.document import Batch
from vssea_core.field_errors import FieldError

logger = logging.getLogger(__name__)
RETRY_S = 10.0
PLAN_LIMIT_S = 120.0
Document = dict[str, Any]


class Jobs(Protocol):
    """Where documents are planned or results are read: a worker process."""

    async def run(self, job: str, *arguments: Any, time_limit_s: float = 60.0) -> Any:
        """Return what the job returns."""


def utc_now() -> datetime:
    """Return the time of day."""
    return datetime.now(UTC)


def text_of(moment: datetime) -> str:
    """Return a time of day as the API writes it."""
    return moment.isoformat(timespec="milliseconds").replace("+00:00", "Z")


class Batches:
    """All batches of one folder, with one that runs; `plans` and `results` are the workers that are asked about them."""

    def __init__(
        self,
        folder: Path,
        limits: Limits,
        catalogue: BatchCatalogue,
        engine: Engine,
        plans: Jobs,
        results: Jobs,
        clock: Callable[[], float] = time.monotonic,
        now: Callable[[], datetime] = utc_now,
    ) -> None:
        self.folder, self.engine, self.plans, self.results = folder, engine, plans, results
        self._limits, self._catalogue, self._clock, self._now = limits, catalogue, clock, now
        self._waiting: deque[Row] = deque()
        self._running: Running | None = None
        self._woken = asyncio.Event()
        self._work: asyncio.Task[None] | None = None
        self._news = News(clock)

    def start(self, tell: Tell) -> None:
        """Go on with what a stop has left, then with what is asked for; `tell` hears how far it is."""
        self._news.hear(tell)
        self._work = asyncio.create_task(self._run_all())

    async def stop(self) -> None:
        """End the parts under way; the batch goes on at the next start."""
        if self._work is not None:
            self._work.cancel()
            await asyncio.gather(self._work, return_exceptions=True)
        await self.engine.end()

    # ---- what there is

    async def row(self, batch: str) -> Row:
        """Return a batch. Raises Problem if there is none."""
        row = await asyncio.to_thread(self._catalogue.find, batch)
        if row is None:
            raise Problem(404, "No such batch", f"There is no batch {batch!r}; GET /api/batches lists them.")
        return row

    def folder_of(self, row: Row) -> BatchFolder:
        """Return where a batch's files are."""
        return BatchFolder(self.folder / row.id)

    async def document(self, batch: str) -> Document:
        """Return a batch as REST gives it. Raises Problem if there is none."""
        running = self._running  # what it says later on is newer than the row
        return _document(await self.row(batch), running)

    async def list(self, state: str | None, offset: int, limit: int) -> Document:
        """Return batches, newest first."""
        running = self._running
        total, rows = await asyncio.to_thread(self._catalogue.list, state, offset, limit)
        return {"offset": offset, "total": total, "batches": [_document(row, running) for row in rows]}

    # ---- what can be done

    async def estimate(self, batch: Batch) -> Document:
        """Return what a batch would take. Raises Problem if it makes no sense or is too large."""
        self._limits.check_runs(batch)
        return await self._planned(batch)

    async def create(self, batch: Batch, key: str | None = None) -> tuple[Row, bool]:
        """Return a new batch that waits for its turn, or the one that was asked for with the same key; and whether it is new.

        Raises Problem.
        """
        document = batch.model_dump_json()
        digest = hashlib.sha256(document.encode()).hexdigest()
        if key is not None and (found := await asyncio.to_thread(self._catalogue.find_key, key)):
            return _same(found, digest), False
        self._limits.check_runs(batch)
        plan = await self._planned(batch)
        if plan["all_refused"]:
            reason = plan["refused"][0]
            raise refused(f"No run of this batch can start. {reason}.", FieldError("vary", None, reason))
        self._limits.check_bytes(plan["bytes"])
        self._limits.check_waiting(len(self._waiting))
        now = self._now()
        facts = {
            "description": batch.description, "paths": plan["paths"], "columns": plan["columns"],
            "trajectories": batch.keep.trajectories, "engine": self.engine.name,
        }  # fmt: skip
        row = Row(_new_id(now), batch.name, key, digest, "queued", text_of(now), plan["runs"], plan["part_size"], facts)
        return await self._kept(row, document)

    async def _kept(self, row: Row, document: str) -> tuple[Row, bool]:
        folder = self.folder_of(row)
        try:
            await asyncio.to_thread(folder.create, document)
        except OSError as error:
            raise Problem(507, "Not kept", f"{self.folder} cannot be written: {error.strerror or error}.") from error
        try:
            await asyncio.to_thread(self._catalogue.add, row)
        except Clash:  # the same key, a moment earlier
            await asyncio.to_thread(folder.delete)
            found = await asyncio.to_thread(self._catalogue.find_key, str(row.key))
            if found is None:
                raise
            return _same(found, row.digest), False
        except Problem:
            await asyncio.to_thread(folder.delete)
            raise
        if all(row.id != other.id for other in (*self._waiting, *self._begun())):  # else the start has just found it
            self._waiting.append(row)
            self._woken.set()
        self._news.tell(row.id, row.state, 0.0)
        return row, True

    async def cancel(self, batch: str) -> Document:
        """End a batch that waits or runs, and return its document; the parts that are done stay. Raises Problem."""
        running = self._running
        if running is not None and running.row.id == batch:
            running.cancel()
            await running.ended.wait()
        elif waiting := next((row for row in self._waiting if row.id == batch), None):
            self._waiting.remove(waiting)
            cancelled = replace(waiting, state="cancelled", ended_at=text_of(self._now()))
            try:
                await asyncio.to_thread(self._catalogue.put, cancelled)
            except Problem:
                self._waiting.append(waiting)
                self._woken.set()
                raise
            self._news.tell(cancelled.id, cancelled.state, 0.0)
        return await self.document(batch)

    async def delete(self, batch: str) -> None:
        """Delete a batch that has ended, with its results. Raises Problem."""
        row = await self.row(batch)
        if row.state in ACTIVE:
            raise Problem(409, "Not ended", f"The batch {row.name!r} is {row.state}; cancel it first.")
        await asyncio.to_thread(self._catalogue.forget, batch)
        await asyncio.to_thread(self.folder_of(row).delete)
        self._news.tell(row.id, "deleted", 0.0)

    # ---- in the background

    async def _run_all(self) -> None:
        self._waiting.extendleft(reversed(await self._left_over()))
        while True:
            while self._waiting:
                await self._run(self._waiting.popleft())
            self._woken.clear()
            await self._woken.wait()

    async def _run(self, row: Row) -> None:
        begun = replace(row, state="running", started_at=row.started_at or text_of(self._now()))
        running = self._running = Running(
            begun, self.folder_of(row), self.engine, self.results, self._limits, self._changed, self._clock
        )
        final: Row | None = None
        try:
            await self._put(begun)
            final = replace(await running.run(), ended_at=text_of(self._now()))
            await self._put(final)
        except asyncio.CancelledError:  # the server stops
            with suppress(Problem):
                await asyncio.to_thread(self._catalogue.put, final or running.so_far())
            raise
        finally:
            self._running = None
            running.ended.set()

    def _begun(self) -> tuple[Row, ...]:
        return () if self._running is None else (self._running.row,)

    def _changed(self) -> None:
        if self._running is not None:
            self._news.progress(self._running.row.id, self._running.progress.share)

    async def _put(self, row: Row) -> None:
        """Keep what became of a batch, as soon as the database can."""
        while True:
            try:
                await asyncio.to_thread(self._catalogue.put, row)
            except Problem as problem:
                logger.info("batch %s waits for the database: %s", row.id, problem.detail)
                await asyncio.sleep(RETRY_S)
            else:
                break
        self._news.tell(row.id, row.state, 0.0 if self._running is None else self._running.progress.share)

    async def _left_over(self) -> Sequence[Row]:
        while True:
            try:
                rows = await asyncio.to_thread(self._catalogue.active)
            except Problem as problem:
                logger.info("batches wait for the database: %s", problem.detail)
                await asyncio.sleep(RETRY_S)
            else:
                known = {row.id for row in self._waiting}
                return [row for row in rows if row.id not in known]

    async def _planned(self, batch: Batch) -> Document:
        workers = max(1, self.engine.workers)
        try:
            plan: Document = await self.plans.run(
                "plan_batch", batch.model_dump_json(), workers, time_limit_s=PLAN_LIMIT_S
            )
        except JobRefusedError as refusal:
            sentence = str(refusal)
            raise refused(f"{sentence[:1].upper()}{sentence[1:]}.", FieldError("vary", None, sentence)) from refusal
        except JobFailedError as failure:
            raise Problem(503, "Not planned", f"The batch could not be planned: {failure}.") from failure
        return plan


def _document(row: Row, running: Running | None) -> Document:
    return (
        running.document() if running is not None and running.row.id == row.id and row.state in ACTIVE else listed(row)
    )


def _new_id(now: datetime) -> str:
    return f"{now:%Y%m%d-%H%M%S}-{now.microsecond // 1000:03d}-{secrets.token_hex(3)}"


def _same(found: Row, digest: str) -> Row:
    """Return the batch that a key belongs to. Raises Problem if it was asked for with another document."""
    if found.digest != digest:
        expected = "expected a new key for another document"
        raise refused(
            f"The Idempotency-Key {found.key!r} belongs to the batch {found.id}, whose document is another one; {expected}.",
            FieldError("Idempotency-Key", found.key, expected),
        )
    return found
