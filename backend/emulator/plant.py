"""The emulated actuator: its true state, what its drives make it do, and what was largest since somebody watched."""

import math
from typing import Any

import numpy as np

from backend.emulator import plant_kernel as kernel
from vssea_core.actuator.parameters import Actuator, EquilibriumMotor
from vssea_core.actuator.spring import stiffness_motor_position
from vssea_core.signals.disturbances import ROW_SIZE, disturbance_rows
from vssea_core.signals.documents import ConstantDisturbance
from vssea_core.simulation.state import drive_numbers, plant_numbers

MOTOR, STIFFNESS, LINK = 0, 1, 2
AXES = ("motor", "stiffness", "link")
POSITIONS, VELOCITIES = (2, 4, 0), (3, 5, 1)  # places in PlantState
LOOP_SPEED = (50.0, 100.0)  # rad/s, bandwidth of each drive's own position loop
CATCH_UP_S = 0.1
"""The most plant time that is made up for at once; what a stalled process missed beyond it never happened."""
STAYED_S = 0.1  # how long the motor must have been without torque to be called safe
DEFAULT_STIFFNESS = 200.0


def default_actuator() -> Actuator:
    """Return the default actuator with the dry friction and the torque-loop lag of a real one."""
    return Actuator(motor=EquilibriumMotor(coulomb_friction=5.6, torque_lag_s=1.6e-4))


class EmulatedPlant:
    """An actuator that starts at rest, unloaded, at a stiffness [N m/rad]. Axes: MOTOR, STIFFNESS, LINK; gear side, SI."""

    def __init__(self, actuator: Actuator, stiffness: float = DEFAULT_STIFFNESS) -> None:
        self.actuator = actuator
        self.link_factor = self.motor_factor = 1.0
        self.holds = True
        self.skipped_s = 0.0
        self.marked_s = 0.0
        self._stiffness = stiffness
        self._state = np.zeros(kernel.STATE_SIZE + 2)
        self._axes = np.zeros((2, kernel.AXIS_SIZE))
        self._link_loads, self._motor_loads = np.zeros((1, ROW_SIZE)), np.zeros((0, ROW_SIZE))
        self.load(0.0)
        self._record = np.zeros(kernel.RECORD_SIZE)
        self.reform()
        self._rest()

    def reform(self) -> None:
        """Take over the inertias' factors."""
        actuator = self.actuator
        motor = actuator.motor.model_copy(update={"inertia": actuator.motor.inertia * self.motor_factor})
        link = actuator.link.model_copy(update={"inertia": actuator.link.inertia * self.link_factor})
        as_it_is = actuator.model_copy(update={"motor": motor, "link": link})
        self._numbers = np.array(
            [
                *plant_numbers(as_it_is, kernel.FINE_STEP_S),
                *drive_numbers(as_it_is, kernel.FINE_STEP_S),
                motor.torque_lag_s,
                motor.thermal_time_s,
            ]
        )

    def _rest(self) -> None:
        mechanism = self.actuator.stiffness
        theta_ms = stiffness_motor_position(self._stiffness, mechanism.spring_constant)
        self._state[:] = 0.0
        self._state[POSITIONS[STIFFNESS]] = theta_ms
        inertias = self.actuator.motor.inertia, mechanism.inertia
        for axis, inertia, bandwidth in zip(self._axes, inertias, LOOP_SPEED, strict=True):
            axis[kernel.MODE] = kernel.OFF
            axis[kernel.POSITION_GAIN], axis[kernel.SPEED_GAIN] = inertia * bandwidth**2, 2.0 * inertia * bandwidth
        self._axes[MOTOR, kernel.CAP] = self.actuator.motor.peak_torque
        self._axes[STIFFNESS, kernel.CAP] = mechanism.peak_torque

    def advance(self, duration_s: float) -> None:
        """Let time pass, as much as may be caught up with."""
        if duration_s <= 0.0:
            return
        if duration_s > CATCH_UP_S:
            self.skipped_s += duration_s - CATCH_UP_S
            duration_s = CATCH_UP_S
        if not kernel.advance(
            self._numbers, self._state, self._axes, self._link_loads, self._motor_loads, self._record, duration_s
        ):
            self.holds = False  # the spring's law has ended: put the actuator back to rest, and say so
            self._rest()

    def position(self, axis: int) -> float:
        """Return the position [rad] of an axis."""
        return float(self._state[POSITIONS[axis]])

    def velocity(self, axis: int) -> float:
        """Return the velocity [rad/s] of an axis."""
        return float(self._state[VELOCITIES[axis]])

    def given(self, axis: int) -> float:
        """Return the torque [N m] that acts on an axis."""
        return float(self._axes[axis, kernel.GIVEN])

    def is_limited(self, axis: int) -> bool:
        """Return whether a drive gives less than it was asked for."""
        return bool(self._axes[axis, kernel.LIMITED])

    def off(self, axis: int) -> None:
        """Take the torque off an axis."""
        self._axes[axis, kernel.MODE] = kernel.OFF

    def give(self, axis: int, torque: float) -> None:
        """Let an axis have a torque [N m]."""
        self._axes[axis, kernel.MODE], self._axes[axis, kernel.TORQUE] = kernel.TORQUE_GIVEN, torque

    def brake(self, axis: int, deceleration: float) -> None:
        """Let an axis slow down [rad/s^2] and then hold still, by its drive's own loop."""
        row = self._axes[axis]
        if row[kernel.MODE] != kernel.BRAKING:
            row[kernel.SPEED_REFERENCE], row[kernel.POSITION_REFERENCE] = self.velocity(axis), self.position(axis)
        row[kernel.MODE], row[kernel.DECELERATION] = kernel.BRAKING, deceleration

    def is_down(self, axis: int) -> bool:
        """Return whether a braking axis has come to the end of its ramp."""
        return bool(self._axes[axis, kernel.SPEED_REFERENCE] == 0.0)

    def cap(self, axis: int, torque: float) -> None:
        """Limit what an axis gives [N m]."""
        self._axes[axis, kernel.CAP] = torque

    def load(self, torque: float) -> None:
        """Load the link [N m]; positive opposes positive motion, as in Eq. (1)."""
        self._link_loads[:] = disturbance_rows([ConstantDisturbance(torque=torque)], kernel.FINE_STEP_S)

    def push(self, torque: float) -> None:
        """Push the stiffness motor from outside [N m]; positive is towards softer."""
        self._axes[STIFFNESS, kernel.PUSH] = torque

    def mark(self) -> None:
        """Count the time until the motor is without torque from now on."""
        self.marked_s = float(self._record[kernel.TIME])
        self._record[kernel.LAST_UNSAFE] = self.marked_s

    def watch(self) -> None:
        """Forget what was largest so far."""
        self.mark()
        self._record[kernel.LINK_VELOCITY :] = 0.0

    def peaks(self) -> dict[str, Any]:
        """Return what was largest since the last watch, and how long the motor had torque since the last mark."""
        record = self._record
        stayed = record[kernel.TIME] - record[kernel.LAST_UNSAFE] >= STAYED_S
        return {
            "safe_after_s": float(record[kernel.LAST_UNSAFE]) - self.marked_s if stayed else None,
            "since_s": float(record[kernel.TIME]) - self.marked_s,
            "peak_link_velocity": float(record[kernel.LINK_VELOCITY]),
            "peak_motor_velocity": float(record[kernel.MOTOR_VELOCITY]),
            "peak_stiffness_velocity": float(record[kernel.STIFFNESS_VELOCITY]),
            "peak_deflection": float(record[kernel.DEFLECTION]),
            "peak_motor_torque": float(record[kernel.MOTOR_TORQUE]),
            "peak_stiffness_torque": float(record[kernel.STIFFNESS_TORQUE]),
            "motor_torque": self.given(MOTOR),
            "stiffness_torque": self.given(STIFFNESS),
        }

    def truth(self) -> dict[str, float]:
        """Return the true state [rad, rad/s, N m/rad]."""
        deflection, theta_ms = self.position(MOTOR) - self.position(LINK), self.position(STIFFNESS)
        shape = 0.5 * math.cos(0.5 * deflection) / theta_ms**3
        return {
            **{f"{name}_position": self.position(axis) for axis, name in enumerate(AXES)},
            **{f"{name}_velocity": self.velocity(axis) for axis, name in enumerate(AXES)},
            "stiffness": self.actuator.stiffness.spring_constant * shape,
        }
