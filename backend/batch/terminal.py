"""A batch on a terminal: how far it is, how fast, and how long it will take."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import timedelta

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn

from backend.batch.progress import RunCounts


@contextmanager
def shown(runs: RunCounts) -> Iterator[Callable[[], None]]:
    """Give what shows a batch's progress anew, on the error stream; the bar is gone at the end."""
    columns = BarColumn(), TaskProgressColumn(), TextColumn("{task.description}")
    console = Console(stderr=True)
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task(words(runs), total=runs.runs, completed=runs.done)
        yield lambda: bar.update(task, completed=runs.done, description=words(runs))


def words(runs: RunCounts) -> str:
    """Return how far a batch is: runs, those that ended early or were refused, rate, time left."""
    told = [f"{runs.done:,} of {runs.runs:,} runs"]
    told += [f"{runs.counts[state]:,} {state}" for state in ("ended", "refused") if runs.counts[state]]
    if runs.rate is not None:
        left = runs.document()["seconds_left"]
        told += [f"{runs.rate:,.0f} runs/s", *([] if left is None else [f"{timedelta(seconds=round(left))} left"])]
    return ", ".join(told) if len(told) > 1 else f"{told[0]}, starting"
