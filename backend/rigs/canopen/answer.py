"""One synchronous TPDO as it comes in: its newest content, its age in cycles, and which SYNC it answers."""

import struct
from collections.abc import Callable
from typing import Any

NEVER = 1_000_000
"""Age [cycles] of what has not come yet."""
MOST_OWED = 1000
PROBED_AFTER = 3
"""Cycles from a doubt to the cycle without SYNC that settles it."""
QUIET_CYCLES = 5
"""Cycles without SYNC and without an answer after which what is still owed was lost."""


class Answer:
    """A TPDO. Every SYNC asks for one; frames of one identifier come in order, so the newest answers the newest SYNC.

    After a cycle without an answer two may come: the first is the late one. Where only one comes, nothing in it says whether
    the other was lost or it is itself a cycle late. It is taken for this cycle's, and a cycle without SYNC is asked for: what
    comes in that one was late. Then SYNC stays away until all that is owed has come, and nothing is taken until an answer
    comes within its own cycle.
    """

    __slots__ = (
        "_came", "_lost", "_owed", "_probed_in", "_quiet", "_size", "_sound", "_unpack", "age", "can_id",
        "content", "is_late",
    )  # fmt: skip

    def __init__(self, can_id: int, form: str, sound: Callable[[tuple[int, ...]], bool] | None = None) -> None:
        layout = struct.Struct(form)
        self.can_id = can_id
        self.content: tuple[Any, ...] | None = None
        self.age = NEVER
        self.is_late = False
        """Whether answers were found to come in later cycles than their own."""
        self._unpack, self._size, self._sound = layout.unpack, layout.size, sound
        self._owed = 0  # asked for and not come
        self._lost = 0  # of these, taken for lost
        self._came = 0  # in this cycle
        self._probed_in = self._quiet = 0

    @property
    def is_expected(self) -> bool:
        """Whether another frame may come."""
        return self._owed > self._lost

    @property
    def wants_probe(self) -> bool:
        """Whether a cycle without SYNC is due."""
        return self._probed_in == 1

    @property
    def came_late(self) -> bool:
        """Whether an earlier cycle's frame came in this one."""
        return self._came > 1

    def begin(self, asked: bool) -> None:
        """Begin a cycle, with a SYNC sent or without."""
        self._came = 0
        if self._probed_in > 1:
            self._probed_in -= 1
        if asked and self._owed < MOST_OWED:
            self._owed += 1

    def take(self, data: bytearray) -> bool:
        """Take a frame over; return False where its length or content is impossible."""
        if self._owed:
            self._owed -= 1
            self._lost = min(self._lost, self._owed)
        if len(data) != self._size:
            return False
        content = self._unpack(data)
        if self._sound is not None and not self._sound(content):
            return False
        self.content = content
        self._came += 1
        return True

    def probe(self) -> bool:
        """Close a cycle without SYNC: return whether a late answer came."""
        came = self._came > 0
        self.age += 1
        self.is_late = self.is_late or came
        self._quiet = 0 if came else self._quiet + 1
        is_over = not self._owed or not self.is_late or self._quiet >= QUIET_CYCLES
        if is_over:
            self._owed = self._lost = self._quiet = 0
        self._probed_in = 0 if is_over else 1
        return came

    def settle(self) -> None:
        """Close a cycle with SYNC: the content is this cycle's where the age is 0 then."""
        self.age += 1
        if self._came and not self.is_expected:
            self.age, self.is_late = 0, False
        elif self._came:
            if not self._probed_in:
                self._probed_in = PROBED_AFTER
            if not self.is_late:
                self._lost, self.age = self._owed, 0
