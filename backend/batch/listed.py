"""A batch as REST gives it."""

from typing import Any

from backend.batch.catalogue import ACTIVE, Row
from backend.batch.progress import STATES, RunCounts

STOPPED = {"cancelled": "was cancelled", "failed": "failed"}


def listed(row: Row, progress: RunCounts | None = None, waiting_for: str = "") -> dict[str, Any]:
    """Return the document of docs/protocol.md; `progress` and what it waits for are those of a batch that runs."""
    found = row.summary
    return {
        "id": row.id, "name": row.name, "description": found["description"], "state": row.state, "reason": row.reason,
        "waiting_for": waiting_for,
        "created_at": row.created_at, "started_at": row.started_at, "ended_at": row.ended_at, "seconds": row.seconds,
        "engine": found["engine"], "runs": row.runs, "parts": row.parts, "part_size": row.part_size,
        "paths": found["paths"], "columns": found["columns"], "trajectories": found["trajectories"],
        **(_kept(row) if progress is None else progress.document()),
    }  # fmt: skip


def _kept(row: Row) -> dict[str, Any]:
    """Return what RunCounts.document does, of a batch that does not run."""
    counts = row.summary.get("counts", dict.fromkeys(STATES, 0))
    done = sum(counts.values())
    return {
        "progress": {
            "done": done, "runs": row.runs, "parts_done": row.summary.get("parts_done", 0), "parts": row.parts,
            "share": done / row.runs,
        },
        "counts": counts, "rate": row.summary.get("rate"), "seconds_left": None,
    }  # fmt: skip


def whole_parts(row: Row) -> int:
    """Return how many parts there have to be: all of a batch that is done."""
    return row.parts if row.state == "done" else 0


def why_none(row: Row, what: str) -> str:
    """Return why there are no `what`, "results" or "trajectories", in one sentence without its stop."""
    if row.state in ACTIVE:
        return f"there are no {what} yet; wait for the first part that has any"
    if row.state != "done":
        which = "that kept any samples" if what == "trajectories" else "was kept"
        return f"this batch {STOPPED[row.state]} before a part {which}; resume it, and it goes on"
    which = "ended early" if row.summary["trajectories"] == "ended" else "could start"
    return f"no run of this batch {which}, so no samples were kept"
