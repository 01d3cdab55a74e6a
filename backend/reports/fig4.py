"""Fig. 4: both robust controllers on a rig: the paper shows experiments, this is a simulation of one."""

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
from backend.reports.style import LIMIT_LINE, LINK, TORQUE
from vssea_core.paper.claim import Runs
from vssea_core.paper.scenarios import DISTURBED_S, UNDISTURBED_S

UNTIL_S = 12.0
MARKS = (DISTURBED_S, UNDISTURBED_S)
MILLI = 1e3


def fig4(runs: Runs) -> Figure:
    """Return Fig. 4: a) robust state feedback, b) sliding mode; disturbed from 3 to 10 s."""
    figure, (a, b) = stacked_panels(3.8, 3.8)
    _controlled(a, runs, "fig4a")
    titled(a, "a) Position control using the robust state feedback controller (simulated rig).")
    _controlled(b, runs, "fig4b")
    titled(b, "b) Position control using the sliding mode controller (simulated rig).")
    return figure


def _controlled(panel: SubFigure, runs: Runs, name: str) -> None:
    grid = grid_of(panel, (1.5, 1.0, 1.0), heads=True)
    for (task, words), (position, error, torque) in zip(COLUMNS.items(), grid.T, strict=True):
        run = runs[f"{name}_{task}"]
        headed(position, words)
        over_time(position, "link position (rad)", UNTIL_S, MARKS)
        draw_reference(position, run)
        draw(position, run, run["link_position"], label="link", color=LINK)
        position.set_ylim((-0.05, 0.7) if task == "regulation" else (-0.62, 0.78))
        event_words(position, DISTURBED_S, "disturbances on")
        event_words(position, UNDISTURBED_S, "off", side="right")
        over_time(error, "error (mrad)", UNTIL_S, MARKS)
        draw(error, run, MILLI * run["error"], color=LINK)
        limited(error, -32.0, 32.0, {"": MILLI * run["error"]}, "mrad")
        over_time(torque, "torque (N·m)", UNTIL_S, MARKS)
        draw(torque, run, run["motor_torque"], label="motor torque", color=TORQUE, linewidth=0.5)
        limit = run.scenario.actuator.motor.peak_torque
        torque.axhline(limit, label="torque limit", **LIMIT_LINE)
        torque.axhline(-limit, **LIMIT_LINE)
        torque.set_ylim(-90.0, 90.0)
    legend_above(panel, grid[0, 0], grid[2, 0])
