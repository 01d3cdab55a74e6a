"""How far a batch is, how fast, and how long it will take: a bar on a terminal, elsewhere a line now and then."""

import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import timedelta

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn

from backend.batch.progress import RunCounts

LINE_EVERY_S = 10.0
LINE_EVERY_SHARE = 0.1
LEAST_S = 1.0
"""A batch that is computed in a moment needs no lines."""


@contextmanager
def shown(runs: RunCounts) -> Iterator[Callable[[], None]]:
    """Give what shows a batch's progress anew, on the error stream; a bar is gone at the end."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield Lines(runs, lambda line: typer.echo(line, err=True)).show
        return
    columns = BarColumn(), TaskProgressColumn(), TextColumn("{task.description}")
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task(words(runs), total=runs.runs, completed=runs.done)
        yield lambda: bar.update(task, completed=runs.done, description=words(runs))


class Lines:
    """A line of a log every ten seconds and at every tenth of the runs, at most one a second."""

    def __init__(
        self, runs: RunCounts, write: Callable[[str], object], clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._runs, self._write, self._clock = runs, write, clock
        self._told_s, self._told_share = clock(), runs.share

    def show(self) -> None:
        """Write a line if it is time for one."""
        share, now_s = self._runs.share, self._clock()
        tenths = math.floor(share / LINE_EVERY_SHARE) > math.floor(self._told_share / LINE_EVERY_SHARE)
        since_s = now_s - self._told_s
        if since_s >= LINE_EVERY_S or (tenths and since_s >= LEAST_S):
            self._told_s, self._told_share = now_s, share
            self._write(f"{math.floor(100.0 * share)} %, {words(self._runs)}")


def words(runs: RunCounts) -> str:
    """Return how far a batch is: runs, those that ended early or were refused, rate, time left."""
    told = [f"{runs.done:,} of {runs.runs:,} runs"]
    told += [f"{runs.counts[state]:,} {state}" for state in ("ended", "refused") if runs.counts[state]]
    if runs.rate is not None:
        left = runs.document()["seconds_left"]
        told += [f"{runs.rate:,.0f} runs/s", *([] if left is None else [f"{timedelta(seconds=round(left))} left"])]
    return ", ".join(told) if len(told) > 1 else f"{told[0]}, starting"
