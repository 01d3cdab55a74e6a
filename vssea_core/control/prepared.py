"""From a tuning to the flat numbers of the tick."""

import math

import numpy as np
from numpy.typing import NDArray

from vssea_core.control import observer_design
from vssea_core.control.design import state_feedback_gains, surface_gains
from vssea_core.control.law import SLIDING_MODE, STATE_FEEDBACK, Law
from vssea_core.control.observer import ObserverGains
from vssea_core.control.tuning import SlidingMode, StateFeedback, Tuning, VelocityObserver


def prepare(tuning: Tuning, sample_time_s: float) -> NDArray[np.float64]:
    """Return `tuning` as one array of numbers: gains and discrete matrices, in the order of Prepared."""
    model, observer, loop = tuning.model, tuning.observer, tuning.stiffness_loop
    rates = (
        model.link_damping / model.link_inertia,
        model.motor_damping / model.motor_inertia,
        model.stiffness_damping / model.stiffness_inertia,
    )
    bandwidths = (observer.bandwidth, observer.bandwidth, loop.observer_bandwidth)
    channels = [_observer_gains(tuning, g, rate, sample_time_s) for g, rate in zip(bandwidths, rates, strict=True)]
    return np.array([*_law(tuning, sample_time_s), *channels[0], *channels[1], *channels[2]])


def _law(tuning: Tuning, sample_time_s: float) -> Law:
    controller, observer, model, loop = tuning.controller, tuning.observer, tuning.model, tuning.stiffness_loop
    feedback, surface = StateFeedback(), SlidingMode()
    if isinstance(controller, StateFeedback):
        feedback, surface = controller, SlidingMode(surface_pole=controller.natural_frequency)
    else:
        surface = controller
    keep, gain = 0.0, 0.0
    if isinstance(observer, VelocityObserver) and observer.velocity_source == "difference":
        keep = math.exp(-observer.velocity_filter * sample_time_s)
        gain = (1.0 - keep) / sample_time_s
    k1, k2, k3, k4 = state_feedback_gains(feedback.natural_frequency, feedback.damping)
    s1, s2, s3 = surface_gains(surface.surface_pole)
    return Law(
        SLIDING_MODE if isinstance(controller, SlidingMode) else STATE_FEEDBACK,
        k1,
        k2,
        k3,
        k4,
        s1,
        s2,
        s3,
        surface.switching_gain,
        surface.layer_width if surface.switch == "layer" else 0.0,
        float(observer.kind == "position"),
        keep,
        gain,
        model.link_inertia,
        model.link_damping,
        model.motor_inertia,
        model.motor_damping,
        model.spring_constant,
        model.stiffness_inertia,
        model.stiffness_damping,
        loop.bandwidth**2,
        2.0 * loop.damping * loop.bandwidth,
    )


def _observer_gains(tuning: Tuning, bandwidth: float, damping_rate: float, sample_time_s: float) -> ObserverGains:
    observer = tuning.observer
    velocity, position = np.zeros(18), np.zeros(17)
    if isinstance(observer, VelocityObserver):
        exact = observer.discretisation == "exact"
        form = observer_design.velocity_exact if exact else observer_design.velocity_first_order_hold
        velocity = np.concatenate([part.ravel() for part in form(bandwidth, sample_time_s)])
    else:
        a, b0, b1, m = observer_design.position_form(bandwidth, damping_rate, sample_time_s)
        position = np.array([*a[0, 1:], *a[1, 1:], b0[0], b1[0], b0[1], b1[1], *m])
    return ObserverGains._make([*velocity, *position, sample_time_s])
