"""From a document to a batch that may wait for its turn, or why it may not."""

import secrets
from datetime import datetime
from typing import Any

from backend.batch.asked import Asked
from backend.batch.catalogue import Row
from backend.batch.engine import Engine, OutOfReach
from backend.batch.estimate import estimate_of, why_refused
from backend.batch.limits import Limits
from backend.batch.times import Times, text_of
from backend.compute.pool import JobFailedError, JobRefusedError, Jobs
from backend.problem import Problem, refused
from vssea_core.field_errors import FieldError

PLAN_LIMIT_S = 120.0
Document = dict[str, Any]


class Admission:
    """Checks batches against what the settings allow; `plans` is the worker that plans them."""

    def __init__(self, limits: Limits, engine: Engine, plans: Jobs, times: Times) -> None:
        self._limits, self._engine, self._plans, self._times = limits, engine, plans, times

    async def read(self, body: bytes) -> Asked:
        """Return the batch in the body of a request. Raises Problem if there is none."""
        found: Asked = await self._answer("read_batch", body)
        return found

    async def estimate(self, asked: Asked) -> Document:
        """Return what a batch would take. Raises Problem if it makes no sense or is too large."""
        self._limits.check_runs(asked.runs)
        plan = await self._planned(asked)
        return estimate_of(plan) | {"limits": self._beyond(plan)}

    def _beyond(self, plan: Document) -> list[str]:
        """Return the sentences that a start would be refused with."""
        try:
            self._limits.check_bytes(plan["bytes"])
        except Problem as beyond:
            return [beyond.detail]
        return []

    async def row(self, asked: Asked, key: str | None) -> Row:
        """Return a batch that may wait for its turn. Raises Problem if it may not."""
        self._limits.check_runs(asked.runs)
        plan = await self._planned(asked)
        if why := why_refused(plan):
            raise _refused(why)
        self._limits.check_bytes(plan["bytes"])
        now = self._times.now()
        facts = {
            "description": asked.description, "paths": plan["paths"], "columns": plan["columns"],
            "trajectories": asked.trajectories, "engine": self._engine.name,
        }  # fmt: skip
        return Row(
            _new_id(now), asked.name, key, asked.digest, "queued", text_of(now), plan["runs"], plan["part_size"], facts
        )

    async def _planned(self, asked: Asked) -> Document:
        try:
            await self._engine.connect()
        except OutOfReach as away:
            raise _not_planned(away) from away
        plan: Document = await self._answer("plan_asked", asked.document, self._engine.threads)
        return plan

    async def _answer(self, job: str, *arguments: Any) -> Any:
        try:
            answer = await self._plans.run(job, *arguments, time_limit_s=PLAN_LIMIT_S)
        except JobRefusedError as refusal:
            raise _refused(str(refusal)) from refusal
        except JobFailedError as failure:
            raise _not_planned(failure) from failure
        if isinstance(answer, Problem):
            raise answer
        return answer


def _not_planned(failure: Exception) -> Problem:
    return Problem(503, "Not planned", f"The batch could not be planned: {str(failure).rstrip('.')}.")


def _refused(sentence: str) -> Problem:
    return refused(f"{sentence[:1].upper()}{sentence[1:]}.", FieldError("vary", None, sentence))


def same(found: Row, digest: str) -> Row:
    """Return the batch that a key belongs to. Raises Problem if it was asked for with another document."""
    if found.digest != digest:
        expected = "expected a new key for another document"
        raise refused(
            f"The Idempotency-Key {found.key!r} belongs to the batch {found.id}, whose document is another one; {expected}.",
            FieldError("Idempotency-Key", found.key, expected),
        )
    return found


def _new_id(now: datetime) -> str:  # sweep.ID tells such a name from others
    return f"{now:%Y%m%d-%H%M%S}-{now.microsecond // 1000:03d}-{secrets.token_hex(3)}"
