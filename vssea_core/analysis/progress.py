"""Long analyses: told how far they are, and stopped between two steps."""

from collections.abc import Callable

Progress = Callable[[float], bool]
"""Called with the share done [0, 1]; returns False to cancel."""


class Cancelled(Exception):
    """The caller's progress function asked to stop; nothing is returned."""


def unheard(share: float) -> bool:
    """Go on, whatever the `share`."""
    return True


def told(progress: Progress, share: float) -> None:
    """Tell `progress` the `share` done. Raises Cancelled if it returns False."""
    if not progress(min(share, 1.0)):
        raise Cancelled(f"cancelled after {100.0 * min(share, 1.0):.0f} %")
