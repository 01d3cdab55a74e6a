"""The report on a terminal: how far it is, and its claims."""

import math
from collections.abc import Callable
from typing import Any, TypeVar

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from vssea_core.paper.claim import with_unit

Result = TypeVar("Result")


def with_progress(work: Callable[[Callable[[float, str], None]], Result]) -> Result:
    """Return what `work` returns, showing on the error stream what it tells: the share done [0, 1] and words."""
    columns = TextColumn("{task.description:<44}"), BarColumn(), TimeElapsedColumn()
    with Progress(*columns, console=Console(stderr=True), transient=True) as shown:
        bar = shown.add_task("starting", total=1.0)
        return work(lambda share, words: shown.update(bar, completed=share, description=words))


def claims_shown(report: dict[str, Any]) -> Table:
    """Return the claims of a report's document as a table: of each the number closest to its limit, and the result."""
    table = Table(show_lines=True)
    table.add_column("No.", justify="right")
    table.add_column("claim", ratio=1)
    table.add_column("closest to its limit", ratio=1)
    table.add_column("result")
    for claim in report["claims"]:
        judged = [number for number in claim["numbers"] if number["criterion"]]
        words = _number_words(max(judged, key=_nearness)) if judged else claim["ending"]
        table.add_row(
            str(claim["number"]), claim["sentence"], words, "[green]passed[/]" if claim["passed"] else "[bold red]failed[/]"
        )  # fmt: skip
    return table


def _nearness(number: dict[str, Any]) -> float:
    """Return how much of its limit a number takes up: 1 at the limit, more beyond it."""
    value, limit = number["value"], number["criterion"]["limit"]
    if value is None or (value <= 0.0 and number["criterion"]["relation"] == "at least"):
        return math.inf
    return float(value / limit if number["criterion"]["relation"] == "at most" else limit / value)


def _number_words(number: dict[str, Any]) -> str:
    value = "none" if number["value"] is None else with_unit(number["value"], number["unit"])
    limit = with_unit(number["criterion"]["limit"], number["unit"])
    return f"{number['label']}: {value} ({number['criterion']['relation']} {limit})"
