"""Parts that the figures share: panels and their axes, the marks of events, notes on what an axis leaves out."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from numpy.typing import NDArray

from backend.reports.style import DIM, EVENT, LINE, NOTE_SIZE, REFERENCE_LINE, TEXT_WIDTH_IN
from vssea_core.paper.claim import Run, with_unit

Samples = NDArray[np.float64]
COLUMNS = {"regulation": "Regulation", "tracking": "Trajectory tracking"}
LEFT, RIGHT, GAP = 0.072, 0.988, 0.19
"""Edges of the axes as shares of the width, and the gap between two as a share of one: the same in every panel."""
BEYOND = "off the axis: to"
ABOVE_IN, BELOW_IN = 0.32, 0.56
"""Room for the legend, and for time axis and title."""


def stacked_panels(*heights: float) -> tuple[Figure, list[SubFigure]]:
    """Return a figure over both columns with one panel below the other, of the given heights [in]."""
    figure = Figure(figsize=(TEXT_WIDTH_IN, sum(heights)))
    panels: Any = figure.subfigures(len(heights), 1, height_ratios=list(heights), hspace=0.0)
    return figure, list(panels)


def grid_of(panel: SubFigure, ratios: Sequence[float], columns: int = 2, *, heads: bool = False) -> NDArray[Any]:
    """Return the axes (rows, columns) of a panel, with room for its legend and title, and for heads of the columns."""
    height = panel.bbox.height / panel.figure.dpi
    above = ABOVE_IN + (0.14 if heads else 0.0)
    axes: NDArray[Any] = panel.subplots(
        len(ratios), columns, sharex=True, squeeze=False, height_ratios=list(ratios),
        gridspec_kw={
            "left": LEFT, "right": RIGHT, "top": 1.0 - above / height, "bottom": BELOW_IN / height, "wspace": GAP, "hspace": 0.2,
        },
    )  # fmt: skip
    panel.align_ylabels()
    return axes


def titled(panel: SubFigure, title: str) -> None:
    """Write the panel's title below it, as the paper does."""
    height = panel.bbox.height / panel.figure.dpi
    panel.text(0.5 * (LEFT + RIGHT), 0.1 / height, title, ha="center", va="bottom", fontsize=8.0)


def legend_above(panel: SubFigure, *of: Axes) -> None:
    """Place the legend of some axes above the panel, where it hides nothing."""
    known = {label: handle for axes in of for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)}
    height = panel.bbox.height / panel.figure.dpi
    place = (0.5 * (LEFT + RIGHT), 1.0 - 0.06 / height)
    panel.legend(known.values(), known.keys(), loc="upper center", bbox_to_anchor=place, ncols=len(known))


def over_time(axes: Axes, label: str, until_s: float, marks: Sequence[float]) -> None:
    """Set up an axis over time with its unit, and the marks of when disturbances begin and end."""
    axes.set_xlim(0.0, until_s)
    axes.set_xticks(np.arange(0.0, until_s + 0.5, 2.0))
    axes.set_ylabel(label)
    for mark in marks:
        axes.axvline(mark, color=EVENT, linewidth=0.7, linestyle=(0, (1.5, 1.5)), zorder=0.5)
    last = axes.get_subplotspec()
    if last is not None and last.is_last_row():
        axes.set_xlabel("time (s)", labelpad=1.0)


def event_words(axes: Axes, time_s: float, words: str, *, side: str = "left") -> None:
    """Write `words` beside the mark at `time_s`, at the top of `axes`."""
    away, edge = (-2.5, "right") if side == "left" else (2.5, "left")
    axes.annotate(
        words, (time_s, 1.0), xycoords=("data", "axes fraction"), xytext=(away, -1.0), textcoords="offset points",
        ha=edge, va="top", fontsize=NOTE_SIZE, color=DIM,
    )  # fmt: skip


def limited(axes: Axes, low: float, high: float, curves: Mapping[str, Samples], unit: str, words: str = BEYOND) -> None:
    """Show `low` to `high`, and say above the axes in `words` how far each named curve goes beyond."""
    axes.set_ylim(low, high)
    beyond = []
    for name, values in curves.items():
        extremes = [float(x) for x in (values.min(), values.max()) if not low <= x <= high]
        if extremes:
            beyond.append(f"{name} {' and '.join(with_unit(x, '') for x in extremes)}".strip())
    if beyond:
        note = f"{words} {', '.join(beyond)} {unit}".replace("-", "−")
        axes.text(1.0, 1.015, note, transform=axes.transAxes, ha="right", va="bottom", fontsize=NOTE_SIZE, color=DIM)


def headed(axes: Axes, words: str) -> None:
    """Write the head of a column, to the left of any note."""
    axes.set_title(words, loc="left")


def draw(axes: Axes, run: Run, values: Samples, **how: Any) -> None:
    """Draw `values` over the run's time."""
    axes.plot(run["time"], values, **{**LINE, **how})


def draw_reference(axes: Axes, run: Run) -> None:
    """Draw the reference of the link, dashed and grey."""
    axes.plot(run["time"], run["reference"], label="reference", zorder=3, **REFERENCE_LINE)
