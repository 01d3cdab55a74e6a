"""A core for the control process alone: while a rig is under torque, the workers stay off one core. Linux only."""

import os
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path

Cores = frozenset[int]


class SpareCore:
    """Keeps one core free of the workers, and gives it back; the setter is injected."""

    def __init__(
        self,
        workers: Callable[[], list[int]],
        bind: "Callable[[int, Cores], None] | None" = None,
        cores: Cores | None = None,
    ) -> None:
        self._workers, self._bind = workers, bind or bind_process
        self._cores = own_cores() if cores is None else cores
        self._bound: set[int] = set()

    @property
    def core(self) -> int | None:
        """The core that is kept free now, None if none is."""
        return max(self._cores) if self._bound else None

    def keep(self) -> None:
        """Keep a core free, also of workers that have started since; a machine with one core has none to spare."""
        if len(self._cores) < 2:
            return
        alive = set(self._workers())
        self._bound &= alive
        for pid in alive - self._bound:
            with suppress(OSError):
                self._bind(pid, self._cores - {max(self._cores)})
                self._bound.add(pid)

    def give_back(self) -> None:
        """Let the workers use every core again."""
        for pid in self._bound & set(self._workers()):
            with suppress(OSError):
                self._bind(pid, self._cores)
        self._bound.clear()


def own_cores() -> Cores:
    """Return the cores that this process may use, none where the system does not say."""
    try:
        return frozenset(os.sched_getaffinity(0))
    except (AttributeError, OSError):
        return frozenset()


def bind_process(pid: int, cores: Iterable[int]) -> None:
    """Let a process with all its threads run on some cores only. Raises OSError."""
    for thread in Path(f"/proc/{pid}/task").iterdir():
        with suppress(ProcessLookupError):  # a thread that has just ended
            os.sched_setaffinity(int(thread.name), cores)
