"""What pages are told of batches: every change of state, and how far one is, twice a second at most."""

from collections.abc import Callable
from typing import Any

EVERY_S = 0.5
Tell = Callable[[dict[str, Any]], None]


class News:
    """Tells one listener."""

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock, self._told_s = clock, float("-inf")
        self._tell: Tell = lambda _: None

    def hear(self, tell: Tell) -> None:
        """Name the listener."""
        self._tell = tell

    def tell(self, batch: str, state: str, share: float) -> None:
        """Tell a new state."""
        self._told_s = self._clock()
        self._tell({"type": "batches", "id": batch, "state": state, "share": share})

    def progress(self, batch: str, share: float) -> None:
        """Tell how far a batch is that runs, unless something was told just now."""
        if self._clock() - self._told_s >= EVERY_S:
            self.tell(batch, "running", share)
