"""Times of the loop analysis on two cores, and python-control doing the same for one point, in one run."""

import math
from collections.abc import Callable

import control
import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks.timing import timed
from vssea_core.actuator.sensors import encoders
from vssea_core.analysis.bandwidth_sets import LeastMargins, bandwidth_sets
from vssea_core.analysis.loop import loop_model
from vssea_core.analysis.maps import map_axis, margin_map, stability_map
from vssea_core.analysis.margins import margins
from vssea_core.analysis.noise import observer_figures
from vssea_core.analysis.operating_point import LinearPlant, OperatingPoint
from vssea_core.analysis.robustness import robustness
from vssea_core.analysis.sensitivities import sensitivities
from vssea_core.analysis.worst_case import worst_case
from vssea_core.scenarios import REALISTIC

MAPS = (
    ("spring", "link_inertia"),
    ("stiffness", "bandwidth"),
    ("motor_inertia", "delay_s"),
    ("poles", "bandwidth"),
)
FREQUENCIES = 331
"""As many as the report's own grid has."""


def realistic_point() -> OperatingPoint:
    """Return the tuning of the scenario `realistic` on its own model, with the rig's lag and delay, at 200 N m/rad."""
    plant = LinearPlant.of_model(REALISTIC.tuning, REALISTIC.actuator.motor.torque_lag_s)
    return OperatingPoint(REALISTIC.tuning, REALISTIC.timing, 200.0, plant)


def by_python_control(point: OperatingPoint) -> Callable[[], object]:
    """Return the margins of both breaks of one loop by python-control: frequency data, stability_margins, disk_margins."""
    loop = loop_model(point)
    w = np.geomspace(1.0, 0.9999 * math.pi / point.period_s, FREQUENCIES)

    def work() -> object:
        found = []
        for system in (loop.broken_at_plant(), loop.broken_at_limiter()):
            space = control.ss(*system, point.period_s)
            data = control.frd(space(np.exp(1j * w * point.period_s)), w, smooth=True)
            found.append((control.stability_margins(data), control.disk_margins(space, w)))
        return found

    return work


def main() -> None:
    """Print the time of each analysis of the scenario `realistic`."""
    point = realistic_point()
    loop = loop_model(point)
    resolutions = encoders(REALISTIC.sensors, REALISTIC.actuator.motor)
    rows: list[tuple[str, float, float, str]] = []

    def measured(words: str, work: Callable[[], object], repeats: int, how: str = "") -> None:
        rows.append((words, *timed(work, repeats), how))

    for x, y in MAPS:
        across, up = map_axis(x, 100), map_axis(y, 100)
        measured(
            f"stability map 100 x 100, {x} by {y}", lambda a=across, b=up: stability_map(point, a, b), 3, "2 threads"
        )
    for x, y in MAPS:
        across, up = map_axis(x, 30), map_axis(y, 30)
        measured(f"margin map 30 x 30, {x} by {y}", lambda a=across, b=up: margin_map(point, a, b), 3, "2 threads")
    measured("one loop: matrices", lambda: loop_model(point), 50, f"{len(loop.A)} states, tuning prepared")
    measured("one loop: margins at both breaks", lambda: margins(loop), 50, "331 frequencies, each crossing refined")
    measured(
        "one loop: the same by python-control",
        by_python_control(point),
        3,
        f"{FREQUENCIES} frequencies, crossings by spline",
    )
    measured(
        "one tuning: robustness with margins",
        lambda: robustness(point),
        10,
        "3 parameters x 2 sides, delay, both breaks",
    )
    measured("one tuning: sensitivities", lambda: sensitivities(loop), 10, "10 curves with their peaks")
    measured("one tuning: meaning of g, torque noise", lambda: observer_figures(loop, resolutions), 10)
    stiffnesses = np.geomspace(20.0, 1000.0, 20).tolist()
    measured(
        "stable bandwidths at 20 stiffnesses", lambda: bandwidth_sets(point, stiffnesses, [{"link_inertia": 2.0}]), 2
    )
    asked = LeastMargins(disk=0.3)
    measured("the same with margins", lambda: bandwidth_sets(point, stiffnesses, [{"link_inertia": 1.2}], asked), 2)
    box = {
        "link_inertia": (0.7, 1.4), "motor_inertia": (0.9, 1.2), "link_damping": (0.5, 2.0),
        "motor_damping": (0.5, 2.0), "spring": (0.8, 1.2), "delay_s": (0.0, 1e-3),
    }  # fmt: skip
    measured("worst case of six parameters, growth", lambda: worst_case(point, box), 2, "about 6000 plants")
    measured(
        "worst case of six parameters, disk margin", lambda: worst_case(point, box, "disk"), 2, "about 6000 plants"
    )

    table = Table("scenario realistic", "best", "median", "how")
    for words, best, median, how in rows:
        table.add_row(words, f"{1e3 * best:.4g} ms", f"{1e3 * median:.4g} ms", how)
    Console(width=150).print(table)


if __name__ == "__main__":
    main()
