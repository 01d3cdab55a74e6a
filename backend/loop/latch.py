"""Faults that latch: numbered, with the time they came; only a reset takes them back, and not while their cause stands."""

from backend.loop.messages import LatchedFault
from backend.rigs.faults import BUS_OFF, CONFIGURATION, NO_BUS, REBOOTED, WRONG_DEVICE, Fault

GONE_AFTER_S = 0.3
"""A cause that has not been seen for this long [s] is gone."""
UNTIL_RECONNECTED = frozenset(fault.number for fault in (REBOOTED, BUS_OFF, WRONG_DEVICE, CONFIGURATION, NO_BUS))
"""Causes that only another connection takes away."""


class Latch:
    """The faults that have come since the last reset, the first one first."""

    def __init__(self) -> None:
        self._entries: dict[int, tuple[Fault, str, float]] = {}
        self._seen_s: dict[int, float] = {}

    def __len__(self) -> int:
        return len(self._entries)

    def __contains__(self, fault: Fault) -> bool:
        return fault.number in self._entries

    def note(self, fault: Fault, detail: str, at_s: float, now: float) -> bool:
        """Latch `fault` at session time `at_s`, seen at `now` [s]; return whether it is a new one."""
        self._seen_s[fault.number] = now
        if fault.number in self._entries:
            return False
        self._entries[fault.number] = (fault, detail, at_s)
        return True

    def stands(self, number: int, now: float) -> bool:
        """Return whether the cause of a latched fault is still there."""
        return number in UNTIL_RECONNECTED or now - self._seen_s[number] < GONE_AFTER_S

    def standing(self, now: float) -> str | None:
        """Return the sentence of the first fault whose cause stands, or None."""
        for number, (fault, detail, _) in self._entries.items():
            if self.stands(number, now):
                return fault.sentence(detail)
        return None

    @property
    def first(self) -> str:
        """Sentence of the fault that came first; there must be one."""
        fault, detail, _ = next(iter(self._entries.values()))
        return fault.sentence(detail)

    def reports(self, now: float) -> tuple[LatchedFault, ...]:
        """Return all of them as the page shows them."""
        return tuple(
            LatchedFault(number, fault.name, fault.sentence(detail), at_s, self.stands(number, now))
            for number, (fault, detail, at_s) in self._entries.items()
        )

    def clear(self) -> None:
        """Forget all."""
        self._entries.clear()
        self._seen_s.clear()
