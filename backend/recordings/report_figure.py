"""The figure of a recording's report: position, error, torque, disturbances and stiffness over time, with what happened."""

import io
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from backend.recordings.samples import Drawn
from backend.reports.style import (
    ESTIMATE_LINE,
    EVENT,
    LIMIT_LINE,
    LINE,
    LINK,
    LINK_DISTURBANCE,
    MOTOR_DISTURBANCE,
    NOTE_SIZE,
    REFERENCE_LINE,
    TEXT_WIDTH_IN,
    TORQUE,
    TRUE_LINE,
    style,
)

STIFFNESS, FAULT, WARNING = "#00795a", "#cf2f2a", "#b06d00"
POINTS = 1600
CHANNELS = [
    "reference", "link_position", "error", "motor_torque", "motor_torque_limit", "link_disturbance",
    "link_disturbance_estimate", "motor_disturbance", "motor_disturbance_estimate", "stiffness", "stiffness_reference", "limits",
]  # fmt: skip
MOST_MARKS = 40
MILLI = 1e3
Document = dict[str, Any]


def recording_figure(shown: Drawn, tunings: list[Document], events: list[Document]) -> bytes:
    """Return the figure as SVG; `shown` holds CHANNELS. Marks: dashed for a change, red for a stop or fault."""
    columns = {name: shown.rows[:, place] for place, name in enumerate(CHANNELS)}
    with style():
        figure = Figure(figsize=(TEXT_WIDTH_IN, 7.6))
        grid: Any = figure.subplots(
            5, 1, sharex=True, height_ratios=[1.4, 1.0, 1.2, 1.2, 0.9],
            gridspec_kw={"left": 0.085, "right": 0.988, "top": 0.975, "bottom": 0.055, "hspace": 0.32},
        )  # fmt: skip
        _draw(list(grid), shown.time, columns)
        _mark(list(grid), tunings, events)
        figure.align_ylabels()
        svg = io.BytesIO()
        figure.savefig(svg, format="svg", metadata={"Title": "recording", "Date": None})
    return svg.getvalue()


def _draw(grid: list[Axes], time: NDArray[np.float64], values: dict[str, NDArray[np.float64]]) -> None:
    position, error, torque, disturbance, stiffness = grid
    position.plot(time, values["link_position"], color=LINK, label="link", **LINE)
    position.plot(time, values["reference"], label="reference", **REFERENCE_LINE)
    _named(position, "position (rad)")
    error.plot(time, MILLI * values["error"], color=LINK, label="reference − link", **LINE)
    _named(error, "error (mrad)")
    torque.plot(time, values["motor_torque"], color=TORQUE, label="motor torque", **LINE)
    limit = values["motor_torque_limit"]
    torque.plot(time, limit, label="torque limit", **LIMIT_LINE)
    torque.plot(time, -limit, **LIMIT_LINE)
    limited = np.nan_to_num(values["limits"]) > 0
    if limited.any():
        torque.plot(
            time, np.where(limited, 1.0, np.nan), transform=torque.get_xaxis_transform(), color=FAULT, linewidth=2.5,
            solid_capstyle="butt", marker=".", markersize=1.5, clip_on=False, label="a limit active",
        )  # fmt: skip
    _named(torque, "torque (N·m)")
    for name, words, colour in (("link", "link", LINK_DISTURBANCE), ("motor", "motor", MOTOR_DISTURBANCE)):
        true, estimate = values[f"{name}_disturbance"], values[f"{name}_disturbance_estimate"]
        disturbance.plot(time, true, color=colour, label=f"{words}, true", **TRUE_LINE)
        disturbance.plot(time, estimate, color=colour, label=f"{words}, estimate", **ESTIMATE_LINE)
    _named(disturbance, "disturbance (N·m)")
    stiffness.plot(time, values["stiffness"], color=STIFFNESS, label="stiffness", **LINE)
    stiffness.plot(time, values["stiffness_reference"], label="commanded", **REFERENCE_LINE)
    _named(stiffness, "k (N·m/rad)")
    stiffness.set_xlabel("time (s)", labelpad=1.0)
    if len(time):
        stiffness.set_xlim(time[0], max(time[-1], time[0] + 1e-6))


def _named(axes: Axes, label: str) -> None:
    axes.set_ylabel(label)
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 0.985), ncols=6, borderpad=0.1)


def _mark(grid: list[Axes], tunings: list[Document], events: list[Document]) -> None:
    """Mark changes by the numbers that their rows in the report's table have, and stops and faults."""
    numbers: dict[float, list[str]] = {}
    for number, change in enumerate(tunings[:MOST_MARKS], 1):
        numbers.setdefault(float(change["at_s"]), []).append(str(number))
    for at_s, those in numbers.items():
        for axes in grid:
            axes.axvline(at_s, color=EVENT, linewidth=0.7, linestyle=(0, (1.5, 1.5)), zorder=0.5)
        grid[0].annotate(
            ", ".join(those), (at_s, 1.0), xycoords=("data", "axes fraction"), xytext=(1.5, 1.0),
            textcoords="offset points", ha="left", va="bottom", fontsize=NOTE_SIZE, color=EVENT,
        )  # fmt: skip
    for event in events:
        colour = FAULT if event["severity"] == "fault" else WARNING if event["kind"] == "state" else None
        if colour is not None and event["severity"] != "info":
            for axes in grid:
                axes.axvline(event["time_s"], color=colour, linewidth=0.9, zorder=0.6)
