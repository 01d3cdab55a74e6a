"""A whole session without processes: its control loop turns when the test says so, and designs are made on the spot."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

from backend.compute.jobs import plan_run
from backend.compute.pool import JobRefusedError
from backend.loop import messages
from backend.loop.control_loop import ControlLoop
from backend.loop.pacer import Pacer
from backend.problem import refused
from backend.session.control_reports import ControlReports
from backend.session.events import Event
from backend.session.journal import Change, Run, Told
from backend.session.session import Session
from backend.settings import Settings
from backend.store.database import Database
from backend.telemetry.ring import RingWriter
from tests.backend.loop_bench import Pipe
from vssea_core.scenario import Scenario


class OnTheSpot:
    """A worker that does the session's jobs at once."""

    async def run(self, job: str, *arguments: Any, **_: Any) -> Any:
        if job != "plan_run":
            return {"available": False, "reason": "not on the bench"}
        try:
            return plan_run(*arguments)
        except ValueError as refusal:
            raise JobRefusedError(str(refusal)) from refusal


class Workers:
    def __init__(self) -> None:
        self.design = self.analysis = self.simulation = self.tasks = OnTheSpot()

    def process_ids(self) -> list[int]:
        return []


class BenchLink:
    """Hands each command to the loop, turns it once, and reports in the order in which the loop did."""

    def __init__(self, session: Session) -> None:
        self._reports = ControlReports(session)
        self._writer = RingWriter(session.ring_name)
        self._pipe = Pipe()
        pacer = Pacer(lambda: 0.0, lambda _: None)
        self.loop = ControlLoop(self._writer, session.flag, self._pipe, pacer)  # type: ignore[arg-type]
        self.ended = False
        self._number = 0

    async def start(self, *_: Any, **__: Any) -> None:
        """The loop is there."""

    async def command(self, command: messages.Command, limit_s: float = 0.0) -> messages.Done:
        self._number += 1
        self._pipe.inbox.append((self._number, command))
        answer = self.turn()
        if isinstance(answer, messages.Refused):
            raise refused(answer.sentence)
        assert isinstance(answer, messages.Done)
        return answer

    def turn(self) -> messages.Done | messages.Refused | None:
        """Turn once; what it reports is told at once, what follows an answer a moment later, as the real link does."""
        self.loop.turn()
        answer = None
        for report in self._pipe.outbox:
            if isinstance(report, messages.Done | messages.Refused):
                answer = report
            elif answer is None:
                self._reports.take(report)
            else:
                asyncio.get_running_loop().call_soon(self._reports.take, report)
        self._pipe.outbox.clear()
        return answer

    async def stop(self, farewell: messages.Command | None = None) -> None:
        del self._writer.header, self._writer.samples
        self._writer._memory.close()


class Diary:
    """A journal that keeps all it hears, in order."""

    def __init__(self) -> None:
        self.heard: list[Run | Change | Told | Event] = []
        self.begin = self.change = self.command = self.event = self.heard.append

    def of(self, kind: type[Any]) -> list[Any]:
        return [entry for entry in self.heard if isinstance(entry, kind)]


class SessionBench:
    """A session on the bench, with what its pages and its journal heard."""

    def __init__(self, session: Session, diary: Diary) -> None:
        self.session, self.diary = session, diary
        self.link = BenchLink(session)
        session.link = self.link  # type: ignore[assignment]
        self.told: list[dict[str, Any]] = []
        session.listeners.add(self.told.append)

    async def ask(self, command: str, by: str = "page 1", **arguments: Any) -> dict[str, Any]:
        answer = await self.session.command(command, arguments, by)
        await asyncio.sleep(0)
        return answer

    async def turns(self, count: int) -> None:
        for _ in range(count):
            self.link.turn()
        await asyncio.sleep(0)

    def told_of(self, kind: str) -> list[dict[str, Any]]:
        return [message for message in self.told if message["type"] == kind]


@asynccontextmanager
async def on_bench(folder: Path, scenario: Scenario, **options: Any) -> AsyncIterator[SessionBench]:
    """A session that runs `scenario` from t = 0."""
    database, diary = _opened(folder), options.pop("journal", Diary())
    kind = options.pop("bench", SessionBench)
    session = Session(Settings(data_dir=folder), Workers(), database, diary, **options)  # type: ignore[arg-type]
    bench: SessionBench = kind(session, diary)
    try:
        await session.runs.load(scenario)
        await asyncio.sleep(0)
        yield bench
    finally:
        await session.close()
        database.close()


def _opened(folder: Path) -> Database:
    folder.mkdir(parents=True, exist_ok=True)
    return Database(f"sqlite:///{folder / 'vssea.sqlite'}")
