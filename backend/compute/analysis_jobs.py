"""Analyses as the workers run them: a request in, JSON out."""

import json
import math
from collections.abc import Callable, Sequence
from typing import Any

from backend.compute.requests import BandwidthRequest, LoopRequest, MapRequest, WorstCaseRequest
from vssea_core.actuator.sensors import encoders
from vssea_core.analysis.axes import changed
from vssea_core.analysis.bandwidth_sets import LeastMargins, bandwidth_sets
from vssea_core.analysis.certify import certify
from vssea_core.analysis.error_bound import error_bound
from vssea_core.analysis.loop import loop_model
from vssea_core.analysis.maps import map_axis, margin_map, stability_map
from vssea_core.analysis.noise import observer_figures
from vssea_core.analysis.operating_point import LinearPlant, OperatingPoint, note_on_linearity
from vssea_core.analysis.poles import poles
from vssea_core.analysis.robustness import robustness
from vssea_core.analysis.sensitivities import sensitivities
from vssea_core.analysis.warning import warning
from vssea_core.analysis.worst_case import worst_case
from vssea_core.scenario import Scenario
from vssea_core.signals.documents import LinkDisturbance


def operating_point(scenario: Scenario, stiffness: float | None = None, plant: str = "model") -> OperatingPoint:
    """Return where the loop of `scenario` is analysed: at `stiffness` [N m/rad], or at the one it is commanded to go to."""
    reference = scenario.stiffness_reference
    commanded = reference.target if reference.kind == "move" else reference.stiffness
    motor = scenario.actuator.motor
    true = (
        LinearPlant.of_actuator(scenario.actuator)
        if plant == "actuator"
        else LinearPlant.of_model(scenario.tuning, motor.torque_lag_s, motor.torque_delay_s)
    )
    return OperatingPoint(scenario.tuning, scenario.timing, stiffness or commanded, true)


def margins_of(scenario: Scenario) -> dict[str, Any]:
    """Return what the page shows beside a tuning: poles, margins, ranges of the true plant, warning, figures."""
    point = operating_point(scenario)
    try:
        note = note_on_linearity(point.tuning)
    except ValueError as none:
        return {"stiffness": point.stiffness, "available": False, "reason": str(none)}
    found = robustness(point)
    loop = loop_model(point)
    danger = warning(found)
    figures = observer_figures(loop, encoders(scenario.sensors, scenario.actuator.motor)) if loop.stable else None
    return {
        "stiffness": point.stiffness,
        "available": True,
        "stable": loop.stable,
        "note": note,
        "sample_time_s": point.period_s,
        "poles": poles(loop).document(),
        "robustness": found.document(),
        "warning": danger.document() if danger else None,
        "figures": figures.document() if figures else None,
        "true": _true_factors(scenario),
    }


def _true_factors(scenario: Scenario) -> dict[str, float]:
    """Return true / nominal of what the ranges are about, as the simulated actuator has it."""
    model, actuator = scenario.tuning.model, scenario.actuator
    return {
        "link_inertia": actuator.link.inertia / model.link_inertia,
        "motor_inertia": actuator.motor.inertia / model.motor_inertia,
        "spring_constant": actuator.stiffness.spring_constant / model.spring_constant,
    }


def analyse_loop(asked: LoopRequest) -> bytes:
    """Return the whole report of one loop as JSON. Raises ValueError if the controller has no linear loop."""
    scenario = asked.scenario or Scenario()
    point = operating_point(scenario, asked.stiffness, asked.plant)
    loop = loop_model(point)
    found = robustness(point)
    danger = warning(found)
    report: dict[str, Any] = {
        "scenario": scenario.name,
        "stiffness": point.stiffness,
        "plant": asked.plant,
        "sample_time_s": point.period_s,
        "compute_delay_samples": point.timing.compute_delay_samples,
        "stable": loop.stable,
        "note": loop.note,
        "states": list(loop.states),
        "poles": poles(loop).document(),
        "robustness": found.document(),
        "warning": danger.document() if danger else None,
        "true": _true_factors(scenario),
        "error_bound": _error_bound(scenario, point, asked),
        "sensitivities": None,
        "figures": None,
    }
    if loop.stable:
        report["sensitivities"] = sensitivities(loop).document()
        report["figures"] = observer_figures(loop, encoders(scenario.sensors, scenario.actuator.motor)).document()
    return _json(report)


def _error_bound(scenario: Scenario, point: OperatingPoint, asked: LoopRequest) -> dict[str, Any] | None:
    link, motor = scenario.disturbances.link, scenario.disturbances.motor
    found = error_bound(
        point.tuning,
        point.period_s,
        point.stiffness,
        jerk_of_sines(link) if asked.link_jerk is None else asked.link_jerk,
        jerk_of_sines(motor) if asked.motor_jerk is None else asked.motor_jerk,
    )
    return found.document() if found else None


def jerk_of_sines(terms: Sequence[LinkDisturbance]) -> float:
    """Return the largest third derivative [N m/s^3] that the sines of a disturbance can add up to."""
    jerk = 0.0
    for term in terms:
        parts = (term,) if term.kind == "sine" else term.components if term.kind == "multisine" else ()
        jerk += sum(part.amplitude * (2.0 * math.pi * part.frequency_hz) ** 3 for part in parts)
    return jerk


def analysis_task(asked: MapRequest | BandwidthRequest | WorstCaseRequest, progress: Callable[..., bool]) -> bytes:
    """Return the result of a long analysis as JSON. Raises ValueError if what is asked makes no sense."""
    point = operating_point(asked.scenario or Scenario(), asked.stiffness, asked.plant)
    about = {"kind": asked.kind, "stiffness": point.stiffness, "plant": asked.plant}
    if isinstance(asked, MapRequest):
        x, y = (map_axis(axis.name, axis.count, axis.low, axis.high) for axis in (asked.x, asked.y))
        draw = stability_map if asked.kind == "stability_map" else margin_map
        return _json(about | draw(point, x, y, progress).document())
    if isinstance(asked, BandwidthRequest):
        least = LeastMargins(**asked.least.model_dump())
        sets = bandwidth_sets(point, asked.stiffnesses, asked.mismatches, least, asked.low, asked.high, progress)
        return _json(about | sets.document())
    found = worst_case(point, asked.box, asked.criterion, progress=progress)
    answer = about | found.document()
    if asked.certify:
        progress(0.99, "simulating the nonlinear plant there")
        answer["certificate"] = certify(changed(point, found.values)).document()
    return _json(answer)


def _json(answer: dict[str, Any]) -> bytes:
    return json.dumps(answer, ensure_ascii=False, allow_nan=False).encode()
