"""Fig. 2: state feedback without observer."""

from matplotlib.figure import Figure, SubFigure

from backend.reports.panels import (
    COLUMNS,
    draw,
    draw_reference,
    event_words,
    grid_of,
    headed,
    legend_above,
    limited,
    over_time,
    stacked_panels,
    titled,
)
from backend.reports.style import LINK, LINK_DISTURBANCE, MOTOR_DISTURBANCE, UNDISTURBED_LINE
from vssea_core.paper.claim import Runs
from vssea_core.paper.scenarios import DISTURBED_S

UNTIL_S = 10.0
MARKS = (DISTURBED_S,)
POSITIONS = (-1.2, 2.2)


def fig2(runs: Runs) -> Figure:
    """Return Fig. 2: a) pole placement, b) LQR, c) the disturbances."""
    figure, (a, b, c) = stacked_panels(3.0, 3.0, 1.75)
    _controlled(a, runs, "fig2a", 22.0)
    titled(a, "a) Regulation and trajectory tracking control using pole placement.")
    _controlled(b, runs, "fig2b", 0.8)
    titled(b, "b) Regulation and trajectory tracking control using LQR.")
    _disturbances(c, runs)
    titled(c, "c) Disturbances.")
    return figure


def _controlled(panel: SubFigure, runs: Runs, name: str, largest_error: float) -> None:
    grid = grid_of(panel, (1.5, 1.0), heads=True)
    for (task, words), (position, error) in zip(COLUMNS.items(), grid.T, strict=True):
        run, undisturbed = runs[f"{name}_{task}"], runs[f"{name}_{task}_undisturbed"]
        headed(position, words)
        over_time(position, "link position (rad)", UNTIL_S, MARKS)
        draw_reference(position, run)
        draw(position, undisturbed, undisturbed["link_position"], label="link, undisturbed", **UNDISTURBED_LINE)
        draw(position, run, run["link_position"], label="link", color=LINK)
        limited(position, *POSITIONS, {"": run["link_position"]}, "rad")
        event_words(position, DISTURBED_S, "disturbances on")
        over_time(error, "error (rad)", UNTIL_S, MARKS)
        draw(error, undisturbed, undisturbed["error"], **UNDISTURBED_LINE)
        draw(error, run, run["error"], color=LINK)
        limited(error, -largest_error, largest_error, {"": run["error"]}, "rad")
    legend_above(panel, grid[0, 0])


def _disturbances(panel: SubFigure, runs: Runs) -> None:
    run, axes = runs["fig2a_regulation"], grid_of(panel, (1.0,), columns=1)[0, 0]
    over_time(axes, "torque (N·m)", UNTIL_S, MARKS)
    draw(axes, run, run["link_disturbance"], label="on the link", color=LINK_DISTURBANCE)
    draw(axes, run, run["motor_disturbance"], label="on the motor", color=MOTOR_DISTURBANCE, linestyle=(0, (5, 1.2)))
    axes.set_ylim(-6.0, 10.0)
    legend_above(panel, axes)
