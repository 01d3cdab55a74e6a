"""Whether a command may still take effect: who gave it can lose control while it waits for its turn or for a design."""

from collections.abc import Callable

Permission = Callable[[], None]
"""Raises Problem once its command may no longer take effect."""


def granted() -> None:
    """Permit whatever the session does by itself."""
