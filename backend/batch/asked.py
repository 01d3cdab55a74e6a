"""A batch as it was asked for: its whole document, and what the web process has to know of it."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Asked:
    """What a planning worker reads of a body; `document` is always written the same way, and `digest` tells it from others."""

    document: str
    digest: str
    name: str
    description: str
    trajectories: str
    runs: int
