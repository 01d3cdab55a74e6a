"""From a tuning to the flat numbers of the tick."""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from vssea_core.control import observer_design
from vssea_core.control.chosen_gains import chosen_gains, follows_stiffness
from vssea_core.control.law import (
    BASELINE,
    LAYER,
    NO_OBSERVER,
    POSITION_FORM,
    SGN,
    SLIDING_MODE,
    STATE_FEEDBACK,
    SUPER_TWISTING,
    TANH,
    VELOCITY_FORM,
)  # fmt: skip
from vssea_core.control.observer import ObserverGains
from vssea_core.control.observer_poles import PositionShape, VelocityShape
from vssea_core.control.tuning import NoObserver, PositionObserver, SlidingMode, Tuning, VelocityObserver

Numbers = NDArray[np.float64]

DEFAULT_RANGE = (20.0, 1000.0)
TABLE_ROWS = 33
CONTROLLERS = {"state_feedback": STATE_FEEDBACK, "sliding_mode": SLIDING_MODE, "baseline": BASELINE}
SWITCHES = {"sgn": SGN, "layer": LAYER, "tanh": TANH, "super_twisting": SUPER_TWISTING}
OBSERVERS = {"velocity": VELOCITY_FORM, "position": POSITION_FORM, "off": NO_OBSERVER}


def prepare(tuning: Tuning, sample_time_s: float, stiffness_range: tuple[float, float] = DEFAULT_RANGE) -> Numbers:
    """Return `tuning` as one array of numbers: gains and discrete matrices, in the order of control.packing.

    Gains that follow the stiffness are tabulated over `stiffness_range` [N m/rad]; a range of one value gives exactly the
    gains there. Raises ValueError if a design has no solution.
    """
    low, high = stiffness_range
    if not follows_stiffness(tuning) or low == high:
        grid = np.array([tuning.schedule.reference_stiffness if low != high else low])
        table = (1.0, 0.0, 0.0)
    else:
        grid = np.geomspace(low, high, TABLE_ROWS)
        table = (float(TABLE_ROWS), math.log(low), (TABLE_ROWS - 1) / math.log(high / low))
    rows = [_row(tuning, k, sample_time_s) for k in grid]
    return np.concatenate([_fixed(tuning, sample_time_s), _stiffness_observer(tuning, sample_time_s), table, *rows])


def _fixed(tuning: Tuning, sample_time_s: float) -> list[float]:
    """Return what of Law does not follow the stiffness, in its order."""
    controller, observer, model, loop = tuning.controller, tuning.observer, tuning.model, tuning.stiffness_loop
    sliding = controller if isinstance(controller, SlidingMode) else SlidingMode()
    keep, gain = 0.0, 0.0
    if isinstance(observer, VelocityObserver | NoObserver) and observer.velocity_source == "difference":
        keep = math.exp(-observer.velocity_filter * sample_time_s)
        gain = (1.0 - keep) / sample_time_s
    return [
        CONTROLLERS[controller.kind],
        SWITCHES[sliding.switch],
        sliding.switching_gain,
        sliding.layer_width,
        sliding.twisting_gain,
        OBSERVERS[observer.kind],
        float(observer.predict),
        sample_time_s,
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
        float(loop.terms != "none"),
        float(loop.terms == "all"),
    ]


def _row(tuning: Tuning, stiffness: float, sample_time_s: float) -> Numbers:
    """Return the gains of the law and of both observers at `stiffness` [N m/rad]."""
    model, observer = tuning.model, tuning.observer
    link = motor = _gains(sample_time_s)
    if not isinstance(observer, NoObserver):
        ratio = stiffness / tuning.schedule.reference_stiffness
        bandwidth = observer.bandwidth * ratio**tuning.schedule.bandwidth_exponent
        link, motor = (
            _observer_gains(observer, bandwidth, rate, sample_time_s)
            for rate in (model.link_damping / model.link_inertia, model.motor_damping / model.motor_inertia)
        )
    return np.array([*chosen_gains(tuning, stiffness, sample_time_s), *link, *motor])


def _stiffness_observer(tuning: Tuning, sample_time_s: float) -> ObserverGains:
    """Return the gains of the stiffness motor's own observer; it stays on where the others are off."""
    observer, model = tuning.observer, tuning.model
    form = VelocityObserver() if isinstance(observer, NoObserver) else observer
    plain = form.model_copy(update={"shape": "multiple"})
    rate = model.stiffness_damping / model.stiffness_inertia
    return _observer_gains(plain, tuning.stiffness_loop.observer_bandwidth, rate, sample_time_s)


def _observer_gains(
    observer: VelocityObserver | PositionObserver, bandwidth: float, damping_rate: float, sample_time_s: float
) -> ObserverGains:
    if isinstance(observer, VelocityObserver):
        return _velocity_gains(observer.discretisation == "exact", observer.shape, bandwidth, sample_time_s)
    return _position_gains(observer.shape, bandwidth, damping_rate, sample_time_s)


# A tuning has the same observer twice or three times over, and of many tunings of a batch many share theirs.
@lru_cache(maxsize=4096)
def _velocity_gains(exact: bool, shape: VelocityShape, bandwidth: float, sample_time_s: float) -> ObserverGains:
    form = observer_design.velocity_exact if exact else observer_design.velocity_first_order_hold
    matrices = form(bandwidth, sample_time_s, shape)
    return _gains(sample_time_s, velocity=np.concatenate([part.ravel() for part in matrices]))


@lru_cache(maxsize=4096)
def _position_gains(shape: PositionShape, bandwidth: float, damping_rate: float, sample_time_s: float) -> ObserverGains:
    a, b0, b1, m = observer_design.position_form(bandwidth, damping_rate, sample_time_s, shape)
    return _gains(sample_time_s, position=np.array([*a[0, 1:], *a[1, 1:], b0[0], b1[0], b0[1], b1[1], *m]))


def _gains(sample_time_s: float, velocity: Numbers | None = None, position: Numbers | None = None) -> ObserverGains:
    """Return one channel's gains; a form that is not in use has zeros, and so has an observer that is off."""
    return ObserverGains._make(
        [
            *(np.zeros(18) if velocity is None else velocity),
            *(np.zeros(17) if position is None else position),
            sample_time_s,
        ]
    )
