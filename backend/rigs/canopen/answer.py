"""One synchronous TPDO as it comes in: its newest content, its age in cycles, and which SYNC it answers."""

import struct
from collections.abc import Callable
from typing import Any

NEVER = 1_000_000
"""Age [cycles] of what has not come yet."""
MOST_OWED = 4
PROBED_AFTER = 3
"""Cycles from a doubt to the cycle without SYNC that settles it."""


class Answer:
    """A TPDO. Every SYNC asks for one; frames of one identifier come in order, so the newest answers the newest SYNC.

    After a cycle without an answer two may come: the first is the late one. Where only one comes, nothing in it says whether
    the other was lost or it is itself a cycle late. It is taken for this cycle's, and a cycle without SYNC is asked for: what
    comes in that one was late, and from then on nothing is taken until an answer comes within its own cycle.
    """

    __slots__ = ("_came", "_probed_in", "_size", "_sound", "_unpack", "age", "can_id", "content", "is_late", "owed")

    def __init__(self, can_id: int, form: str, sound: Callable[[tuple[int, ...]], bool] | None = None) -> None:
        layout = struct.Struct(form)
        self.can_id = can_id
        self.content: tuple[Any, ...] | None = None
        self.age = NEVER
        self.owed = 0
        self.is_late = False
        """Whether answers were found to come in later cycles than their own."""
        self._unpack, self._size, self._sound = layout.unpack, layout.size, sound
        self._came = 0
        self._probed_in = 0

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
        if asked and self.owed < MOST_OWED:
            self.owed += 1

    def take(self, data: bytearray) -> bool:
        """Take a frame over; return False where its length or content is impossible."""
        if self.owed:
            self.owed -= 1
        if len(data) != self._size:
            return False
        content = self._unpack(data)
        if self._sound is not None and not self._sound(content):
            return False
        self.content = content
        self._came += 1
        return True

    def probe(self) -> bool:
        """Close a cycle without SYNC: return whether a late answer came; none is on its way any more."""
        self.is_late = self.is_late or self._came > 0
        self.owed = self._probed_in = 0
        self.age += 1
        return self._came > 0

    def settle(self) -> bool:
        """Close a cycle with SYNC: return whether the content is this cycle's."""
        if self._came:
            if not self.owed:
                self.age, self.is_late = 0, False
                return True
            if not self._probed_in:
                self._probed_in = PROBED_AFTER
            if not self.is_late:
                self.owed = self.age = 0
                return True
        self.age += 1
        return False
