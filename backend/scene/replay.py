"""The scene of a recording: a second scene process, started at its first use, that shows whatever sample it is given."""

from collections.abc import Callable
from multiprocessing.connection import Connection

import numpy as np

from backend.scene.process import SceneProcess, run_scene
from backend.telemetry.ring import WIDTH, Ring, RingWriter

UNUSED = "The scene of a recording appears here when one is opened."


class ReplayScene:
    """Holds a ring of its own, with the sample to be shown as its newest; `target` is the entry of the process."""

    def __init__(self, target: Callable[[str, Connection], None] = run_scene) -> None:
        self._target = target
        self._ring: Ring | None = None
        self._writer: RingWriter | None = None
        self._process: SceneProcess | None = None

    @property
    def port(self) -> int | None:
        """Port of the scene on 127.0.0.1; None while there is none."""
        return self._process.port if self._process is not None else None

    @property
    def sentence(self) -> str:
        """What the scene is doing, for the place where it would be seen."""
        return self._process.sentence if self._process is not None else UNUSED

    def show(self, row: list[float]) -> None:
        """Show a sample, in the order of channels.CHANNELS; call it with an event loop running."""
        if self._writer is None:
            self._ring = Ring()
            self._writer = RingWriter(self._ring.name)
            self._process = SceneProcess(self._ring.name, self._target)
            self._process.start()
        _, room = self._writer.room(1)
        room[0, :WIDTH] = np.nan_to_num(row)  # an import may lack what the scene draws
        self._writer.announce(1)

    async def stop(self) -> None:
        """End the process and remove the ring."""
        if self._process is not None:
            await self._process.stop()
        if self._writer is not None:
            self._writer.close()
        if self._ring is not None:
            self._ring.close()
