"""The paper's sentences hold for our numbers, and each of them fails when what it speaks of is broken."""

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
from scipy.signal import lti

from vssea_core.control.tuning import Baseline, NoObserver, StateFeedback
from vssea_core.paper.claim import Claim, Number, Run, Runs, Verdict, judge, run_all, with_unit
from vssea_core.paper.claims import CLAIMS
from vssea_core.paper.disturbance_rates import load_and_rates
from vssea_core.paper.measures import LINK_ESTIMATES, MOTOR_ESTIMATES, compliance, estimate_error, rms_error, settled
from vssea_core.paper.scenarios import paper_scenarios
from vssea_core.scenario import Scenario
from vssea_core.signals.documents import (
    ConstantDisturbance,
    MultisineDisturbance,
    PendulumDisturbance,
    SineDisturbance,
    TorqueComponent,
)

SCENARIOS = paper_scenarios()
BY_NAME = {claim.name: claim for claim in CLAIMS}


@pytest.fixture(scope="module")
def runs() -> dict[str, Run]:
    return run_all(SCENARIOS, lambda share, name: None)


def verdict_with(scenarios: Mapping[str, Scenario], claim: Claim) -> Verdict:
    used = {name: scenarios[name] for name in claim.scenarios}
    return judge([claim], run_all(used, lambda share, name: None))[0]


@pytest.mark.parametrize("claim", CLAIMS, ids=lambda claim: claim.name)
def test_each_claim_holds(claim: Claim, runs: Runs) -> None:
    (verdict,) = judge([claim], runs)
    assert verdict.passed, [
        (number.label, number.text, number.criterion) for number in verdict.numbers if not number.met
    ]


def test_the_numbers_that_were_expected_come_out(runs: Runs) -> None:
    """The independently computed figures of the parameter set, to the digits they were stated with."""
    found = {claim.name: {n.label: n.value for n in judge([claim], runs)[0].numbers} for claim in CLAIMS[:3]}
    sensitive, robust, slower = found.values()
    assert sensitive["RMS error, regulation"] == pytest.approx(11.0, abs=0.5)
    assert sensitive["peak torque, regulation"] == pytest.approx(713.0, abs=0.5)
    assert sensitive["RMS error, regulation, 74 N·m limit"] == pytest.approx(4.0, abs=0.5)
    assert slower["rise time, poles"] == pytest.approx(0.61, abs=0.005)
    assert robust["RMS error with LQR, regulation"] == pytest.approx(0.14, abs=0.005)
    assert slower["rise time, LQR"] == pytest.approx(0.81, abs=0.005)


def changed(scenario: Scenario, path: str, value: Any) -> Scenario:
    """`scenario` with one value of its document replaced, and checked again as a whole."""
    document = scenario.model_dump(mode="json")
    *parents, name = path.split(".")
    part = document
    for parent in parents:
        part = part[parent]
    part[name] = value
    return Scenario.model_validate(document)


def everywhere(path: str, value: Any, where: str = "") -> Callable[[dict[str, Scenario]], dict[str, Scenario]]:
    def breaking(scenarios: dict[str, Scenario]) -> dict[str, Scenario]:
        return {n: changed(s, path, value) if n.startswith(where) else s for n, s in scenarios.items()}

    return breaking


def as_poles(scenarios: dict[str, Scenario]) -> dict[str, Scenario]:
    """The LQR's panels with the controller of pole placement."""
    return {name: scenarios[name.replace("fig2b", "fig2a").replace("_faster", "")] for name in scenarios}


SLOW_OBSERVER = everywhere("tuning.observer.bandwidth", 4.0, "fig3")
SLOW_ON_RIG = everywhere("tuning.observer.bandwidth", 12.0, "fig4")
BREAKING: dict[str, Callable[[dict[str, Scenario]], dict[str, Scenario]]] = {
    "poles_sensitive": everywhere("tuning.controller", Baseline(design="lqr_plant").model_dump(), "fig2a"),
    "lqr_less_sensitive": as_poles,
    "lqr_slower": as_poles,
    "observer_removes_error_poles": SLOW_OBSERVER,
    "observer_removes_error_lqr": SLOW_OBSERVER,
    "response_kept_poles": everywhere("tuning.model.link_inertia", 0.2, "fig3"),
    "response_kept_lqr": everywhere("tuning.controller.torque_weight", 0.5, "fig3"),
    "estimates_d": SLOW_OBSERVER,
    "estimates_d1": SLOW_OBSERVER,
    "estimates_d2": SLOW_OBSERVER,
    "state_feedback_follows_nominal": SLOW_ON_RIG,
    "sliding_mode_follows_nominal": SLOW_ON_RIG,
    "state_feedback_follows_on_rig": SLOW_ON_RIG,
    "sliding_mode_follows_on_rig": everywhere("tuning.controller.switch", "sgn", "fig4b"),
    "follows_at_each_stiffness": SLOW_ON_RIG,
    "response_preserved": everywhere("tuning.schedule.poles_exponent", 0.5, "fig3"),
    "lqr_for_performance": SLOW_OBSERVER,
}


def test_every_claim_has_a_way_to_fail() -> None:
    assert list(BREAKING) == list(BY_NAME)
    assert [claim.number for claim in CLAIMS] == list(range(1, 18))


@pytest.mark.parametrize("name", BREAKING)
def test_a_claim_fails_when_what_it_speaks_of_is_broken(name: str) -> None:
    claim = BY_NAME[name]
    used = {known: scenario for known, scenario in SCENARIOS.items() if known in claim.scenarios or "fig2a" in known}
    assert not verdict_with(BREAKING[name](used), claim).passed


def test_a_run_that_breaks_off_fails_its_claim_and_says_why() -> None:
    overloaded = [ConstantDisturbance(torque=200.0, start_s=3.5).model_dump()]
    verdict = verdict_with(everywhere("disturbances.link", overloaded)(dict(SCENARIOS)), BY_NAME["estimates_d"])
    assert not verdict.passed
    assert "fig3a_poles_regulation stopped at t = 3." in str(verdict.ending)


def test_a_number_that_could_not_be_measured_meets_no_limit() -> None:
    assert not Number("n", math.nan, "s", "at most", 1.0).met
    assert not Number("n", math.nan, "s", "at least", 1.0).met
    assert Number("n", math.nan, "s").met


@pytest.mark.parametrize(
    ("value", "text"), [(713.28, "713 N·m"), (27337.0, "27300 N·m"), (0.0026712, "0.00267 N·m"), (-1.5, "-1.5 N·m")]
)
def test_numbers_are_shown_to_three_digits(value: float, text: str) -> None:
    assert with_unit(value, "N·m") == text


@pytest.mark.parametrize("name", SCENARIOS)
def test_each_scenario_is_a_document_that_the_product_accepts(name: str) -> None:
    scenario = SCENARIOS[name]
    assert scenario.name == name
    assert Scenario.model_validate_json(scenario.model_dump_json()) == scenario


def test_figs_2_and_3_differ_in_the_observer_and_the_form_of_the_same_design() -> None:
    for without, robust in (("fig2a", "fig3a_poles"), ("fig2b", "fig3a_lqr")):
        for task in ("regulation", "tracking"):
            a, b = SCENARIOS[f"{without}_{task}"], SCENARIOS[f"{robust}_{task}"]
            assert isinstance(a.tuning.observer, NoObserver)
            assert isinstance(a.tuning.controller, Baseline)
            assert isinstance(b.tuning.controller, StateFeedback)
            same = {"tuning": a.tuning, "name": a.name}
            assert b.model_copy(update=same) == a


CHANNELS = [("link", name, order) for order, name in enumerate(LINK_ESTIMATES)]
CHANNELS += [("motor", name, order) for order, name in enumerate(MOTOR_ESTIMATES)]


@pytest.mark.parametrize(("side", "channel", "order"), CHANNELS)
def test_errors_of_the_estimates_are_those_of_the_observers_transfer_functions(
    side: str, channel: str, order: int, runs: Runs
) -> None:
    """Theory, section 3: from d to its estimates, with D = (s + g)^3."""
    run, g = runs["fig3a_poles_regulation"], 200.0
    numerators = ([3 * g, 3 * g**2, g**3], [3 * g**2, g**3, 0.0], [g**3, 0.0, 0.0])
    denominator = np.poly([-g, -g, -g])
    time = settled(run, run["time"])
    error, signal = np.zeros(len(time)), np.zeros(len(time))
    for term in getattr(run.scenario.disturbances, side):
        if term.kind == "constant":
            signal += term.torque if order == 0 else 0.0
            continue
        w = 2.0 * math.pi * term.frequency_hz
        _, gain = lti(numerators[order], denominator).freqresp([w])
        turning = term.amplitude * np.exp(1j * (w * time + term.phase))
        signal += ((1j * w) ** order * turning).imag
        error += ((gain[0] - (1j * w) ** order) * turning).imag
    wrong, right = float(np.sqrt(np.mean(error**2))), float(np.sqrt(np.mean(signal**2)))
    assert estimate_error(run, channel) == pytest.approx(wrong / right, rel=0.02, abs=3e-6)


def test_a_steady_load_moves_the_link_as_far_as_the_compliance_says() -> None:
    for panel in ("fig2a", "fig2b"):
        load = [ConstantDisturbance(torque=0.1, start_s=1.0).model_dump()]
        quiet = changed(changed(SCENARIOS[f"{panel}_regulation"], "disturbances.motor", []), "reference.target", 0.0)
        run = run_all({"run": changed(quiet, "disturbances.link", load)}, lambda share, name: None)["run"]
        assert abs(run["link_position"][-1]) == pytest.approx(0.1 * compliance(run), rel=2e-3)


def test_inside_its_layer_the_sliding_mode_is_the_state_feedback_with_the_gain_of_the_layer() -> None:
    """Surface poles of -20 and rho/phi = 20/s: the quadruple pole of Fig. 4a, so neither law is the better one."""
    gentle = changed(SCENARIOS["fig4b_tracking"], "tuning.controller.switching_gain", 1e4)
    runs = run_all({"a": SCENARIOS["fig4a_tracking"], "b": gentle}, lambda share, name: None)
    assert rms_error(runs["b"]) == pytest.approx(rms_error(runs["a"]), rel=1e-2)


def test_rates_are_the_derivatives_of_the_load() -> None:
    terms = (
        ConstantDisturbance(torque=3.0, start_s=0.5),
        SineDisturbance(amplitude=2.0, frequency_hz=1.5, phase=0.3, start_s=0.2, end_s=2.0),
        MultisineDisturbance(components=(TorqueComponent(amplitude=1.0, frequency_hz=0.7, phase=0.1),)),
    )
    time = np.linspace(0.6, 1.9, 2001)
    load, rate, acceleration = load_and_rates(terms, time)
    step = time[1] - time[0]
    assert np.allclose(np.gradient(load, step)[5:-5], rate[5:-5], atol=1e-3)
    assert np.allclose(np.gradient(rate, step)[5:-5], acceleration[5:-5], atol=1e-2)
    before, after = load_and_rates(terms[1:2], np.array([0.1, 2.1]))[0]
    assert before == after == 0.0


def test_a_load_that_depends_on_the_link_has_no_rates_here() -> None:
    with pytest.raises(ValueError, match="a pendulum disturbance has no rates here; expected constant, sine"):
        load_and_rates((PendulumDisturbance(),), np.zeros(1))
