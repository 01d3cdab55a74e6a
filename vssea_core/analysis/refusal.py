"""Whether a tuning may run: its own sampled loop must be stable. If not: why, and what would work."""

import math
from collections.abc import Callable
from typing import NamedTuple

from vssea_core.actuator.parameters import Timing
from vssea_core.analysis.operating_point import LAYERED
from vssea_core.analysis.sampled_loop import Stability, stability, stiffness_axis_stability
from vssea_core.control.tuning import Baseline, Controller, NoObserver, SlidingMode, StateFeedback, Tuning

HALVINGS = 12


def unstable_because(tuning: Tuning, timing: Timing, torque_lag_s: float, stiffness: float) -> str | None:
    """Return one sentence on why `tuning` is unstable with its own model at `stiffness` [N m/rad], or None if it is stable.

    Sliding mode is judged inside its boundary layer; without one it has no linear loop, and only the stiffness axis is judged.
    """
    axis = stiffness_axis_stability(tuning, timing, stiffness)
    if not axis.stable:
        loop = tuning.stiffness_loop
        what = (
            f"the stiffness loop of {loop.bandwidth:.4g} rad/s with an observer of {loop.observer_bandwidth:.4g} rad/s"
        )
        return _sentence(what, axis, timing, torque_lag_s, stiffness, _stiffness_remedy(tuning, timing, stiffness))
    controller = tuning.controller
    if isinstance(controller, SlidingMode) and controller.switch not in LAYERED:
        return None

    def judged(candidate: Tuning) -> Stability:
        return stability(candidate, timing, torque_lag_s, stiffness)

    found = judged(tuning)
    if found.stable:
        return None
    remedy = _remedy(tuning, lambda candidate: judged(candidate).stable)
    return _sentence(_described(tuning), found, timing, torque_lag_s, stiffness, remedy)


def _sentence(what: str, found: Stability, timing: Timing, torque_lag_s: float, stiffness: float, remedy: str) -> str:
    growth = (
        "without bound"
        if math.isinf(found.radius)
        else f"{found.radius:.3g}-fold a sample at {found.frequency:.3g} rad/s"
    )
    delay = "no delay" if timing.compute_delay_samples == 0 else "one sample of delay"
    circumstances = f"{timing.sample_time_s * 1e3:g} ms, {delay}, lag {torque_lag_s * 1e3:g} ms"
    return (
        f"{what} is unstable even with its own model at {stiffness:.4g} N·m/rad ({circumstances}): "
        f"errors grow {growth}; {remedy}"
    )


def _stiffness_remedy(tuning: Tuning, timing: Timing, stiffness: float) -> str:
    loop, found = tuning.stiffness_loop, []
    for field, words in (
        ("bandwidth", "a stiffness loop bandwidth"),
        ("observer_bandwidth", "a stiffness observer bandwidth"),
    ):

        def stable(value: float, field: str = field) -> bool:
            changed = tuning.model_copy(update={"stiffness_loop": loop.model_copy(update={field: value})})
            return stiffness_axis_stability(changed, timing, stiffness).stable

        value = _nearest(stable, 1.0, getattr(loop, field))
        if value is not None:
            found.append(f"{words} up to about {value:.3g} rad/s")
    return f"{', or '.join(found)} would be stable" if found else "no single change is enough, so lower both bandwidths"


def _described(tuning: Tuning) -> str:
    observer = tuning.observer
    watched = (
        "no observer"
        if isinstance(observer, NoObserver)
        else f"a {observer.kind} observer of {observer.bandwidth:.4g} rad/s"
    )
    return f"{_law(tuning.controller)} and {watched}"


def _law(controller: Controller) -> str:
    if isinstance(controller, SlidingMode):
        rate = controller.switching_gain / controller.layer_width
        return f"sliding mode with surface poles at {controller.surface_pole:.4g} rad/s and ρ/φ = {rate:.4g} 1/s"
    name = "the baseline" if isinstance(controller, Baseline) else "state feedback"
    if controller.design == "poles":
        return f"{name} with poles at {controller.natural_frequency:.4g} rad/s"
    return f"{name} by LQR"


class Knob(NamedTuple):
    """One field that makes a loop calmer as it falls (or, for a weight, rises), and how to say how far it may go."""

    part: str
    field: str
    value: float
    calmest: float
    sentence: str


def _knobs(tuning: Tuning) -> list[Knob]:
    controller, observer = tuning.controller, tuning.observer
    knobs: list[Knob] = []
    if isinstance(controller, SlidingMode):
        knobs = [
            Knob("controller", "surface_pole", controller.surface_pole, 0.5, "surface poles up to about {:.3g} rad/s"),
            Knob("controller", "switching_gain", controller.switching_gain, 0.5 * controller.layer_width,
                 "a switching gain up to about {:.3g} rad/s⁴ with this boundary layer"),
        ]  # fmt: skip
    elif controller.design == "poles":
        knobs = [
            Knob("controller", "natural_frequency", controller.natural_frequency, 0.5, "poles up to about {:.3g} rad/s")
        ]
    elif controller.design == "lqr_plant":
        knobs = [
            Knob("controller", "torque_weight", controller.torque_weight, 1e12, "a torque weight from about {:.3g} on")
        ]
    elif isinstance(controller, StateFeedback):
        knobs = [Knob("controller", "snap_weight", controller.snap_weight, 1e12, "a snap weight from about {:.3g} on")]
    if not isinstance(observer, NoObserver):
        knobs.append(
            Knob("observer", "bandwidth", observer.bandwidth, 1.0, "an observer bandwidth up to about {:.3g} rad/s")
        )
    return knobs


def _remedy(tuning: Tuning, stable: Callable[[Tuning], bool]) -> str:
    """Return what would work: for each knob the value nearest the present one, found by halving."""
    found = []
    for knob in _knobs(tuning):

        def works(value: float, knob: Knob = knob) -> bool:
            part = getattr(tuning, knob.part).model_copy(update={knob.field: value})
            return stable(tuning.model_copy(update={knob.part: part}))

        near = _nearest(works, knob.calmest, knob.value)
        if near is not None:
            found.append(knob.sentence.format(near))
    if not found:
        return "no single change of gains or bandwidth is enough, so lower both"
    return f"{', or '.join(found)} would be stable"


def _nearest(works: Callable[[float], bool], calmest: float, present: float) -> float | None:
    """Return about the value nearest to `present` that works, by halving on a logarithmic scale; None if `calmest` fails."""
    if calmest == present or not works(calmest):
        return None
    good, bad = calmest, present
    for _ in range(HALVINGS if 1e-3 < calmest / present < 1e3 else 2 * HALVINGS):
        middle = math.sqrt(good * bad)
        good, bad = (middle, bad) if works(middle) else (good, middle)
    return good * (0.99 if good < bad else 1.01)  # so that the three digits that are printed stay on the stable side
