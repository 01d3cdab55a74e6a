"""The recordings that are kept: found in their folder, finished if a crash left them open, summarised, listed, cleaned up."""

import asyncio
import logging
import shutil
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from backend.compute.pool import JobFailedError, JobRefusedError
from backend.problem import Problem
from backend.recordings.catalogue import Catalogue, Row
from backend.recordings.folder import Found, head_of, recordings_in, sweep
from backend.recordings.listed import listed, matches
from backend.recordings.recorder import Recorder
from backend.settings import Settings

logger = logging.getLogger(__name__)
TIDY_EVERY_S = 10.0
SUMMARY_LIMIT_S = 600.0
Tell = Callable[[dict[str, Any]], None]


class Jobs(Protocol):
    """Where files are read and finished: a worker process."""

    async def run(self, job: str, *arguments: Any, time_limit_s: float = 60.0) -> Any:
        """Return what the job returns."""


@dataclass(frozen=True)
class Look:
    """What is in folder and database at one moment; `heads` of files without a summary."""

    found: dict[str, Found]
    rows: dict[str, Row]
    heads: dict[str, dict[str, str]]
    trouble: str | None


class Library:
    """All recordings of one folder. A database that cannot be used costs the notes and stars, not the recordings."""

    def __init__(self, settings: Settings, catalogue: Catalogue, recorder: Recorder, jobs: Jobs) -> None:
        self.folder = settings.recordings_folder
        self.cache = self.folder / ".overviews"
        self._quota = round(1e9 * settings.recordings_quota_gb)
        self._catalogue, self._recorder, self._jobs = catalogue, recorder, jobs
        self._summaries: dict[str, dict[str, Any]] = {}
        self._due: asyncio.Queue[str] = asyncio.Queue()
        self._tasks: list[asyncio.Task[None]] = []
        self._tell: Tell = lambda _: None
        self._note: Callable[[str, bool], None] = lambda sentence, is_trouble: None
        self._is_full = False
        self._unreadable: set[str] = set()

    def start(self, tell: Tell, note: Callable[[str, bool], None]) -> None:
        """Finish what a crash left open, summarise what is new, and keep the folder within its quota."""
        self._tell, self._note = tell, note
        self._tasks = [asyncio.create_task(work) for work in (self._begin(), self._tidy_again_and_again())]

    async def stop(self) -> None:
        """End the background work."""
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    # ---- what there is

    def path_of(self, recording: str) -> Path:
        """Return the file of a recording. Raises Problem if there is none."""
        path = self.folder / f"{recording}.mcap"
        if "/" in recording or "\\" in recording or recording.startswith(".") or not path.is_file():
            raise Problem(
                404, "No such recording", f"There is no recording {recording!r}; GET /api/recordings lists them."
            )
        return path

    async def list(
        self,
        search: str = "",
        starred: bool | None = None,
        origin: str | None = None,
        limit: int = 50,
        before: str | None = None,
    ) -> dict[str, Any]:
        """Return recordings, newest first, with the disk and the recorder."""
        look = await asyncio.to_thread(self._look)
        entries = [self._entry(each, look) for each in look.found.values()]
        entries.sort(key=lambda entry: (entry["started_at"] or "", entry["id"]), reverse=True)
        chosen = [entry for entry in entries if matches(entry, search, starred, origin)]
        if before is not None:
            places = [place for place, entry in enumerate(chosen) if entry["id"] == before]
            chosen = chosen[places[0] + 1 :] if places else []
        return {
            "recordings": chosen[:limit], "more": len(chosen) > limit, "trouble": look.trouble,
            "disk": {
                "used_bytes": sum(each.size for each in look.found.values()), "quota_bytes": self._quota,
                "free_bytes": await asyncio.to_thread(_free, self.folder),
            },
            "recorder": self._recorder.document(),
        }  # fmt: skip

    async def entry(self, recording: str) -> dict[str, Any]:
        """Return one recording as `list` does. Raises Problem."""
        self.path_of(recording)
        look = await asyncio.to_thread(self._look)
        if recording not in look.found:
            raise Problem(404, "No such recording", f"The recording {recording!r} was just removed.")
        return self._entry(look.found[recording], look)

    def _look(self) -> Look:
        try:
            rows, trouble = self._catalogue.rows(), None
        except Problem as problem:
            rows, trouble = {}, problem.detail
        found, heads = recordings_in(self.folder), {}
        for each in found.values():
            if each.id not in rows or rows[each.id].summary is None:
                with suppress(OSError):
                    heads[each.id] = head_of(each.path)
        return Look(found, rows, heads, trouble)

    def _entry(self, found: Found, look: Look) -> dict[str, Any]:
        row = look.rows.get(found.id) or Row(found.id)
        is_written = found.id == self._recorder.present()
        summary = None if is_written else row.summary or self._summaries.get(found.id)
        progress = self._recorder.progress() if is_written else None
        return listed(found, row, summary, look.heads.get(found.id, {}), progress)

    # ---- what can be done to one

    async def edit(self, recording: str, changes: dict[str, Any], revision: int | None = None) -> dict[str, Any]:
        """Change name, note, tags or star. Raises Problem."""
        self.path_of(recording)
        await asyncio.to_thread(self._catalogue.edit, recording, changes, revision)
        self._changed()
        return await self.entry(recording)

    async def delete(self, recording: str) -> None:
        """Delete a recording. Raises Problem if it is starred or being written."""
        path = self.path_of(recording)
        if recording == self._recorder.present():
            raise Problem(409, "Being written", "This recording is being written; Reset begins another one.")
        row = await asyncio.to_thread(self._catalogue.row, recording)
        if row.starred:
            raise Problem(409, "Starred", f"{row.name or recording} is starred; take the star away first.")
        await asyncio.to_thread(path.unlink, missing_ok=True)
        await asyncio.to_thread(self._catalogue.forget, recording)
        self._changed()

    def added(self, recording: str) -> None:
        """Hear of a complete recording."""
        self._due.put_nowait(recording)
        self._changed()

    def _changed(self) -> None:
        self._tell({"type": "recordings"})

    # ---- in the background

    async def _begin(self) -> None:
        await asyncio.to_thread(self.folder.mkdir, parents=True, exist_ok=True)
        await asyncio.to_thread(sweep, self.folder)
        look = await asyncio.to_thread(self._look)
        for each in reversed(look.found.values()):
            if not await self._recovered(each) and each.id in look.heads:
                self.added(each.id)
        while True:
            await self._summarise(await self._due.get())

    async def _recovered(self, found: Found) -> bool:
        """Finish a recording that a crash or a full disk left open; return whether that was done."""
        if found.is_finished or found.id in self._unreadable or found.id == self._recorder.present():
            return False
        try:
            if not await self._jobs.run("recover", str(found.path)):
                return False
        except (JobFailedError, JobRefusedError) as failure:  # one file that cannot be read must not hide the others
            logger.warning("%s cannot be finished: %s", found.path, failure)
            self._unreadable.add(found.id)
            return False
        self._note(f"The recording {found.id} was left open and is finished now", False)
        self.added(found.id)
        return True

    async def _summarise(self, recording: str) -> None:
        try:
            summary = await self._jobs.run(
                "summarise", str(self.path_of(recording)), str(self.cache), time_limit_s=SUMMARY_LIMIT_S
            )
            self._summaries[recording] = summary
            await asyncio.to_thread(self._catalogue.summarised, recording, summary)
            self._summaries.pop(recording)
        except (JobFailedError, JobRefusedError, Problem) as failure:  # without its summary it is listed all the same
            logger.warning("no summary of %s: %s", recording, failure)
        self._changed()

    async def _tidy_again_and_again(self) -> None:
        while True:
            try:
                await self.tidy()
            except (OSError, Problem):
                logger.exception("the recordings could not be tidied")
            await asyncio.sleep(TIDY_EVERY_S)

    async def tidy(self) -> None:
        """Finish what was left open, then delete the oldest recordings beyond the quota, never a starred or pinned one.

        Without any to delete, recording stops.
        """
        found = await asyncio.to_thread(recordings_in, self.folder)
        for each in found.values():
            await self._recovered(each)
        used = sum(each.size for each in found.values())
        if used > self._quota:
            used = await self._make_room(found, used)
        is_full = used > self._quota
        if is_full != self._is_full:
            self._is_full = is_full
            self._recorder.hold(self._full_sentence(used) if is_full else None)

    async def _make_room(self, found: dict[str, Found], used: int) -> int:
        try:
            protected = await asyncio.to_thread(self._catalogue.protected)
        except Problem:
            return used  # what may be starred is not deleted
        for each in found.values():
            if used <= self._quota:
                break
            if each.id in protected or each.id == self._recorder.present() or not each.is_finished:
                continue
            await asyncio.to_thread(each.path.unlink, missing_ok=True)
            await asyncio.to_thread(self._catalogue.forget, each.id)
            used -= each.size
            self._note(f"The recording {each.id} was deleted: recordings may take {self._quota / 1e9:g} GB", False)
            self._changed()
        return used

    def _full_sentence(self, used: int) -> str:
        return (
            f"recordings take {used / 1e9:.2f} GB of the {self._quota / 1e9:g} GB that they may, and the rest is starred or "
            "pinned; delete some, or raise VSSEA_RECORDINGS_QUOTA_GB"
        )


def _free(folder: Path) -> int:
    try:
        return shutil.disk_usage(folder).free
    except OSError:
        return 0
