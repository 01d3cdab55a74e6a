"""What a bounded disturbance may do to the tracking error: the observer's worst case, through both certificates."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from vssea_core.control.certificate import Certificate, certificate, snap_bound
from vssea_core.control.law import SLIDING_MODE, STATE_FEEDBACK, Law
from vssea_core.control.linear_model import LinearModel
from vssea_core.control.observer_bounds import estimation_bounds
from vssea_core.control.observer_poles import position_poles, velocity_poles
from vssea_core.control.packing import law_of
from vssea_core.control.prepared import prepare
from vssea_core.control.tuning import NoObserver, Tuning, VelocityObserver


@dataclass(frozen=True)
class ErrorBound:
    """Bounds on |e1| [rad] while |d^3 tau/dt^3| of the disturbances stays within the given ones, the model being the plant."""

    link_jerk: float  # bound on the third derivative of the link's disturbance torque [N m/s^3]
    motor_jerk: float
    estimation: tuple[float, float, float, float]  # bounds on the errors of d_l, d_l', d_l'', d_e
    found: Certificate

    def document(self) -> dict[str, Any]:
        """Return plain numbers."""
        return {
            "link_jerk": self.link_jerk,
            "motor_jerk": self.motor_jerk,
            "estimation": list(self.estimation),
            "snap_bound": self.found.snap_bound,
            "peak_error": self.found.peak_error,
            "lyapunov_bound": self.found.lyapunov_bound,
            "overshoot": self.found.overshoot,
            "decay": self.found.decay,
        }


def error_bound(
    tuning: Tuning, sample_time_s: float, stiffness: float, link_jerk: float, motor_jerk: float
) -> ErrorBound | None:
    """Return the ErrorBound of `tuning` at `stiffness` [N m/rad]; None if its law or observer gives none.

    Eqs. (11)-(13), corrected, beside the exact peak gain. In continuous time: short samples. Sliding mode is taken inside its
    layer. Raises ValueError if the gains do not stabilise the error.
    """
    observer, model = tuning.observer, tuning.model
    if isinstance(observer, NoObserver):
        return None
    gains = _chain_gains(law_of(prepare(tuning, sample_time_s, (stiffness, stiffness))))
    if gains is None:
        return None
    bandwidth = (
        observer.bandwidth * (stiffness / tuning.schedule.reference_stiffness) ** tuning.schedule.bandwidth_exponent
    )
    if isinstance(observer, VelocityObserver):
        poles = velocity_poles(bandwidth, observer.shape)
    else:
        poles = position_poles(bandwidth, observer.shape)
    link = estimation_bounds(poles, link_jerk / model.link_inertia)
    motor = estimation_bounds(poles, motor_jerk / model.motor_inertia)
    errors = np.array([*link, motor[0]])
    plant = LinearModel(model.link_inertia, model.link_damping, model.motor_inertia, model.motor_damping, stiffness)
    found = certificate(gains, snap_bound(plant, gains, errors))
    first, second, third, last = (float(error) for error in errors)
    return ErrorBound(link_jerk, motor_jerk, (first, second, third, last), found)


def _chain_gains(law: Law) -> np.ndarray | None:
    """Return K (4) of the error chain, those of the layer for sliding mode; None for a law without such gains."""
    if law.controller == STATE_FEEDBACK:
        return np.array([law.k1, law.k2, law.k3, law.k4])
    if law.controller == SLIDING_MODE:
        slope = law.switching_gain / law.layer_width
        return np.array([slope * law.s1, law.s1 + slope * law.s2, law.s2 + slope * law.s3, law.s3 + slope])
    return None
