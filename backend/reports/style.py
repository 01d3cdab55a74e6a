"""One look for every figure: column widths, type, line weights, and one colour for each signal (the page's light colours)."""

from contextlib import AbstractContextManager
from typing import Any

import matplotlib

TEXT_WIDTH_IN = 7.0
"""A figure over both columns; one column is half of it."""

TEXT, DIM, GRID = "#1d2630", "#5d6977", "#e2e7ed"
REFERENCE = "#6b7786"
LINK, LINK_LQR = "#0072b2", "#56b4e9"
TORQUE = "#c77700"
LINK_DISTURBANCE, MOTOR_DISTURBANCE = "#b84a00", "#8a6d1f"
EVENT = "#98a3b0"

NOTE_SIZE = 6.0

LINE: dict[str, Any] = {"linewidth": 1.0, "solid_joinstyle": "round"}
REFERENCE_LINE: dict[str, Any] = {"color": REFERENCE, "linestyle": (0, (4, 2)), "linewidth": 0.9}
UNDISTURBED_LINE: dict[str, Any] = {"color": LINK, "linestyle": (0, (1, 1.3)), "linewidth": 0.9}
LIMIT_LINE: dict[str, Any] = {"color": DIM, "linestyle": (0, (6, 2, 1, 2)), "linewidth": 0.6}
TRUE_LINE: dict[str, Any] = {"linewidth": 2.6, "alpha": 0.35, "solid_capstyle": "butt"}
ESTIMATE_LINE: dict[str, Any] = {"linewidth": 0.8}

_SETTINGS: Any = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],  # comes with matplotlib: the same figure everywhere
    "font.size": 7.0,
    "axes.labelsize": 7.0,
    "axes.titlesize": 7.5,
    "axes.titlepad": 4.0,
    "xtick.labelsize": 6.5,
    "ytick.labelsize": 6.5,
    "legend.fontsize": 6.8,
    "text.color": TEXT,
    "axes.labelcolor": TEXT,
    "axes.edgecolor": DIM,
    "xtick.color": DIM,
    "ytick.color": DIM,
    "xtick.labelcolor": TEXT,
    "ytick.labelcolor": TEXT,
    "axes.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": GRID,
    "grid.linewidth": 0.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.unicode_minus": True,
    "legend.frameon": False,
    "legend.handlelength": 2.4,
    "legend.columnspacing": 1.6,
    "legend.borderaxespad": 0.0,
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
    "savefig.dpi": 300,
    "svg.fonttype": "path",
    "svg.hashsalt": "vssea",
    "path.simplify_threshold": 0.2,
}


def style() -> AbstractContextManager[None]:
    """Return the context in which figures are drawn and saved."""
    return matplotlib.rc_context(_SETTINGS)
