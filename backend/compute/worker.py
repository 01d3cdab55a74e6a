"""Entry of a worker process: jobs in, answers out, one at a time, over one pipe.

A jobs module is plain functions and a set LONG of names. A job of LONG takes a `progress` as its last argument: it tells how
far it is, and ends the job if anything came down the pipe, since nothing but the wish to end it comes while a job runs.
"""

import importlib
import signal
import time
import traceback
from multiprocessing.connection import Connection
from typing import Literal

from backend.processes import set_niceness

Outcome = tuple[Literal["ready", "progress", "done", "refused", "cancelled", "failed"], object]
TELL_EVERY_S = 0.1


class Cancelled(BaseException):
    """The job is no longer wanted; passes whatever a job may catch."""


class Progress:
    """Tells how far a long job is, ten times a second at most. Called with a share from 0 to 1 and words."""

    def __init__(self, pipe: Connection) -> None:
        self._pipe, self._told = pipe, 0.0

    def __call__(self, share: float, words: str = "") -> bool:
        """Tell, and return True: go on. Raises Cancelled if the job is no longer wanted."""
        if self._pipe.poll():
            self._pipe.recv()
            raise Cancelled
        now = time.monotonic()
        if share >= 1.0 or now - self._told >= TELL_EVERY_S:
            self._told = now
            self._pipe.send(("progress", (share, words)))
        return True


def run_worker(pipe: Connection, niceness: int, first_job: str, jobs_module: str) -> None:
    """Answer jobs (name, arguments) of a module until the pipe closes; compile what `first_job` needs before the first."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    set_niceness(niceness)  # sums give way to the control loop and to STOP
    jobs = importlib.import_module(jobs_module)
    if first_job:
        from backend.compute.warm import warm_up  # brings in the compiler

        warm_up(first_job)
    pipe.send(("ready", None))
    while True:
        try:
            asked = pipe.recv()
        except (EOFError, OSError):
            return
        if asked is None:
            continue  # the end of a job that had ended by itself
        name, arguments = asked
        heard = (Progress(pipe),) if name in jobs.LONG else ()
        pipe.send(_outcome(getattr(jobs, name, None), (*arguments, *heard)))


def _outcome(job: object, arguments: tuple[object, ...]) -> Outcome:
    try:
        return "done", job(*arguments)  # type: ignore[operator]
    except Cancelled:
        return "cancelled", None
    except ValueError as refusal:
        return "refused", str(refusal)
    except Exception:  # noqa: BLE001 - a worker outlives any job, and the web process logs what went wrong
        return "failed", traceback.format_exc()
