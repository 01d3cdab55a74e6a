"""Pinned runs: spans of the present recording that stay beside the live run until they are let go."""

import asyncio
import logging
import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal

from backend.problem import Problem
from backend.session.arguments import ExcerptChange, ExcerptNumber, PinnedSpan
from backend.session.changes import differences
from backend.session.excerpt import Excerpt, ExcerptStore, Recordings
from backend.session.journal import wall_time
from backend.session.sentences import changes_words, several
from backend.telemetry.ring import EPOCH, WIDTH
from vssea_core.channels import INDEX
from vssea_core.signals.period import period_s
from vssea_core.simulation.metrics import METRICS

if TYPE_CHECKING:
    from backend.session.session import Session

logger = logging.getLogger(__name__)
Message = dict[str, Any]
LONGEST_LABEL = 200
MOST_PINS = 20
MOST_CAPTURED = 20
"""Of what triggers captured, and of faults, the oldest gives way; a pin is never dropped unasked."""


class Pins:
    """Adds, renames, hides and lets go; every page is told of the whole list."""

    def __init__(self, session: "Session", recordings: Recordings, store: ExcerptStore) -> None:
        self._session, self._recordings, self._store = session, recordings, store
        self._excerpts: dict[int, Excerpt] = {}
        self._turn = asyncio.Lock()

    async def load(self) -> None:
        """Take over what is kept; a store in trouble leaves the list as it was."""
        async with self._turn:
            try:
                kept = await asyncio.to_thread(self._store.list)
            except Problem as problem:
                logger.info("pinned runs cannot be read: %s", problem.detail)  # the log of the session says it already
                return
            before, self._excerpts = self._excerpts, {excerpt.id: excerpt for excerpt in kept}
        if before != self._excerpts:
            self._tell()

    def message(self) -> Message:
        """Return all of them as pages get them, oldest first."""
        return {"type": "pins", "pins": [excerpt.document() for excerpt in self._excerpts.values()]}

    async def pin(self, asked: PinnedSpan, by: str) -> Message:
        """Pin some seconds of this run, the last ones unless another end is given."""
        session = self._session
        newest = session.ring.latest()
        epoch = session.status.epoch
        if newest is None or int(newest[EPOCH]) != epoch:
            raise Problem(409, "Nothing to pin", "This run has no samples yet; press Run, then pin.")
        recording = self._recordings.of_run(epoch)
        if recording is None:
            raise Problem(
                409, "Not recorded", "This run is not recorded, so there is nothing to keep; see the recorder's state."
            )
        if sum(excerpt.kind == "pin" for excerpt in self._excerpts.values()) >= MOST_PINS:
            raise Problem(409, "Too many pins", f"There are {MOST_PINS} pinned runs; let one of them go first.")
        now_s = float(newest[INDEX["time"]])
        to_s = now_s if asked.to_s is None else asked.to_s
        if to_s > now_s:
            raise Problem(409, "Not yet", f"This run is at {now_s:.3f} s; it cannot be pinned up to {to_s:.3f} s.")
        excerpt = await self._excerpt(epoch, max(0.0, to_s - asked.seconds), to_s, by)
        own = several(list(excerpt.words)) if excerpt.words else f"{session.scenario.name} at {to_s:.1f} s"
        kept = await self._keep(replace(excerpt, recording=recording, label=(asked.label or own)[:LONGEST_LABEL]))
        session.note("pin", f"pinned {kept.label}", by)
        return kept.document()

    async def keep_capture(
        self,
        label: str,
        by: str,
        epoch: int,
        from_s: float,
        to_s: float,
        at_s: float,
        kind: Literal["trigger", "fault"] = "trigger",
    ) -> Excerpt:
        """Keep what a trigger captured, or what lies around a fault. Raises Problem if it cannot be kept."""
        excerpt = await self._excerpt(epoch, from_s, to_s, by)
        captured = [old.id for old in self._excerpts.values() if old.kind == kind]
        for number in captured[: max(0, len(captured) + 1 - MOST_CAPTURED)]:
            await self._remove(number)
        recording, label = self._recordings.of_run(epoch), label[:LONGEST_LABEL]
        return await self._keep(replace(excerpt, recording=recording, kind=kind, label=label, at_s=at_s, shown=False))

    async def change(self, asked: ExcerptChange, by: str) -> Message:
        """Give it another label, or show or hide it."""
        new = {name: value for name, value in (("label", asked.label), ("shown", asked.shown)) if value is not None}
        async with self._turn:
            changed: Excerpt = replace(self._known(asked.id), **new)  # type: ignore[arg-type]
            await asyncio.to_thread(self._store.change, changed)
            self._excerpts[changed.id] = changed
        self._tell()
        return changed.document()

    async def unpin(self, asked: ExcerptNumber, by: str) -> Message:
        """Let go of it; the recording stays."""
        async with self._turn:
            excerpt = self._known(asked.id)
            await self._remove(excerpt.id)
        self._tell()
        self._session.note("pin", f"let go of {excerpt.label}", by)
        return {}

    def _known(self, number: int) -> Excerpt:
        if number not in self._excerpts:
            raise Problem(
                404, "No such excerpt", f"There is no pinned run {number}; it may have been let go elsewhere."
            )
        return self._excerpts[number]

    async def _keep(self, excerpt: Excerpt) -> Excerpt:
        async with self._turn:
            kept = await asyncio.to_thread(self._store.add, excerpt)
            self._excerpts[kept.id] = kept
        self._tell()
        return kept

    async def _remove(self, number: int) -> None:
        await asyncio.to_thread(self._store.remove, number)
        self._excerpts.pop(number, None)

    async def _excerpt(self, epoch: int, from_s: float, to_s: float, by: str) -> Excerpt:
        scenario = self._session.scenario
        tuning = scenario.tuning.model_dump(mode="json")
        before = next((old.tuning for old in reversed(self._excerpts.values()) if old.tuning), tuning)
        words = tuple(changes_words(scenario, "tuning", differences(before, tuning)))
        period = period_s(scenario.reference)
        metrics = await asyncio.to_thread(self._metrics, epoch, from_s, to_s, scenario.timing.sample_time_s)
        return Excerpt(
            None, "pin", "", from_s, to_s, by, wall_time(), period_s=period, words=words,
            metrics=metrics, tuning=tuning,
        )  # fmt: skip

    def _metrics(self, epoch: int, from_s: float, to_s: float, sample_time_s: float) -> dict[str, float]:
        """Return the figures of a span as far as the ring still has it."""
        behind_s = self._session.status.time_s - from_s + 1.0
        samples = self._session.ring.last(round(behind_s / sample_time_s)).samples
        time = samples[:, INDEX["time"]]
        rows = samples[(samples[:, EPOCH] == epoch) & (time >= from_s) & (time <= to_s)][:, :WIDTH]
        figures = {metric.name: metric.compute(rows) for metric in METRICS} if len(rows) else {}
        return {name: value for name, value in figures.items() if math.isfinite(value)}

    def _tell(self) -> None:
        self._session.tell(self.message())
