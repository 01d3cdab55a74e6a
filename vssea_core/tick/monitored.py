"""What the last tick of a rig's controller found, for those who watch over it."""

import numpy as np
from numpy.typing import NDArray

from vssea_core.tick.hardware import FINITE_AT, SEEN_AT, SPEEDS_AT


class Monitored:
    """Reads the state that the compiled tick keeps (STATE_SIZE)."""

    _state: NDArray[np.float64]

    @property
    def finite(self) -> bool:
        """Whether all that the last tick computed were numbers; if not, the torque concerned is zero."""
        return bool(self._state[FINITE_AT])

    @property
    def link_velocity(self) -> float:
        """Filtered difference of the link encoder [rad/s], without any model."""
        return float(self._state[SPEEDS_AT])

    @property
    def motor_velocity(self) -> float:
        """Filtered difference of the motor encoder [rad/s, gear side], without any model."""
        return float(self._state[SPEEDS_AT + 1])

    @property
    def stiffness_velocity(self) -> float:
        """Filtered difference of the stiffness encoder [rad/s], without any model."""
        return float(self._state[SPEEDS_AT + 2])

    @property
    def deflection(self) -> float:
        """Measured deflection [rad]."""
        return float(self._state[SEEN_AT])

    @property
    def spring_torque(self) -> float:
        """Spring torque [N m] of the actuator at the measured positions, Eq. (3); NaN where theta_ms cannot be one."""
        return float(self._state[SEEN_AT + 1])

    @property
    def stiffness(self) -> float:
        """Stiffness [N m/rad] of the actuator at the measured positions, Eq. (4); NaN where theta_ms cannot be one."""
        return float(self._state[SEEN_AT + 2])

    @property
    def demanded_torque(self) -> float:
        """Motor torque [N m] before any limit."""
        return float(self._state[SEEN_AT + 3])

    @property
    def link_disturbance_estimate(self) -> float:
        """Disturbance torque on the link [N m] by the observer."""
        return float(self._state[SEEN_AT + 4])

    @property
    def motor_disturbance_estimate(self) -> float:
        """Disturbance torque on the motor [N m] by the observer."""
        return float(self._state[SEEN_AT + 5])

    @property
    def stiffness_disturbance_estimate(self) -> float:
        """Disturbance torque on the stiffness motor [N m] by its observer."""
        return float(self._state[SEEN_AT + 6])
