"""From a document to a batch that may wait for its turn, or why it may not."""

import hashlib
import secrets
from datetime import datetime
from typing import Any

from backend.batch.catalogue import Row
from backend.batch.engine import Engine, OutOfReach
from backend.batch.limits import Limits
from backend.batch.times import Times, text_of
from backend.compute.pool import JobFailedError, JobRefusedError, Jobs
from backend.problem import Problem, refused
from vssea_core.batch.document import Batch
from vssea_core.field_errors import FieldError

PLAN_LIMIT_S = 120.0
Document = dict[str, Any]


class Admission:
    """Checks batches against what the settings allow; `plans` is the worker that plans them."""

    def __init__(self, limits: Limits, engine: Engine, plans: Jobs, times: Times) -> None:
        self._limits, self._engine, self._plans, self._times = limits, engine, plans, times

    async def estimate(self, batch: Batch) -> Document:
        """Return what a batch would take. Raises Problem if it makes no sense or is too large."""
        self._limits.check_runs(batch)
        return await self._planned(batch)

    async def row(self, batch: Batch, digest: str, key: str | None) -> Row:
        """Return a batch that may wait for its turn. Raises Problem if it may not."""
        self._limits.check_runs(batch)
        plan = await self._planned(batch)
        if plan["all_refused"]:
            reason = plan["refused"][0]
            raise refused(f"No run of this batch can start. {reason}.", FieldError("vary", None, reason))
        self._limits.check_bytes(plan["bytes"])
        now = self._times.now()
        facts = {
            "description": batch.description, "paths": plan["paths"], "columns": plan["columns"],
            "trajectories": batch.keep.trajectories, "engine": self._engine.name,
        }  # fmt: skip
        return Row(
            _new_id(now), batch.name, key, digest, "queued", text_of(now), plan["runs"], plan["part_size"], facts
        )

    async def _planned(self, batch: Batch) -> Document:
        try:
            await self._engine.connect()
            plan: Document = await self._plans.run(
                "plan_batch", batch.model_dump_json(), self._engine.threads, time_limit_s=PLAN_LIMIT_S
            )
        except JobRefusedError as refusal:
            sentence = str(refusal)
            raise refused(f"{sentence[:1].upper()}{sentence[1:]}.", FieldError("vary", None, sentence)) from refusal
        except (JobFailedError, OutOfReach) as failure:
            raise Problem(503, "Not planned", f"The batch could not be planned: {failure}.") from failure
        return plan


def digest_of(document: str) -> str:
    """Return what tells a document from another one."""
    return hashlib.sha256(document.encode()).hexdigest()


def same(found: Row, digest: str) -> Row:
    """Return the batch that a key belongs to. Raises Problem if it was asked for with another document."""
    if found.digest != digest:
        expected = "expected a new key for another document"
        raise refused(
            f"The Idempotency-Key {found.key!r} belongs to the batch {found.id}, whose document is another one; {expected}.",
            FieldError("Idempotency-Key", found.key, expected),
        )
    return found


def _new_id(now: datetime) -> str:
    return f"{now:%Y%m%d-%H%M%S}-{now.microsecond // 1000:03d}-{secrets.token_hex(3)}"
