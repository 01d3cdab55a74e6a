"""What is told of a plan: the estimate, and that no run can start."""

from typing import Any

TOLD = (
    "runs", "samples", "in_lanes", "seconds", "bytes", "paths", "columns", "first", "refused", "warning",
)  # fmt: skip
"""What an estimate tells; docs/protocol.md says what it means."""


def estimate_of(plan: dict[str, Any]) -> dict[str, Any]:
    """Return the estimate of a planned batch."""
    return {name: plan[name] for name in TOLD}


def why_refused(plan: dict[str, Any]) -> str | None:
    """Return why a planned batch cannot be started at all: every one of its runs would be refused; None if it can."""
    return f"no run of this batch can start; {plan['refused'][0]}" if plan["all_refused"] else None
