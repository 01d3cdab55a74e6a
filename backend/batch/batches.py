"""The batches of a server: asked for, looked at, cancelled, deleted."""

import asyncio
import logging
from dataclasses import replace
from pathlib import Path
from typing import Any

from backend.batch.admission import Admission, same
from backend.batch.catalogue import ACTIVE, BatchCatalogue, Row
from backend.batch.engine import Engine
from backend.batch.folder import DELETED, BatchFolder, Division
from backend.batch.limits import Limits
from backend.batch.listed import listed
from backend.batch.news import News, Tell
from backend.batch.queue import BatchQueue
from backend.batch.running import Running
from backend.batch.sweep import sweep
from backend.batch.times import Times
from backend.batch.version import model_version
from backend.compute.pool import Jobs
from backend.problem import Problem
from backend.store.troubles import Clash

logger = logging.getLogger(__name__)
Document = dict[str, Any]


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
        times: Times = Times(),  # noqa: B008 - frozen
    ) -> None:
        self.folder, self.engine, self.plans, self.results = folder, engine, plans, results
        self._limits, self._catalogue, self._news = limits, catalogue, News(times.clock)
        self._turn = asyncio.Lock()  # a batch is made, resumed or deleted, or folders are swept
        self._sweeping: asyncio.Task[None] | None = None
        self._admission = Admission(limits, engine, plans, times)
        self._queue = BatchQueue(folder, limits, catalogue, engine, results, self._news, times)

    def start(self, tell: Tell) -> None:
        """Go on with what a stop has left, then with what is asked for; `tell` hears how far it is."""
        self._news.hear(tell)
        self._queue.start()
        self._sweeping = asyncio.create_task(self._swept())

    async def stop(self) -> None:
        """End the parts under way; the batch goes on at the next start."""
        if self._sweeping is not None:
            self._sweeping.cancel()
            await asyncio.gather(self._sweeping, return_exceptions=True)
        await self._queue.stop()
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

    async def document_path(self, row: Row) -> Path:
        """Return the file of the document that a batch was started with. Raises Problem if it is gone."""
        path = self.folder_of(row).document_path
        if not await asyncio.to_thread(path.exists):
            what = f"The document of the batch {row.name!r} is gone: there is no {path}."
            raise Problem(404, "No document", f"{what} Put the file back, or delete the batch.")
        return path

    async def document(self, batch: str) -> Document:
        """Return a batch as REST gives it. Raises Problem if there is none."""
        running = self._queue.running  # what it says later on is newer than the row
        return _document(await self.row(batch), running)

    async def list(self, state: str | None, offset: int, limit: int) -> Document:
        """Return batches, newest first."""
        running = self._queue.running
        total, rows = await asyncio.to_thread(self._catalogue.list, state, offset, limit)
        return {"offset": offset, "total": total, "batches": [_document(row, running) for row in rows]}

    # ---- what can be done

    async def estimate(self, body: bytes) -> Document:
        """Return what the batch in a request's body would take. Raises Problem if it makes no sense or is too large."""
        return await self._admission.estimate(await self._admission.read(body))

    async def create(self, body: bytes, key: str | None = None) -> tuple[Row, bool]:
        """Return a new batch that waits for its turn, or the one that was asked for with the same key; and whether it is new.

        `body` is a document as JSON; workers see to it, since a large one would hold up the loop. Raises Problem.
        """
        asked = await self._admission.read(body)
        if key is not None and (found := await asyncio.to_thread(self._catalogue.find_key, key)):
            return same(found, asked.digest), False
        await self._queue.hold()
        row = await self._admission.row(asked, key)
        self._limits.check_waiting(self._queue.length)
        async with self._turn:
            return await self._kept(row, asked.document)

    async def _kept(self, row: Row, document: str) -> tuple[Row, bool]:
        folder = self.folder_of(row)
        try:
            await asyncio.to_thread(folder.create, document, Division(row.part_size, model_version()))
            await asyncio.to_thread(self._catalogue.add, row)
        except OSError as error:
            await _removed(folder)
            raise Problem(507, "Not kept", f"{self.folder} cannot be written: {error.strerror or error}.") from error
        except Clash:  # the same key, a moment earlier
            await _removed(folder)
            found = await asyncio.to_thread(self._catalogue.find_key, str(row.key))
            if found is None:
                raise
            return same(found, row.digest), False
        except Problem:
            await _removed(folder)
            raise
        self._queue.add(row)
        self._news.tell(row.id, row.state, 0.0)
        return row, True

    async def cancel(self, batch: str) -> Document:
        """End a batch that waits or runs, and return its document; the parts that are done stay. Raises Problem."""
        row = await self.row(batch)
        if row.state in ACTIVE:
            await self._queue.cancel(batch)
        found = await self.document(batch)
        if found["state"] in ACTIVE:
            why = f"The batch {row.name!r} is {found['state']}, but this server has not taken it up"
            raise Problem(409, "Not cancelled", f"{why}; try again, or start the server anew.")
        return found

    async def resume(self, batch: str) -> Document:
        """Let a batch that has ended wait for its turn again, for the parts that are missing. Raises Problem."""
        async with self._turn:
            row = await self.row(batch)
            await self._queue.hold()
            if row.state in ACTIVE:
                raise Problem(409, "Not ended", f"The batch {row.name!r} is {row.state}; there is nothing to resume.")
            self._limits.check_waiting(self._queue.length)
            await self._queue.ended(batch)
            queued = replace(row, state="queued", reason="", ended_at=None)
            await asyncio.to_thread(self._catalogue.put, queued)
            self._queue.add(queued)
            self._news.tell(queued.id, queued.state, listed(queued)["progress"]["share"])
        return await self.document(batch)

    async def delete(self, batch: str) -> None:
        """Delete a batch that has ended, with its results. Raises Problem."""
        async with self._turn:
            row = await self.row(batch)
            await self._queue.hold()
            if row.state in ACTIVE:
                raise Problem(409, "Not ended", f"The batch {row.name!r} is {row.state}; cancel it first.")
            try:
                deleted = await asyncio.to_thread(self.folder_of(row).renamed, DELETED)
            except OSError as error:
                raise self._not_deleted(row, error) from error
            try:
                await asyncio.to_thread(self._catalogue.forget, batch)
            except Problem:
                await asyncio.to_thread(deleted.renamed, "")
                raise
            try:
                await asyncio.to_thread(deleted.delete)
            except OSError as error:
                await asyncio.to_thread(self._catalogue.add, row)  # so that it can be seen, resumed, deleted again
                await asyncio.to_thread(deleted.renamed, "")
                raise self._not_deleted(row, error) from error
        self._news.tell(row.id, "deleted", 0.0)

    def _not_deleted(self, row: Row, error: OSError) -> Problem:
        why = f"The files of the batch {row.name!r} cannot be removed: {error.strerror or error}."
        return Problem(507, "Not deleted", f"{why} It is still listed; see to the rights of {self.folder}.")

    async def _swept(self) -> None:
        await self._queue.held.wait()  # another server may be making a batch
        async with self._turn:
            try:
                await asyncio.to_thread(lambda: sweep(self.folder, self._catalogue.ids()))
            except (Problem, OSError) as problem:
                logger.info("left folders of batches are looked for at the next start: %s", problem)
            except Exception:
                logger.exception("left folders of batches are looked for at the next start")


async def _removed(folder: BatchFolder) -> None:
    try:
        await asyncio.to_thread(folder.delete)
    except OSError as error:
        logger.warning("%s cannot be removed now: %s; the next start tries again", folder.path, error)


def _document(row: Row, running: Running | None) -> Document:
    return (
        running.document() if running is not None and running.row.id == row.id and row.state in ACTIVE else listed(row)
    )
