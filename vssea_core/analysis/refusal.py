"""Whether a tuning may run: its own sampled loop must be stable. If not: why, and what would work."""

import math
from collections.abc import Callable

from vssea_core.actuator.parameters import Timing
from vssea_core.analysis.operating_point import LAYERED
from vssea_core.analysis.sampled_loop import Stability, stability, stiffness_axis_stability
from vssea_core.control.tuning import SlidingMode, StateFeedback, Tuning

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
            changed = _with(tuning, stiffness_loop=loop.model_copy(update={field: value}))
            return stiffness_axis_stability(changed, timing, stiffness).stable

        value = _largest(stable, 1.0, getattr(loop, field))
        if value:
            found.append(f"{words} up to about {value:.3g} rad/s")
    return f"{', or '.join(found)} would be stable" if found else "no single change is enough, so lower both bandwidths"


def _described(tuning: Tuning) -> str:
    controller, observer = tuning.controller, tuning.observer
    if isinstance(controller, StateFeedback):
        law = f"state feedback with poles at {controller.natural_frequency:.4g} rad/s"
    else:
        rate = controller.switching_gain / controller.layer_width
        law = f"sliding mode with surface poles at {controller.surface_pole:.4g} rad/s and ρ/φ = {rate:.4g} 1/s"
    return f"{law} and a {observer.kind} observer of {observer.bandwidth:.4g} rad/s"


def _remedy(tuning: Tuning, stable: Callable[[Tuning], bool]) -> str:
    """Return what would work: the largest poles, switching gain or bandwidth below the present ones, found by halving."""
    controller, observer = tuning.controller, tuning.observer
    found = []
    if isinstance(controller, StateFeedback):
        pole = _largest(lambda p: stable(_with(tuning, controller=controller.model_copy(update={"natural_frequency": p}))),
                        0.5, controller.natural_frequency)  # fmt: skip
        if pole:
            found.append(f"poles up to about {pole:.3g} rad/s")
    else:
        pole = _largest(lambda p: stable(_with(tuning, controller=controller.model_copy(update={"surface_pole": p}))),
                        0.5, controller.surface_pole)  # fmt: skip
        if pole:
            found.append(f"surface poles up to about {pole:.3g} rad/s")
        gain = _largest(lambda r: stable(_with(tuning, controller=controller.model_copy(update={"switching_gain": r}))),
                        controller.layer_width * 0.5, controller.switching_gain)  # fmt: skip
        if gain:
            found.append(f"a switching gain up to about {gain:.3g} rad/s⁴ with this boundary layer")
    bandwidth = _largest(lambda g: stable(_with(tuning, observer=observer.model_copy(update={"bandwidth": g}))),
                         1.0, observer.bandwidth)  # fmt: skip
    if bandwidth:
        found.append(f"an observer bandwidth up to about {bandwidth:.3g} rad/s")
    if not found:
        return "no single change of poles or bandwidth is enough, so lower both"
    return f"{', or '.join(found)} would be stable"


def _with(tuning: Tuning, **parts: object) -> Tuning:
    return tuning.model_copy(update=parts)


def _largest(works: Callable[[float], bool], low: float, high: float) -> float | None:
    """Return about the largest value below `high` that works, by halving on a logarithmic scale; None if `low` does not."""
    if low >= high or not works(low):
        return None
    for _ in range(HALVINGS):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if works(middle) else (low, middle)
    return 0.99 * low  # so that the three digits that are printed stay on the stable side
