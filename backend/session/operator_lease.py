"""Who may move a rig: one lease, held by a key and renewed while its holder lives. Pure: the clock is injected."""

import time
from collections.abc import Callable
from dataclasses import dataclass

from backend.problem import Problem
from backend.telemetry.beats import LEASE_S

LONGEST_LEASE_S = 5.0
"""A caller without a websocket may ask for as much."""


@dataclass(frozen=True)
class Party:
    """Who holds the lease, or asks for it: `key` proves it, `name` is for people."""

    key: str
    name: str
    length_s: float = LEASE_S


class OperatorLease:
    """At most one holder; what is neither renewed nor released ends by itself."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._holder: Party | None = None
        self._renewed_at = 0.0
        self._asking: dict[str, Party] = {}

    @property
    def holder(self) -> Party | None:
        """Who is in control, None if nobody is (any more)."""
        return self._holder if self.left_s is not None else None

    @property
    def left_s(self) -> float | None:
        """Time until the lease ends unless it is renewed, None if nobody holds it."""
        if self._holder is None:
            return None
        left = self._renewed_at + self._holder.length_s - self._clock()
        return left if left > 0.0 else None

    @property
    def asking(self) -> list[Party]:
        """Who would like to have it, in the order in which they asked."""
        return list(self._asking.values())

    def holds(self, key: str | None) -> bool:
        """Return whether a key is that of who is in control."""
        holder = self.holder
        return holder is not None and key == holder.key

    def check(self, key: str | None) -> None:
        """Raise Problem 403, with who is in control, unless a key is that of the holder."""
        if not self.holds(key):
            raise self._refusal()

    def take(self, party: Party) -> None:
        """Give a free lease to a party, or renew its own. Raises Problem 403 if another one holds it."""
        if self.holder is not None and not self.holds(party.key):
            raise self._refusal()
        self._give(party)

    def renew(self, key: str | None) -> None:
        """Begin its time anew. Raises Problem 403 if it ended or is another's."""
        self.check(key)
        self._renewed_at = self._clock()

    def release(self, key: str | None) -> None:
        """End it. Raises Problem 403 if it is another's."""
        self.check(key)
        self._holder = None

    def ask(self, party: Party) -> Party:
        """Note that a party would like to have it, and return who holds it. Raises Problem 409 if nobody else does."""
        holder = self.holder
        if holder is None or holder.key == party.key:
            how = "Nobody is in control: take it." if holder is None else "You are in control already."
            raise Problem(409, "Nothing to ask for", how)
        self._asking[party.key] = party
        return holder

    def hand(self, key: str | None, to: Party) -> None:
        """Give it to another party. Raises Problem 403 if it is not the holder who does."""
        self.check(key)
        self._give(to)

    def leave(self, key: str) -> bool:
        """Forget a party that is gone; return whether it was in control."""
        held = self.holds(key)
        self._asking.pop(key, None)
        if held:
            self._holder = None
        return held

    def end(self) -> None:
        """Let nobody hold it or ask for it: there is nothing to be in control of."""
        self._holder = None
        self._asking.clear()

    def expired(self) -> Party | None:
        """Return who has lost it by silence since the last call, None if nobody has."""
        if self._holder is None or self.left_s is not None:
            return None
        silent, self._holder = self._holder, None
        return silent

    def _give(self, party: Party) -> None:
        self._holder, self._renewed_at = party, self._clock()
        self._asking.pop(party.key, None)

    def _refusal(self) -> Problem:
        holder = self.holder
        if holder is None:
            return Problem(403, "Not in control", "Nobody is in control of the rig: take control first.",
                           members={"operator": None})  # fmt: skip
        sentence = f"{holder.name} is in control of the rig: ask for control, or wait until it is given up."
        return Problem(403, "Not in control", sentence, members={"operator": holder.name})
