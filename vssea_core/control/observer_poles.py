"""Where the estimation error of a disturbance observer has its poles, and what error a changing disturbance leaves.

One knob, the bandwidth g [rad/s]: `multiple` puts all poles at -g; `butterworth` spreads those of the velocity form on the
circle of radius g; `kalman` is the position form's steady-state Kalman filter, which has Butterworth poles of radius g: with
white noise of density q on d''' and of variance r on each measurement, g = (q / (r T))^(1/10). Sampled, they are at exp(s_i T) but
for what is folded from beyond the Nyquist frequency, some (g T / 2 pi)^10.
"""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from vssea_core.control.design import Numbers, Poles, polynomial_of
from vssea_core.control.pole_choice import butterworth_poles

VelocityShape = Literal["multiple", "butterworth"]
PositionShape = Literal["multiple", "kalman"]
VELOCITY_STATES, POSITION_STATES = 3, 5


def velocity_poles(bandwidth: float, shape: VelocityShape = "multiple") -> NDArray[np.complex128]:
    """Return the three continuous poles [rad/s] of the velocity form's error. Raises ValueError for an unknown shape."""
    if shape == "multiple":
        return np.full(VELOCITY_STATES, -bandwidth, dtype=complex)
    if shape == "butterworth":
        return butterworth_poles(VELOCITY_STATES, bandwidth)
    raise ValueError(f"the shape of a velocity observer is {shape!r}; expected 'multiple' or 'butterworth'")


def position_poles(bandwidth: float, shape: PositionShape = "multiple") -> NDArray[np.complex128]:
    """Return the five continuous poles [rad/s] of the position form's error. Raises ValueError for an unknown shape."""
    if shape == "multiple":
        return np.full(POSITION_STATES, -bandwidth, dtype=complex)
    if shape == "kalman":
        return butterworth_poles(POSITION_STATES, bandwidth)
    raise ValueError(f"the shape of a position observer is {shape!r}; expected 'multiple' or 'kalman'")


def steady_errors(poles: Poles) -> Numbers:
    """Return the steady errors (3,) of d^, d'^, d''^ for each unit of d''' = c, in 1/(rad/s)^3, ^2, ^1, at short samples.

    From the error's continuous `poles`, three (velocity form) or five (position form): with c_i the coefficients of their
    polynomial, [c_3, c_2, c_1] / c_0. Triple pole: 1/g^3, 3/g^2, 3/g; five-fold: 10/g^3, 10/g^2, 5/g.
    """
    coefficients = np.append(polynomial_of(poles), 1.0)
    errors: Numbers = coefficients[3:0:-1] / coefficients[0]
    return errors
