"""One recording as a list shows it, and whether a search finds it."""

from datetime import UTC, datetime
from typing import Any

from backend.recordings.catalogue import Row
from backend.recordings.folder import Found
from backend.recordings.messages import Wrote


def listed(
    found: Found, row: Row, summary: dict[str, Any] | None, head: dict[str, str], progress: Wrote | None
) -> dict[str, Any]:
    """Return the entry of docs/protocol.md; what is not computed yet is null. `head` serves while there is no summary."""
    said = {
        "name": head.get("name"), "scenario": head.get("scenario"), "started_at": head.get("begun_at"),
        "origin": head.get("origin"),
    }  # fmt: skip
    facts = said | (summary or {}).get("facts", {})
    state = (
        "recording" if progress is not None else facts.get("state", "complete" if found.is_finished else "recovered")
    )
    return {
        "id": found.id,
        "name": row.name or facts["name"] or facts["scenario"] or "",
        "scenario": facts["scenario"] or "",
        "started_at": facts["started_at"] or _begun(found),
        "duration_s": facts.get("duration_s") if progress is None else _so_far(progress, head),
        "samples": progress.samples if progress is not None else facts.get("samples"),
        "lost": progress.lost if progress is not None else facts.get("lost"),
        "size_bytes": found.size,
        "state": state,
        "origin": facts["origin"] or "live",
        "starred": row.starred,
        "note": row.note,
        "tags": list(row.tags),
        "revision": row.revision,
        "events": facts.get("events"),
        "faults": facts.get("faults"),
        "summary": None if summary is None else {"metrics": summary["metrics"], "picture": summary["picture"]},
    }


def matches(entry: dict[str, Any], search: str, starred: bool | None, origin: str | None) -> bool:
    """Return whether an entry has every word of a search, in its name, scenario, note, tags or id."""
    if starred is not None and entry["starred"] != starred:
        return False
    if origin is not None and entry["origin"] != origin:
        return False
    text = " ".join([entry["name"], entry["scenario"], entry["note"], entry["id"], *entry["tags"]]).casefold()
    return all(word in text for word in search.casefold().split())


def _so_far(progress: Wrote, head: dict[str, str]) -> float:
    return progress.samples * float(head.get("sample_time_s", 0.0))


def _begun(found: Found) -> str:
    return datetime.fromtimestamp(found.modified_s, UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")
