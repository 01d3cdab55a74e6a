"""Entry of the writer process: takes what it is told from the pipe and what is new from the ring, five times a second."""

import signal
import time
from multiprocessing.connection import Connection
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from backend.recordings.writing import Writing

TURN_S = 0.2


def run_writer(
    ring_name: str,
    folder: str,
    part_s: float,
    keep_free: int,
    resumed: tuple[object, str | None, int, int],
    pipe: Connection,
) -> None:
    """Record until `pipe` closes, then finish what is open."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl+C is the web process's to handle
    from backend.recordings.messages import Begin
    from backend.recordings.room import Room
    from backend.recordings.syncing import Syncing
    from backend.recordings.writing import Writing
    from backend.telemetry.ring import RingReader

    def tell(answer: object) -> None:
        try:
            pipe.send(answer)
        except OSError:
            return  # the web process has left: what is open is finished all the same

    Path(folder).mkdir(parents=True, exist_ok=True)
    sync = Syncing()
    writing = Writing(RingReader(ring_name), Path(folder), part_s, Room(Path(folder), keep_free), tell, sync)
    run, path, sample, item = resumed
    writing.resume(run if isinstance(run, Begin) else None, Path(path) if path else None, sample, item)
    due = time.monotonic()
    while _received(pipe, writing, due):
        writing.turn(time.monotonic())
        due = max(due + TURN_S, time.monotonic())
    writing.turn(time.monotonic())
    writing.end("the server ended")
    sync.finish()


def _received(pipe: Connection, writing: "Writing", due: float) -> bool:
    """Take what comes until `due`; return False once the pipe is closed."""
    try:
        while pipe.poll(max(0.0, due - time.monotonic())):
            writing.take(pipe.recv())
            if time.monotonic() > due:
                break
    except (EOFError, OSError):
        return False
    return True
