"""One synchronous TPDO as it comes in: its newest content, its age in cycles, and which SYNC it answers."""

import struct
from collections.abc import Callable
from typing import Any

NEVER = 1_000_000
"""Age [cycles] of what has not come yet."""
MOST_OWED = 4


class Answer:
    """A TPDO. Every SYNC asks for one; frames of one identifier come in order, so the newest answers the newest SYNC.

    After a cycle without an answer two may come: the first is the late one, and is not taken for this cycle's. Where only
    one comes it is this cycle's if it is about as quick as usual (the other was lost), else the late one still.
    """

    __slots__ = ("_at_s", "_came", "_size", "_sound", "_unpack", "age", "can_id", "content", "owed")

    def __init__(self, can_id: int, form: str, sound: Callable[[tuple[int, ...]], bool] | None = None) -> None:
        layout = struct.Struct(form)
        self.can_id = can_id
        self.content: tuple[Any, ...] | None = None
        self.age = NEVER
        self.owed = 0
        self._unpack, self._size, self._sound = layout.unpack, layout.size, sound
        self._came = 0
        self._at_s = 0.0

    def begin(self, asked: bool) -> None:
        """Begin a cycle, with a SYNC sent or without."""
        self._came = 0
        if asked and self.owed < MOST_OWED:
            self.owed += 1

    def take(self, data: bytearray, at_s: float) -> bool:
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
        self._at_s = at_s
        return True

    @property
    def was_late(self) -> bool:
        """Whether an earlier cycle's frame came in this one."""
        return self._came > 1

    def settle(self, usual_s: float) -> bool:
        """Close the cycle: return whether the content is this cycle's; `usual_s` is when a usual answer is there by."""
        if self._came and (not self.owed or self._at_s <= usual_s):
            self.owed = 0
            self.age = 0
            return True
        self.age += 1
        return False
