"""The controller as named numbers with units: all that is needed to write its tick elsewhere."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vssea_core import __version__
from vssea_core.control.tuning import SlidingMode
from vssea_core.export.order import order_of_tick
from vssea_core.export.tables import POSITION_NUMBERS, VELOCITY_NUMBERS, Tables, tables_of
from vssea_core.scenario import Scenario

SCHEMA_VERSION = 1
Document = dict[str, Any]
Numbers = NDArray[np.float64]


class Legend:
    """Numbers by dotted name, with their units and meanings in trees of the same shape."""

    def __init__(self) -> None:
        self.values: Document = {}
        self.units: Document = {}
        self.meanings: Document = {}

    def put(self, name: str, value: Any, unit: str, meaning: str) -> None:
        """Add one quantity; arrays become lists."""
        plain = value.tolist() if isinstance(value, np.ndarray) else value
        for tree, leaf in ((self.values, plain), (self.units, unit), (self.meanings, meaning)):
            *branch, last = name.split(".")
            for part in branch:
                tree = tree.setdefault(part, {})
            tree[last] = leaf


def controller_numbers(scenario: Scenario) -> Document:
    """Return the controller of `scenario` as plain numbers, lists and words, ready for JSON.

    Names are those of the equations. Gains and the observers' matrices are lists over the stiffness: one entry for each of
    `gains.k`, or a single one.
    Raises ValueError if a design has no solution.
    """
    tables = tables_of(scenario)
    legend = Legend()
    _timing(legend, scenario, tables)
    _model(legend, tables)
    _gains(legend, scenario, tables)
    _observer(legend, scenario, tables)
    _stiffness_loop(legend, scenario, tables)
    return {
        "format": "VSSEA controller",
        "schema_version": SCHEMA_VERSION,
        "software_version": __version__,
        "scenario": scenario.name,
        **legend.values,
        "order_of_tick": order_of_tick(scenario.tuning, predicts=tables.predicts),
        "units": legend.units,
        "meanings": legend.meanings,
        "tuning": scenario.tuning.model_dump(mode="json"),
    }


def _timing(legend: Legend, scenario: Scenario, tables: Tables) -> None:
    timing = scenario.timing
    legend.put("timing.T", timing.sample_time_s, "s", "sample time")
    legend.put("timing.compute_delay", timing.compute_delay_samples, "samples", "from measurement to torque")
    legend.put("timing.predict", tables.predicts, "", "whether the law acts on the state one sample ahead")


def _model(legend: Legend, tables: Tables) -> None:
    law = tables.law
    legend.put("model.J_l", law.link_inertia, "kg m^2", "link inertia, Eq. (1)")
    legend.put("model.b_l", law.link_damping, "N m s/rad", "link damping, Eq. (1)")
    legend.put("model.J_e", law.motor_inertia, "kg m^2", "motor and gear inertia at the gear side, Eq. (1)")
    legend.put("model.b_e", law.motor_damping, "N m s/rad", "motor damping at the gear side, Eq. (1)")
    legend.put("model.Y_tau", law.spring_constant, "N m rad^3", "spring constant, Eq. (3)")
    legend.put("model.J_ms", law.stiffness_inertia, "kg m^2", "stiffness motor inertia, Eq. (2)")
    legend.put("model.b_ms", law.stiffness_damping, "N m s/rad", "stiffness motor damping, Eq. (2)")


def _gains(legend: Legend, scenario: Scenario, tables: Tables) -> None:
    controller, gains = scenario.tuning.controller, tables.gains
    legend.put("controller", controller.kind, "", "state_feedback (9), sliding_mode (16) or baseline (Fig. 2)")
    legend.put("gains.k", tables.stiffnesses, "N m/rad", "stiffness of each row; one row: the gains are constant")
    legend.put("gains.ln_k_first", tables.first_ln_k, "", "ln of the first k of a table")
    legend.put("gains.rows_per_ln_k", tables.rows_per_ln_k, "", "rows for each unit of ln k")
    if controller.kind == "baseline":
        units = "N m/rad, N m s/rad, N m/rad, N m s/rad"
        legend.put("gains.Kx", gains[:, 7:11], units, "u = -Kx [theta_l omega_l theta_e omega_e]' + N_r r")
        legend.put("gains.N_r", gains[:, 11], "N m/rad", "prefilter, -1/(C (A - B Kx)^-1 B)")
    if controller.kind == "state_feedback":
        legend.put("gains.K", gains[:, :4], "1/s^4, 1/s^3, 1/s^2, 1/s", "k1..k4 of Eq. (9)")
    legend.put("gains.S", gains[:, 4:7], "1/s^3, 1/s^2, 1/s", "s1..s3 of Eq. (14): sigma = s1 e1 + s2 e2 + s3 e3 + e4")
    if not isinstance(controller, SlidingMode):
        return
    legend.put("switching.switch", controller.switch, "", "layer: saturation; tanh; super_twisting; sgn. Eq. (16)")
    if controller.switch != "super_twisting":
        legend.put("switching.rho", controller.switching_gain, "rad/s^4", "switching gain, Eq. (16)")
        if controller.switch != "sgn":
            legend.put("switching.phi", controller.layer_width, "rad/s^3", "boundary layer of sigma")
    else:
        legend.put("switching.L", controller.twisting_gain, "rad/s^5", "super-twisting gain")


def _observer(legend: Legend, scenario: Scenario, tables: Tables) -> None:
    observer = scenario.tuning.observer
    legend.put("observer.form", observer.kind, "", "velocity (20)-(24), position, or off")
    if observer.kind != "position":
        legend.put("observer.velocity_source", observer.velocity_source, "", "measured, or difference of positions")
        if observer.velocity_source == "difference":
            form = "omega+ = keep omega + gain (theta+ - theta)"
            legend.put("observer.keep", tables.law.difference_keep, "", form)
            legend.put("observer.gain", tables.law.difference_gain, "1/s", form)
    channels = {"stiffness": tables.stiffness[None]}
    if observer.kind != "off":
        channels = {"link": tables.link, "motor": tables.motor} | channels
    for channel, rows in channels.items():
        put = _position_matrices if observer.kind == "position" else _velocity_matrices
        put(legend, f"observer.{channel}", rows, scenario.timing.sample_time_s)


def _velocity_matrices(legend: Legend, name: str, rows: Numbers, _: float) -> None:
    """Put A (n, 3, 3), h, b0, b1 (n, 3)."""
    form = "d+ = A d + h (omega+ - omega) + b0 f0 + b1 f1 with d = [d d' d'']', Eq. (22)"
    values = rows[:, VELOCITY_NUMBERS]
    legend.put(f"{name}.A", values[:, :9].reshape(-1, 3, 3), "1, s, s^2 and inverses", form)
    for place, part, unit in ((9, "h", "1/s, 1/s^2, 1/s^3"), (12, "b0", "1, 1/s, 1/s^2"), (15, "b1", "1, 1/s, 1/s^2")):
        legend.put(f"{name}.{part}", values[:, place : place + 3], unit, form)


def _position_matrices(legend: Legend, name: str, rows: Numbers, t: float) -> None:
    """Put A (n, 5, 5), B0, B1, M (n, 5)."""
    form = "x- = A x + B0 phi0 + B1 phi1; x = x- + M (theta - x-[0]) with x = [theta omega d d' d'']'"
    values, n = rows[:, POSITION_NUMBERS], len(rows)
    a, b0, b1 = np.zeros((n, 5, 5)), np.zeros((n, 5)), np.zeros((n, 5))
    a[:, 0, 0] = a[:, 2, 2] = a[:, 3, 3] = a[:, 4, 4] = 1.0
    a[:, 0, 1:], a[:, 1, 1:] = values[:, :4], values[:, 4:8]
    a[:, 2, 3] = a[:, 3, 4] = t
    a[:, 2, 4] = 0.5 * t * t
    b0[:, 0], b1[:, 0], b0[:, 1], b1[:, 1] = values[:, 8], values[:, 9], values[:, 10], values[:, 11]
    legend.put(f"{name}.A", a, "1, s ... s^4", form)
    legend.put(f"{name}.B0", b0, "s^2, s, 1, 1/s, 1/s^2", form)
    legend.put(f"{name}.B1", b1, "s^2, s, 1, 1/s, 1/s^2", form)
    legend.put(f"{name}.M", values[:, 12:], "1, 1/s, 1/s^2, 1/s^3, 1/s^4", form)


def _stiffness_loop(legend: Legend, scenario: Scenario, tables: Tables) -> None:
    law, loop = tables.law, scenario.tuning.stiffness_loop
    form = "Eq. (19) with what it lacks: tau_ms = J_ms (r'' + d_ms) + K_p (r - theta_ms) + K_d (r' - omega_ms) + b_ms r' + tau_back"
    legend.put("stiffness_loop.K_p", law.stiffness_inertia * law.stiffness_p, "N m/rad", form)
    legend.put("stiffness_loop.K_d", law.stiffness_inertia * law.stiffness_d - law.stiffness_damping, "N m s/rad", form)
    legend.put("stiffness_loop.w2", law.stiffness_p, "1/s^2", "w^2 = K_p / J_ms")
    legend.put("stiffness_loop.two_zeta_w", law.stiffness_d, "1/s", "2 zeta w = (K_d + b_ms) / J_ms")
    legend.put("stiffness_loop.rate_share", law.rate_share, "", "1: tau_s' with its theta_ms' term")
    legend.put("stiffness_loop.moving_share", law.moving_share, "", "1: R with its theta_ms terms")
    legend.put(
        "stiffness_loop.reference_pole", loop.reference_bandwidth, "rad/s", "triple pole of the reference's filter"
    )
    low, high = scenario.actuator.stiffness.softest, scenario.actuator.stiffness.stiffest
    positions = [math.cbrt(law.spring_constant / (2.0 * k)) for k in (high, low)]
    legend.put("stiffness_loop.theta_ms_range", positions, "rad", "stiffest and softest position")
