"""The control process's end of the pipe: commands out of it, reports into it, and whether the other end still listens."""

from collections.abc import Iterator
from multiprocessing.connection import Connection

from backend.loop.messages import Command, Report


class PipeEnd:
    """Drains commands at the start of a turn and sends reports at its end."""

    def __init__(self, pipe: Connection) -> None:
        self._pipe = pipe
        self._reports: list[Report] = []
        self.lost = False

    def commands(self) -> Iterator[tuple[int, Command]]:
        """Yield what has arrived, with its number; `lost` is set if the other end is closed."""
        try:
            while self._pipe.poll():
                yield self._pipe.recv()
        except (EOFError, OSError):
            self.lost = True

    def report(self, report: Report) -> None:
        """Keep a report until `send`."""
        self._reports.append(report)

    def send(self) -> None:
        """Send what this turn reported, after its samples: who reads of a change finds it in the ring."""
        try:
            for report in self._reports:
                self._pipe.send(report)
        except OSError:
            self.lost = True
        self._reports.clear()
