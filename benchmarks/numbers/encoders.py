"""Section 5: encoders only. The position observer beside the velocity observer behind filtered differences."""

import numpy as np

from benchmarks.numbers.setting import error_and_chatter, sine_scenario, unlimited_motor
from benchmarks.numbers.table import PRODUCT, Line, mrad
from vssea_core.actuator.parameters import Actuator
from vssea_core.control.observer_design import position_form
from vssea_core.control.tuning import Observer, PositionObserver, Tuning, VelocityObserver
from vssea_core.scenarios import REALISTIC
from vssea_core.simulation.metrics import metrics
from vssea_core.simulation.run import simulate


def difference(bandwidth: float, velocity_filter: float) -> VelocityObserver:
    """Return the velocity observer on filtered encoder differences."""
    return VelocityObserver(velocity_source="difference", bandwidth=bandwidth, velocity_filter=velocity_filter)


CASES: tuple[tuple[str, float, Observer, str], ...] = (
    ("position, g 100", 200.0, PositionObserver(bandwidth=100.0), "0.86 N m, 0.48 mrad"),
    ("differences 1000 rad/s, g 100", 200.0, difference(100.0, 1000.0), "72 N m, 7.7 mrad"),
    ("differences 1000 rad/s, g 60", 200.0, difference(60.0, 1000.0), "26-27 N m, 0.47-0.67 mrad"),
    ("differences 300 rad/s, g 100", 200.0, difference(100.0, 300.0), "26-27 N m, 0.47-0.67 mrad"),
    ("position, g 100", 50.0, PositionObserver(bandwidth=100.0), "5.6 N m, 0.56 mrad"),
    ("differences 1000 rad/s, g 100", 50.0, difference(100.0, 1000.0), "102 N m, 40 mrad, 80 % saturated"),
)


def noise() -> list[Line]:
    """17-bit link encoder, 5.6 N m of dry friction that the model lacks, no lag and no delay, 74 N m."""
    lines = []
    rig = {"actuator": Actuator(motor=unlimited_motor(coulomb_friction=5.6)), "sensors": REALISTIC.sensors}
    for words, k, observer, expected in CASES:
        run = simulate(sine_scenario(Tuning(observer=observer), k, **rig))
        error, chatter = error_and_chatter(run)
        share = metrics(run.rows[4000:])["saturated"]
        measured = f"{chatter:.3g} N m, {mrad(error)}, {share:.0f} % saturated"
        how = PRODUCT + ("; law and observer on the same filtered velocities" if observer.kind == "velocity" else "")
        lines.append(Line(f"k {k:g}, {words}: chatter, RMS error", expected, measured, how))
    return lines


def cubic() -> list[Line]:
    """Steady errors of the position form under d''' = c, in units of c/g^3, c/g^2, c/g, at T = 0.1 ms."""
    g, t = 30.0, 1e-4
    a, _, _, m = position_form(g, 0.0, t)
    x, end = np.zeros(5), 1.5
    for k in range(1, round(end / t) + 1):
        predicted = a @ x
        x = predicted + m * (-((k * t) ** 5) / 120.0 - predicted[0])
    errors = (np.array([end**3 / 6.0, end**2 / 2.0, end]) - x[2:]) * g ** np.array([3, 2, 1])
    shown = ", ".join(f"{error:.3g}" for error in errors)
    ratio = errors[0] ** (1.0 / 3.0)
    return [
        Line("position form, d''' = c: errors in c/g^3, c/g^2, c/g", "10, 10, 5", shown, PRODUCT),
        Line("g_pos / g_vel for equal low-frequency error", "2.15", f"{ratio:.3g}", PRODUCT),
    ]


SECTIONS = (noise, cubic)
