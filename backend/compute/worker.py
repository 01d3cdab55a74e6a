"""Entry of a worker process: jobs in, answers out, one at a time, over one pipe."""

import signal
import traceback
from multiprocessing.connection import Connection
from typing import Literal

from backend.processes import set_niceness

Outcome = tuple[Literal["ready", "done", "refused", "failed"], object]


def run_worker(pipe: Connection, niceness: int) -> None:
    """Answer jobs (name, arguments) until the pipe closes; compile the kernels before the first."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    set_niceness(niceness)  # sums give way to the control loop and to STOP
    from backend.compute import jobs
    from backend.compute.warm import warm_up

    warm_up()
    pipe.send(("ready", None))
    while True:
        try:
            name, arguments = pipe.recv()
        except (EOFError, OSError):
            return
        pipe.send(_outcome(getattr(jobs, name), arguments))


def _outcome(job: object, arguments: tuple[object, ...]) -> Outcome:
    try:
        return "done", job(*arguments)  # type: ignore[operator]
    except ValueError as refusal:
        return "refused", str(refusal)
    except Exception:  # noqa: BLE001 - a worker outlives any job, and the web process logs what went wrong
        return "failed", traceback.format_exc()
