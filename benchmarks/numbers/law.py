"""Section 2: the laws, the terms of a moving stiffness, sampling, and both kinds of literal implementation."""

from dataclasses import replace

import numpy as np
from scipy.linalg import expm

from benchmarks.numbers.setting import error_and_chatter, sine_scenario, unlimited_motor
from benchmarks.numbers.table import PRODUCT, Line, mrad, rms, settled
from tests.core.as_reference import reference_config
from tests.reference.closed_loop import simulate as reference_simulate
from tests.reference.parameters import Config, Controller, Limits, StiffnessReference, Term
from vssea_core.actuator.parameters import Actuator, Timing
from vssea_core.analysis.sampled_loop import closed_loop_matrix
from vssea_core.control.design import state_feedback_gains
from vssea_core.control.tuning import SlidingMode, StateFeedback, StiffnessLoop, Tuning
from vssea_core.scenario import Initial, Scenario
from vssea_core.signals.documents import (
    ConstantDisturbance,
    ConstantStiffness,
    Disturbances,
    MoveStiffness,
    StepReference,
)
from vssea_core.simulation.run import simulate

UNLIMITED = 1e4  # N m, the largest peak torque the document permits


def moving_stiffness() -> list[Line]:
    """k 1000 -> 20 in 0.5 s under 5 N m, with fewer and fewer of the theta_ms terms."""
    lines = []
    for terms, expected, words in (("none", "330 / 1572", "no theta_ms term"), ("rate", "74 / 800", "tau_s' only")):
        peaks = [_reference_move(pole, terms) for pole in (20.0, 8.0)]
        how = f"by the reference with stiffness_terms={terms!r}, stiffness filter 60 rad/s"
        lines.append(Line(f"k 1000 to 20, {words}, p 20 / p 8: peak error", f"{expected} mrad", _pair(peaks), how))
    peaks = [_reference_move(pole, "all") for pole in (20.0, 8.0)]
    how = "by the reference, stiffness filter 60 rad/s, no slew limit"
    lines.append(Line("k 1000 to 20, every term, p 20 / p 8: peak error", "0.7 / 12 mrad", _pair(peaks), how))
    peaks = [_product_move(pole) for pole in (20.0, 8.0)]
    how = f"{PRODUCT}, filter 60 rad/s; its own limits of the change's rate and speed act"
    lines.append(Line("the same move as the product permits it", "-", _pair(peaks), how))
    return lines


def _pair(peaks: list[float]) -> str:
    return f"{1e3 * peaks[0]:.3g} / {1e3 * peaks[1]:.3g} mrad"


def _reference_move(pole: float, terms: str) -> float:
    config = Config(
        controller=Controller(stiffness_terms=terms, pole=pole),  # type: ignore[arg-type]
        stiffness=StiffnessReference(1000.0, 20.0, start_s=1.0, duration_s=0.5, filter_bandwidth=60.0),
        link_disturbance=(Term(5.0),),
        duration_s=4.0,
        integrator="rk",
    )
    deflection = 2.0 * np.arcsin(
        5.0 * config.plant.stiffness_motor_position(1000.0) ** 3 / config.plant.spring_constant
    )
    run = reference_simulate(replace(config, initial_state=(0.0, 0.0, deflection, 0.0), initial_torque=5.0))
    return float(np.abs(run["tracking_error"]).max())


def _product_move(pole: float) -> float:
    loop = StiffnessLoop(reference_bandwidth=60.0, torque_reserve=1e6)
    scenario = Scenario(
        actuator=Actuator(motor=unlimited_motor(UNLIMITED)),
        tuning=Tuning(controller=StateFeedback(natural_frequency=pole), stiffness_loop=loop),
        reference=StepReference(origin=0.0, target=0.0),
        stiffness_reference=MoveStiffness(stiffness=1000.0, target=20.0, start_s=1.0, duration_s=0.5),
        disturbances=Disturbances(link=(ConstantDisturbance(torque=5.0),)),
        duration_s=4.0,
    )
    return float(np.abs(simulate(scenario)["error"]).max())


def sampling() -> list[Line]:
    """The quadruple pole at 1 ms, and how little of it the response shows."""
    tuning = Tuning(controller=StateFeedback(natural_frequency=8.0))
    multipliers = np.linalg.eigvals(closed_loop_matrix(tuning, Timing(), 0.0, 1000.0)).astype(complex)
    poles = np.log(multipliers[np.abs(multipliers) > 1e-6]) / 1e-3
    slow = sorted((pole for pole in poles if abs(pole) < 60.0 and pole.imag > -1e-6), key=lambda pole: -pole.real)
    shown = ", ".join(f"{p.real:.1f} ± {p.imag:.1f}j" if p.imag > 0.1 else f"{p.real:.1f}" for p in slow)
    scenario = Scenario(
        actuator=Actuator(motor=unlimited_motor(UNLIMITED)),
        tuning=tuning,
        reference=StepReference(origin=0.0, target=0.0),
        stiffness_reference=ConstantStiffness(stiffness=1000.0),
        initial=Initial(link_position=1.0),
        duration_s=2.0,
    )
    closed = np.diag(np.ones(3), 1)
    closed[3] -= state_feedback_gains(8.0, 1.0)
    step, state, ideal = expm(closed * 1e-3), np.array([-1.0, 0.0, 0.0, 0.0]), []
    for _ in range(2000):
        ideal.append(state[0])
        state = step @ state
    moved = np.abs(simulate(scenario)["error"] - ideal).max()
    return [
        Line("p 8 x4, k 1000, sampled at 1 ms: poles", "-4.1, -4.4 ± 4.7j, -24.6", shown, PRODUCT),
        Line("its step response against the continuous one", "1.6 %", f"{100.0 * moved:.2g} %", PRODUCT),
    ]


def literal_torque() -> list[Line]:
    """The previous sample's torque inside Pi_2'', and the unlimited torque fed to the observer."""
    how = "by the reference with algebraic_loop='previous'"
    unlimited = replace(
        reference_config(sine_scenario(Tuning(), peak_torque=UNLIMITED)), duration_s=0.02, integrator="rk"
    )
    literal = replace(unlimited.controller, algebraic_loop="previous")
    free = replace(unlimited, controller=literal, limits=Limits(peak_torque=1e9))
    state = reference_simulate(free)
    size = np.abs(state["state"][:, :4]).max(axis=1)
    left = f"{np.argmax(size > 1e3)} ms" if np.any(size > 1e3) else f"not in {len(size)} ms"
    lines = [Line("previous u, unlimited: leaves 1e3 (rad, rad/s) within", "7 ms", left, how)]
    found = []
    for stiffness in (50.0, 200.0):
        config = replace(reference_config(sine_scenario(Tuning(), stiffness)), integrator="rk", duration_s=8.0)
        run = reference_simulate(replace(config, controller=literal))
        error, torque = (settled(run["t"], run[name]) for name in ("tracking_error", "torque_applied"))
        found.append((rms(np.diff(torque)), rms(error)))
    chatter, errors = (" / ".join(f"{scale * pair[i]:.3g}" for pair in found) for i, scale in ((0, 1.0), (1, 1e3)))
    lines.append(Line("previous u, 74 N m, p 20, k 50 / 200: chatter", "139 N m a sample", f"{chatter} N m", how))
    how += "; its case is not stated"
    lines.append(Line("previous u, 74 N m, p 20, k 50 / 200: RMS error", "0.6-25 mrad", f"{errors} mrad", how))

    scenario = Scenario(
        actuator=Actuator(motor=unlimited_motor()),
        reference=StepReference(origin=0.0, target=1.0, repeat=False, start_s=0.0),
        duration_s=3.5,
    )
    config = replace(reference_config(scenario), integrator="rk")
    fed = replace(config, controller=replace(config.controller, torque_feed="commanded"))
    off = abs(reference_simulate(fed)["tracking_error"][3000])
    how = "by the reference with torque_feed='commanded'"
    lines.append(Line("raw 1 rad step, p 20, unlimited torque fed: error at 3 s", "0.3 rad", f"{off:.2g} rad", how))
    off = abs(simulate(scenario)["error"][3000])
    return [*lines, Line("the same, applied torque fed", "-", mrad(off), PRODUCT)]


def sliding_mode() -> list[Line]:
    """Switching: error and chatter. The sgn start saturates at 74 N m, so it is also given from 5 s on."""
    lines = []
    for words, law, expected in (
        ("sgn, rho 500", SlidingMode(switch="sgn", switching_gain=500.0), "0.03 mrad, 1.6 N m"),
        ("sgn, rho 5e4", SlidingMode(switch="sgn", switching_gain=5e4), "137 N m"),
        ("layer, rho 5e4, phi 500", SlidingMode(), "0.06 mrad, 0.01 N m"),
    ):
        found = []
        for peak, from_s in ((74.0, 4.0), (74.0, 5.0), (UNLIMITED, 4.0)):
            run = simulate(sine_scenario(Tuning(controller=law), peak_torque=peak))
            error, chatter = error_and_chatter(run, from_s)
            found.append(f"{mrad(error)}, {chatter:.2g} N m")
        how = f"{PRODUCT}: 74 N m from 4 s; from 5 s; without torque limit"
        lines.append(Line(f"sliding mode, {words}: RMS error, chatter", expected, "; ".join(found), how))
    return lines


SECTIONS = (moving_stiffness, sampling, literal_torque, sliding_mode)
