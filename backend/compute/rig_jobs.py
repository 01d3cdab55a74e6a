"""A look at a rig, in a process of its own: it opens the bus, reads, changes nothing, and closes it."""

from typing import Any

from backend.rigs.check import check_rig
from backend.rigs.rig_file import RigFile

LONG: frozenset[str] = frozenset()
"""No job tells its progress; see compute.worker."""


def check(rig: RigFile, gear_ratio: float) -> list[dict[str, Any]]:
    """Return what was found beside what the file expects, line by line; see rigs.check."""
    return [dict(line) for line in check_rig(rig, gear_ratio)]
