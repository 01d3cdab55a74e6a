"""Fig. 3: the robust state feedback controller, and what its observer estimates."""

import numpy as np
from matplotlib.axes import Axes
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
from backend.reports.style import (
    ESTIMATE_LINE,
    LINK,
    LINK_DISTURBANCE,
    LINK_LQR,
    MOTOR_DISTURBANCE,
    TRUE_LINE,
)
from vssea_core.paper.claim import Run, Runs
from vssea_core.paper.disturbance_rates import load_and_rates
from vssea_core.paper.measures import LINK_ESTIMATES, MOTOR_ESTIMATES
from vssea_core.paper.scenarios import DISTURBED_S

UNTIL_S = 10.0
MARKS = (DISTURBED_S,)
MILLI = 1e3
DESIGNS = {
    "lqr": ("link, LQR", {"color": LINK_LQR, "linewidth": 1.7}),
    "poles": ("link, poles", {"color": LINK, "linewidth": 0.8}),
}
UNITS = ("N·m", "N·m/s", "N·m/s²")
SIDES = {"link": (LINK_DISTURBANCE, LINK_ESTIMATES), "motor": (MOTOR_DISTURBANCE, MOTOR_ESTIMATES)}


def fig3(runs: Runs) -> Figure:
    """Return Fig. 3: a) pole placement and LQR with the observer, b) disturbances, c) their derivatives, with estimates."""
    figure, (a, b, c) = stacked_panels(2.95, 1.95, 2.05)
    _controlled(a, runs)
    titled(
        a, "a) Robust state feedback controller when the performance controller is tuned using pole placement and LQR."
    )
    run = runs["fig3a_poles_regulation"]
    left, right = grid_of(b, (1.0,))[0]
    _estimated(left, run, 0, {"link": "link"}, "on the link (N·m)", 11.0)
    _estimated(right, run, 0, {"motor": "motor"}, "on the motor (N·m)", 11.0)
    legend_above(b, left, right)
    titled(b, "b) Disturbances and their estimates.")
    left, right = grid_of(c, (1.0,), heads=True)[0]
    _estimated(left, run, 1, {"link": "link", "motor": "motor"}, "d/dt (N·m/s)", 60.0)
    _estimated(right, run, 2, {"link": ""}, "d²/dt² (N·m/s²)", 450.0)
    legend_above(c, left)
    titled(c, "c) First and second derivatives of the disturbances and their estimates.")
    return figure


def _controlled(panel: SubFigure, runs: Runs) -> None:
    grid = grid_of(panel, (1.5, 1.0), heads=True)
    for (task, words), (position, error) in zip(COLUMNS.items(), grid.T, strict=True):
        headed(position, words)
        over_time(position, "link position (rad)", UNTIL_S, MARKS)
        over_time(error, "error (mrad)", UNTIL_S, MARKS)
        draw_reference(position, runs[f"fig3a_poles_{task}"])
        errors = []
        for design, (label, how) in DESIGNS.items():
            run = runs[f"fig3a_{design}_{task}"]
            draw(position, run, run["link_position"], label=label, **how)
            draw(error, run, MILLI * run["error"], **how)
            errors.append(MILLI * run["error"])
        position.set_ylim((-0.1, 1.3) if task == "regulation" else (-0.65, 0.75))
        limited(error, -20.0, 20.0, {"": np.concatenate(errors)}, "mrad")
        event_words(position, DISTURBED_S, "disturbances on")
    legend_above(panel, grid[0, 0])


def _estimated(axes: Axes, run: Run, order: int, sides: dict[str, str], label: str, limit: float) -> None:
    """Draw disturbances (order 0) or a derivative of them, wide and pale, and their estimates thin on it."""
    over_time(axes, label, UNTIL_S, MARKS)
    estimates = {}
    for side, words in sides.items():
        colour, channels = SIDES[side]
        true = load_and_rates(getattr(run.scenario.disturbances, side), run["time"])[order]
        estimates[words] = run[channels[order]]
        draw(axes, run, true, label=f"{side}, true", color=colour, **TRUE_LINE)
        draw(axes, run, estimates[words], label=f"{side}, estimate", color=colour, **ESTIMATE_LINE)
    limited(axes, -limit if order else -6.0, limit, estimates, UNITS[order], "off the axis at 3 s: to")
