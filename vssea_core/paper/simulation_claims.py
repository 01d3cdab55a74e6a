"""The paper's sentences on its simulations: Figs. 2 and 3."""

from collections.abc import Callable
from functools import partial

from vssea_core.paper.claim import Claim, Number, Runs
from vssea_core.paper.measures import (
    compliance,
    difference,
    effect_of_disturbance,
    estimate_error,
    onset_error,
    peak_error,
    peak_torque,
    rise_time,
    rms_error,
    settling_time,
)
from vssea_core.paper.scenarios import TASKS, TORQUE_WEIGHTS

MILLI = 1e3
PANEL = {"poles": "fig2a", "lqr": "fig2b"}
WORDS = {"poles": "pole placement", "lqr": "the LQR"}


def _pairs(*panels: str) -> tuple[str, ...]:
    return tuple(f"{panel}_{task}{suffix}" for panel in panels for task in TASKS for suffix in ("", "_undisturbed"))


def _effect(runs: Runs, panel: str, task: str) -> float:
    return effect_of_disturbance(runs[f"{panel}_{task}"], runs[f"{panel}_{task}_undisturbed"])


def _sensitive(runs: Runs) -> tuple[Number, ...]:
    free, limited = runs["fig2a_regulation"], runs["fig2a_regulation_limited"]
    effects = {task: _effect(runs, "fig2a", task) for task in TASKS}
    return (
        *(Number(f"what the disturbances change, {task}", effect, "rad", "at least", 1.0) for task, effect in effects.items()),
        Number("RMS error, regulation", rms_error(free), "rad"),
        Number("peak torque, regulation", peak_torque(free), "N·m"),
        Number("RMS error, regulation, 74 N·m limit", rms_error(limited), "rad"),
        Number("moved by a steady load", compliance(free), "rad/(N·m)"),
    )  # fmt: skip


def _less_sensitive(runs: Runs) -> tuple[Number, ...]:
    ratios = {task: _effect(runs, "fig2a", task) / _effect(runs, "fig2b", task) for task in TASKS}
    regulated = runs["fig2b_regulation"]
    return (
        *(Number(f"poles / LQR, {task}", ratio, "", "at least", 5.0) for task, ratio in ratios.items()),
        Number("RMS error with LQR, regulation", rms_error(regulated), "rad"),
        Number("peak torque with LQR, regulation", peak_torque(regulated), "N·m"),
        Number("moved by a steady load, LQR", compliance(regulated), "rad/(N·m)"),
    )


def _slower(runs: Runs) -> tuple[Number, ...]:
    poles, lqr, faster = (runs[f"fig2{name}"] for name in ("a_regulation", "b_regulation", "b_regulation_faster"))
    return (
        Number("rise time LQR / poles", rise_time(lqr) / rise_time(poles), "", "at least", 1.1),
        Number("rise time, poles", rise_time(poles), "s"),
        Number("rise time, LQR", rise_time(lqr), "s"),
        Number("settling time (2 %), poles", settling_time(poles), "s"),
        Number("settling time (2 %), LQR", settling_time(lqr), "s"),
        Number("rise time, LQR with torque weight 0.03", rise_time(faster), "s"),
        Number("RMS error, LQR with torque weight 0.03", rms_error(faster), "rad"),
    )


def _removed(runs: Runs, design: str) -> tuple[Number, ...]:
    without, robust = PANEL[design], f"fig3a_{design}"
    ratios = {task: _effect(runs, without, task) / _effect(runs, robust, task) for task in TASKS}
    free, limited = runs[f"{robust}_regulation"], runs[f"{robust}_regulation_limited"]
    return (
        *(Number(f"what they change, without / with, {task}", ratio, "", "at least", 50.0) for task, ratio in ratios.items()),
        *(
            Number(f"largest error with it, {task}", MILLI * peak_error(runs[f"{robust}_{task}"]), "mrad", "at most", 20.0)
            for task in TASKS
        ),
        Number("RMS error with it, regulation", MILLI * rms_error(free), "mrad"),
        Number("peak torque with it, regulation", peak_torque(free), "N·m"),
        Number("RMS error with it, regulation, 74 N·m limit", MILLI * rms_error(limited), "mrad"),
        Number("largest error from 3 s on with it, regulation, 74 N·m limit", MILLI * onset_error(limited), "mrad"),
    )  # fmt: skip


def _kept(runs: Runs, design: str) -> tuple[Number, ...]:
    without, robust = (runs[f"{panel}_regulation_undisturbed"] for panel in (PANEL[design], f"fig3a_{design}"))
    longer = abs(rise_time(robust) - rise_time(without))
    return (
        Number("largest difference of the step responses", MILLI * difference(without, robust), "mrad", "at most", 1.0),
        Number("difference of the rise times", MILLI * longer, "ms", "at most", 1.0),
        Number("rise time without", rise_time(without), "s"),
        Number("rise time with", rise_time(robust), "s"),
    )


def _estimated(runs: Runs, link: str, motor: str | None, limit: float) -> tuple[Number, ...]:
    channels = {"link": link} | ({"motor": motor} if motor else {})
    return tuple(
        Number(f"RMS error / RMS of the signal, {side}", 100.0 * estimate_error(run, channel), "%", "at most", limit)
        for run in runs.values()
        for side, channel in channels.items()
    )


def _tuned_for_performance(runs: Runs) -> tuple[Number, ...]:
    by_weight = dict(zip(TORQUE_WEIGHTS, runs.values(), strict=True))
    rises = {weight: rise_time(by_weight[weight]) for weight in TORQUE_WEIGHTS[:3]}
    fast, slow = TORQUE_WEIGHTS[0], TORQUE_WEIGHTS[2]
    return (
        Number(f"rise time, weight {slow:g} / {fast:g}", rises[slow] / rises[fast], "", "at least", 3.0),
        *(
            Number(f"largest error, weight {weight:g}", MILLI * peak_error(by_weight[weight]), "mrad", "at most", 20.0)
            for weight in rises
        ),
        *(Number(f"rise time, weight {weight:g}", rise, "s") for weight, rise in rises.items()),
        Number(f"largest error, weight {TORQUE_WEIGHTS[3]:g}", MILLI * peak_error(by_weight[TORQUE_WEIGHTS[3]]), "mrad"),
    )  # fmt: skip


def _for_each_design(number: int, name: str, sentence: str, measured: str, uses: Callable[[str], tuple[str, ...]],
                     measure: Callable[..., tuple[Number, ...]], note: str = "") -> tuple[Claim, ...]:  # fmt: skip
    return tuple(
        Claim(
            number + index, f"{name}_{design}", "Sec. V, Fig. 3a", sentence.format(WORDS[design]), measured, uses(design),
            partial(measure, design=design), note,
        )
        for index, design in enumerate(PANEL)
    )  # fmt: skip


_OBSERVED = "RMS of estimate less true signal, from 4 to 10 s, against the signal's RMS."
_ESTIMATES: tuple[tuple[str, str, str, str | None, float, str], ...] = (
    ("d", "The observer estimates the disturbances accurately.", "link_disturbance_estimate", "motor_disturbance_estimate", 1.0,
     ""),
    ("d1", "It estimates their first derivatives.", "link_disturbance_rate", "motor_disturbance_rate", 5.0, ""),
    ("d2", "It estimates their second derivatives.", "link_disturbance_acceleration", None, 20.0,
     "A delay of about 3/g = 15 ms, which is most of this error; only the link's is needed by the laws, and shown."),
)  # fmt: skip

SIMULATION_CLAIMS: tuple[Claim, ...] = (
    Claim(
        1, "poles_sensitive", "Sec. V, Fig. 2a",
        "Without an observer, pole placement is highly sensitive to disturbances: the position error grows much.",
        "RMS of the link's position less its undisturbed course, from 4 to 10 s; the set point is 1 rad.",
        (*_pairs("fig2a"), "fig2a_regulation_limited"), _sensitive,
        "The quadruple pole at -8 rad/s slows the spring's resonance of 41.5 rad/s: K feeds the deflection back with some "
        "4600 N·m/rad, and every load on the link deflects the spring.",
    ),
    Claim(
        2, "lqr_less_sensitive", "Sec. V, Fig. 2b", "The LQR is more robust against the same disturbances.",
        "The same RMS, with pole placement against with the LQR.", _pairs("fig2a", "fig2b"), _less_sensitive,
    ),
    Claim(
        3, "lqr_slower", "Sec. V, Fig. 2b", "This comes at the cost of a slower response.",
        "Rise time from 10 to 90 % of the step, before the disturbances.",
        ("fig2a_regulation", "fig2b_regulation", "fig2b_regulation_faster"), _slower,
        "True of this pair of designs, not of every one: with a torque weight of 0.03 the LQR is faster than the poles and "
        "still far less sensitive.",
    ),
    *_for_each_design(
        4, "observer_removes_error", "With the observer, disturbances are rejected markedly better, with {}.",
        "RMS of the link less its undisturbed course from 4 to 10 s, without and with the observer; error against 2 % of 1 rad.",
        lambda design: (*_pairs(PANEL[design], f"fig3a_{design}"), f"fig3a_{design}_regulation_limited"), _removed,
        "At 3 s the disturbances jump; their estimated second derivative then asks for the peak torque.",
    ),
    *_for_each_design(
        6, "response_kept", "The observer does not slow the response down, with {}.",
        "The two undisturbed step responses, without and with the observer.",
        lambda design: (f"{PANEL[design]}_regulation_undisturbed", f"fig3a_{design}_regulation_undisturbed"), _kept,
    ),
    *(
        Claim(
            8 + order, f"estimates_{name}", "Sec. V, Figs. 3b, 3c", sentence, _OBSERVED, ("fig3a_poles_regulation",),
            partial(_estimated, link=link, motor=motor, limit=limit), note,
        )
        for order, (name, sentence, link, motor, limit, note) in enumerate(_ESTIMATES)
    ),
)  # fmt: skip

TUNED_FOR_PERFORMANCE = Claim(
    17, "lqr_for_performance", "Sec. V, Fig. 3a",
    "With the observer, the LQR can be tuned for performance alone.",
    "Torque weights of 0.001 to 1: rise times, and the largest error from 4 to 10 s.",
    tuple(f"fig3a_lqr_regulation_weight_{weight:g}" for weight in TORQUE_WEIGHTS), _tuned_for_performance,
    "Within reason: what the observer leaves over still passes through K, so a very slow LQR (weight 10) is disturbed again.",
)  # fmt: skip
