"""Which commands the journal hears of: all but signs of life, and of a jog only its begin, its end and a refusal."""

import time
from collections.abc import Callable
from typing import Any

JOG_GAP_S = 0.5
"""A jog that is renewed after a longer silence is another one."""
SIGNS_OF_LIFE = frozenset({"renew_control"})


class CommandAudit:
    """Remembers who jogs; the clock is injected."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._jogs: dict[str, tuple[float, bool, str | None]] = {}

    def is_news(self, name: str, arguments: Any, by: str, problem: str | None) -> bool:
        """Return whether a command says more than the one before it did."""
        if name in SIGNS_OF_LIFE:
            return False
        return name != "jog" or self._is_new_jog(arguments, by, problem)

    def _is_new_jog(self, arguments: Any, by: str, problem: str | None) -> bool:
        moving = isinstance(arguments, dict) and any(arguments.values())
        now = self._clock()
        before = self._jogs.get(by)
        self._jogs[by] = now, moving, problem
        if before is None or now - before[0] > JOG_GAP_S:
            return moving or problem is not None
        return before[1:] != (moving, problem)
