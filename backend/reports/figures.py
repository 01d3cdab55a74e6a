"""The figures of the report: what draws each, and its caption."""

import io
from collections.abc import Callable
from typing import NamedTuple

import matplotlib.figure

from backend.reports.fig2 import fig2
from backend.reports.fig3 import fig3
from backend.reports.fig4 import fig4
from backend.reports.style import style
from vssea_core.paper.claim import Runs


class Drawing(NamedTuple):
    """One figure: its name, what draws it, and the words below it."""

    name: str
    draw: Callable[[Runs], matplotlib.figure.Figure]
    caption: str

    @property
    def files(self) -> tuple[str, str]:
        """The names of its files."""
        return f"{self.name}.svg", f"{self.name}.png"


DRAWINGS: tuple[Drawing, ...] = (
    Drawing(
        "fig2", fig2,
        "Fig. 2. Position control using a state feedback controller without observer, simulated without torque limit; numbers "
        "are ours. a) Poles at −8 rad/s ×4, b) LQR with Q = diag(101, 1, 1, 1), R = 0.1, for a set point of 1 rad and a sine of "
        "0.5 rad, 0.25 Hz, c) disturbances from 3 s on. In a) the "
        "link leaves the position axis; the error is shown whole. The controllers know no derivative of the reference, so the link "
        "lags the sine even undisturbed.",
    ),
    Drawing(
        "fig3", fig3,
        "Fig. 3. The robust motion controller: the same poles and the same LQR with the second-order disturbance observer "
        "(g = 200 rad/s), under the disturbances of Fig. 2c; numbers are ours. True signals are wide and pale, estimates thin. "
        "When the disturbances jump at 3 s, the estimated derivatives leave the axes for up to 45 ms. Of the second "
        "derivatives, the control laws need the link's alone.",
    ),
    Drawing(
        "fig4", fig4,
        "Fig. 4. The paper shows experiments here; this is a simulated rig, with numbers of ours: encoders (17 bit, 16384 counts), "
        "dry friction of 5.6 N·m unknown to the model, torque limit of 74 N·m, torque lag, one sample of delay, position observer "
        "(g = 100 rad/s). a) Poles at −20 rad/s ×4, b) surface poles at −20 rad/s ×3 with a boundary layer. Disturbances of "
        "Fig. 2c from 3 to 10 s.",
    ),
)  # fmt: skip


def drawn(drawing: Drawing, runs: Runs) -> tuple[bytes, bytes]:
    """Return the figure as an SVG and as a PNG of 300 dpi; the same runs give the same bytes."""
    svg, png = io.BytesIO(), io.BytesIO()
    title = drawing.caption.split(". ")[1]
    with style():
        figure = drawing.draw(runs)
        figure.savefig(svg, format="svg", metadata={"Title": title, "Date": None})
        figure.savefig(png, format="png", metadata={"Title": title})
    return svg.getvalue(), png.getvalue()
