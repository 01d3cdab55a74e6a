"""The cable between host and nodes, and what can go wrong on it: frames lost, late, corrupted, or none at all."""

import random
from collections import deque
from collections.abc import Callable

Frame = tuple[int, bytes]
Deliver = Callable[[int, bytes], None]


class Wire:
    """Passes frames on both ways; what it does to them is reproducible."""

    def __init__(self, to_host: Deliver, to_nodes: Deliver) -> None:
        self._to_host, self._to_nodes = to_host, to_nodes
        self._late: deque[tuple[float, int, bytes]] = deque()
        self.mend()

    def mend(self) -> None:
        """Take back what went wrong."""
        self.dropped = self.corrupted = self.delay_s = 0.0
        self.cut = False
        self._chance = random.Random(1)

    def out(self, can_id: int, data: bytes, now: float) -> None:
        """Take a frame of a node to the host."""
        frame = self._spoiled(can_id, data)
        if frame is None:
            return
        if self.delay_s > 0.0 or self._late:
            self._late.append((now + self.delay_s, *frame))
        else:
            self._to_host(*frame)

    def into(self, can_id: int, data: bytes) -> None:
        """Take a frame of the host to the nodes."""
        frame = self._spoiled(can_id, data)
        if frame is not None:
            self._to_nodes(*frame)

    def turn(self, now: float) -> None:
        """Deliver what is late."""
        while self._late and self._late[0][0] <= now:
            _, can_id, data = self._late.popleft()
            if not self.cut:
                self._to_host(can_id, data)

    def due(self) -> float | None:
        """Return when the next late frame is to be delivered."""
        return self._late[0][0] if self._late else None

    def _spoiled(self, can_id: int, data: bytes) -> Frame | None:
        if self.cut or (self.dropped and self._chance.random() < self.dropped):
            return None
        if self.corrupted and data and self._chance.random() < self.corrupted:
            if self._chance.random() < 0.5:
                return can_id, data[: self._chance.randrange(len(data))]
            spoiled = bytearray(data)
            spoiled[self._chance.randrange(len(spoiled))] ^= 1 << self._chance.randrange(8)
            return can_id, bytes(spoiled)
        return can_id, data
