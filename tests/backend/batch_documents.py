"""Batch documents for tests, and a client that waits for their end."""

from typing import Any

import httpx

from tests.backend.server import until

BATCHES = "/api/batches"
PATIENCE_S = 240.0  # kernels may have to be compiled first
ENDED = ("done", "cancelled", "failed")
SHORT = {"name": "short", "duration_s": 0.2}


def grid(path: str, low: float, high: float, count: int, **more: Any) -> dict[str, Any]:
    return {"kind": "grid", "path": path, "low": low, "high": high, "count": count, **more}


def batch(*vary: dict[str, Any], **more: Any) -> dict[str, Any]:
    return {"scenario": SHORT, "vary": list(vary), **more}


def created(http: httpx.Client, document: dict[str, Any], key: str | None = None) -> dict[str, Any]:
    answer = http.post(BATCHES, json=document, headers={} if key is None else {"Idempotency-Key": key})
    assert answer.status_code == 201, answer.text
    found: dict[str, Any] = answer.json()
    assert answer.headers["Location"] == f"{BATCHES}/{found['id']}"
    return found


def one(http: httpx.Client, name: str) -> dict[str, Any]:
    answer = http.get(f"{BATCHES}/{name}")
    assert answer.status_code == 200, answer.text
    return dict(answer.json())


def ended(http: httpx.Client, name: str) -> dict[str, Any]:
    until(lambda: one(http, name)["state"] in ENDED, PATIENCE_S)
    return one(http, name)


def done(http: httpx.Client, document: dict[str, Any]) -> dict[str, Any]:
    found = ended(http, created(http, document)["id"])
    assert found["state"] == "done", found
    return found
