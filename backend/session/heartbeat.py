"""Signs of life for the control process of a rig: of this process every 50 ms, of the operator at each renewal."""

import asyncio

from backend.session.operator_lease import OperatorLease
from backend.telemetry.beats import LEASE, LEASE_S, WEB, Beats

BEAT_S = 0.05


class Heartbeat:
    """Beats while a rig is connected; the control process stops the rig when either falls silent."""

    def __init__(self, lease: OperatorLease) -> None:
        self._lease = lease
        self._beats: Beats | None = None
        self._task: asyncio.Task[None] | None = None

    def begin(self) -> str:
        """Begin to beat, and return the name of the shared memory where the beats are counted."""
        if self._beats is None:
            self._beats = Beats()
            self._task = asyncio.create_task(self._run())
        return self._beats.name

    def beat_operator(self) -> None:
        """Count a sign of life of the operator."""
        if self._beats is not None:
            self._beats.beat(LEASE)

    def turn(self) -> None:
        """Count one of this process, and of an operator who may be silent for longer than a page."""
        if self._beats is None:
            return
        self._beats.beat(WEB)
        holder, left_s = self._lease.holder, self._lease.left_s
        # The last beat is one page's lease before the end: the control process lets as much silence pass.
        if holder is not None and holder.length_s > LEASE_S and left_s is not None and left_s > LEASE_S:
            self._beats.beat(LEASE)

    async def end(self) -> None:
        """Fall silent."""
        task, self._task = self._task, None
        if task is not None:
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)
        beats, self._beats = self._beats, None
        if beats is not None:
            beats.close()

    async def _run(self) -> None:
        while True:
            self.turn()
            await asyncio.sleep(BEAT_S)
