"""The controller of a rig: the law on measurements, changes between two ticks, and the bumpless beginning.

It mirrors simulation.closed_loop.ClosedLoop, but for the plant, which is outside: a cycle's torques take effect with the
next exchange, so the compute delay is one sample.
"""

import numpy as np
from numpy.typing import NDArray

from vssea_core.control.law import Target
from vssea_core.control.packing import ROW
from vssea_core.control.tuning import Tuning
from vssea_core.scenario import Scenario, check_observer_fits
from vssea_core.signals.disturbances import disturbance_tables
from vssea_core.signals.documents import (
    ConstantStiffness,
    Disturbances,
    JogReference,
    Reference,
    StiffnessReference,
)
from vssea_core.signals.references import change_reference, reference_row
from vssea_core.signals.stiffness import SLEWED_SIZE, Slew, slew_row
from vssea_core.simulation.state import drive_numbers
from vssea_core.tick.bounds import RigLimits, bounds_row
from vssea_core.tick.hardware import (
    BRAKING,
    CLIPPED_AT,
    CLOSED,
    FINITE_AT,
    HEAT_AT,
    PLACES_AT,
    READING,
    SAG_AT,
    SLEWED_AT,
    STATE_SIZE,
    STIFFNESS_HOLDS,
    TRANSITION_AT,
    target_in_force,
    tick,
)
from vssea_core.tick.monitored import Monitored

__all__ = ["BRAKING", "CLOSED", "READING", "STIFFNESS_HOLDS", "Controller", "RigLimits"]

Numbers = NDArray[np.float64]
SPEED_SHARE = 0.9  # share of the rig's stiffness speed that a change of stiffness may ask for
_SLEW_FROM, _SLEW_TO = Slew._fields.index("theta_from"), Slew._fields.index("theta_to")
_SLEW_SET, _SLEW_SPEED = Slew._fields.index("set_at_s"), Slew._fields.index("speed")
_SLEW_BANDWIDTH = Slew._fields.index("bandwidth")


class Controller(Monitored):
    """The controller of `scenario` on a rig with `limits`; until `begin` it follows the scenario from t = 0.

    Raises ValueError if the tuning's observer needs velocity signals, which no rig has.
    """

    def __init__(self, scenario: Scenario, prepared: Numbers, limits: RigLimits, tuning_id: int = 1) -> None:
        _check_fits_encoders(scenario, scenario.tuning)
        self.scenario, self.limits, self.tuning_id = scenario, limits, tuning_id
        self._period = scenario.timing.sample_time_s
        self._prepared = self._before = np.array(prepared, dtype=np.float64)
        self._bounds = bounds_row(limits, scenario.actuator, self._period)
        self._drives = np.array(drive_numbers(scenario.actuator, self._period))
        self._gains = np.empty((2, ROW))
        self._state = np.zeros(STATE_SIZE)
        self._state[FINITE_AT] = 1.0
        self._transition = self._state[TRANSITION_AT:SLEWED_AT]
        self._slewed = self._state[SLEWED_AT : SLEWED_AT + SLEWED_SIZE]
        self._sample, self._mode, self._held = 0, READING, False
        self._reference = reference_row(scenario.reference)
        self._slew = self._slewing(0.0)
        self._slewed[:2] = self._slew[_SLEW_FROM]
        self._terms = disturbance_tables(scenario.disturbances, self._period, scenario.seed)

    @property
    def period_s(self) -> float:
        """Length of a cycle."""
        return self._period

    @property
    def time_s(self) -> float:
        """Time of the next tick."""
        return self._sample * self._period

    def begin(self, link: float, motor: float, stiffness_motor: float) -> None:
        """Hold where the rig is: both references := the positions [rad] measured; the observers start at the next tick.

        Raises ValueError if a position is none that can be held.
        """
        spring_constant = self.scenario.tuning.model.spring_constant
        theta_ms = min(max(stiffness_motor, self.limits.theta_ms_stiff), self.limits.theta_ms_soft)
        reference = JogReference(velocity=0.0, origin=link)
        stiffness = ConstantStiffness(stiffness=spring_constant / (2.0 * theta_ms**3))
        self.scenario = self.scenario.model_copy(update={"reference": reference, "stiffness_reference": stiffness})
        self._reference = reference_row(reference, self.time_s)
        self._state[:HEAT_AT] = 0.0  # observers, transition and stiffness reference
        self._held = False
        self._slew = self._slewing(self.time_s)
        self._slewed[:2] = stiffness_motor
        self._state[SAG_AT] = motor - link

    def install(self, tuning: Tuning, prepared: Numbers, tuning_id: int) -> None:
        """Use another tuning from the next tick on; the observer's last period stays with the old one.

        Raises ValueError if the observer needs velocity signals.
        """
        _check_fits_encoders(self.scenario, tuning)
        set_at_s = float(self._slew[_SLEW_SET])
        self.scenario = self.scenario.model_copy(update={"tuning": tuning})
        self._prepared, self.tuning_id = np.array(prepared, dtype=np.float64), tuning_id
        if not self._held:
            self._slew = self._slewing(set_at_s)

    def set_reference(self, reference: Reference) -> None:
        """Follow another reference from the next tick on, position and four derivatives continuous."""
        row = reference_row(reference, self.time_s)
        change_reference(self._reference, row, self.time_s, self._transition)
        self.scenario = self.scenario.model_copy(update={"reference": reference})
        self._reference = row

    def set_stiffness(self, reference: StiffnessReference) -> None:
        """Command another stiffness from the next tick on; what lies outside the rig's range stops at its border."""
        self.scenario = self.scenario.model_copy(update={"stiffness_reference": reference})
        self._held = False
        self._slew = self._slewing(self.time_s)

    def set_disturbances(self, disturbances: Disturbances) -> None:
        """Add the torques on motor and stiffness motor to what is asked of the drives; no rig can load its own link."""
        self.scenario = self.scenario.model_copy(update={"disturbances": disturbances})
        self._terms = disturbance_tables(disturbances, self._period, self.scenario.seed)

    def hold(self) -> None:
        """Bring the reference to rest from where and how fast it is."""
        self.set_reference(JogReference(velocity=0.0))

    def reference_now(self) -> Target:
        """Return the reference in force at the next tick and its four derivatives [rad, rad/s, ...]."""
        return Target(*target_in_force(self._reference, self._transition, self.time_s))

    def tick(
        self,
        link: float,
        motor: float,
        stiffness_motor: float,
        motor_torque: float,
        stiffness_torque: float,
        mode: int,
        blend: float,
        row: Numbers,
    ) -> tuple[float, float]:
        """Return the torques [N m] for the next exchange from the positions [rad] and torques taken over in this one.

        `blend` (0 to 1) scales the motor torque while the loop closes; `row` (at least the number of CHANNELS) is filled.
        """
        return self._cycle(link, motor, stiffness_motor, motor_torque, stiffness_torque, False, mode, blend, row)

    def missed(self, row: Numbers, mode: int, blend: float) -> tuple[float, float]:
        """Pass a cycle without a measurement: the observers go on with predicted positions, the torques are held."""
        return self._cycle(0.0, 0.0, 0.0, 0.0, 0.0, True, mode, blend, row)

    def _cycle(
        self,
        link: float,
        motor: float,
        stiffness_motor: float,
        motor_torque: float,
        stiffness_torque: float,
        missed: bool,
        mode: int,
        blend: float,
        row: Numbers,
    ) -> tuple[float, float]:
        if mode != self._mode:
            self._mode = mode
            if mode in (BRAKING, STIFFNESS_HOLDS):
                self._hold_stiffness(float(self._state[PLACES_AT + 2]) if missed else stiffness_motor)
        torques: tuple[float, float] = tick(
            self._bounds, self._drives, self._before, self._prepared, self._gains, self._reference, self._slew,
            self._terms[1], self._terms[2], float(self.tuning_id), self._state, self._sample, self._period,
            float(link), float(motor), float(stiffness_motor), float(motor_torque), float(stiffness_torque),
            missed, mode, float(blend), row,
        )  # fmt: skip
        self._before = self._prepared
        self._sample += 1
        return torques

    def _slewing(self, set_at_s: float) -> Numbers:
        """Return the numbers of the stiffness reference, kept within what the rig stands."""
        scenario = self.scenario
        row = slew_row(
            scenario.stiffness_reference, scenario.tuning, scenario.actuator.stiffness, self._period, set_at_s
        )
        asked = row[_SLEW_FROM : _SLEW_TO + 1].copy()
        row[_SLEW_FROM : _SLEW_TO + 1] = np.clip(asked, self.limits.theta_ms_stiff, self.limits.theta_ms_soft)
        row[_SLEW_SPEED] = min(row[_SLEW_SPEED], SPEED_SHARE * self.limits.stiffness_speed)
        beyond = np.abs(row[_SLEW_FROM : _SLEW_TO + 1] - asked) > 1e-9 * asked
        self._state[CLIPPED_AT] = float(beyond.any())
        return row

    def _hold_stiffness(self, theta_ms: float) -> None:
        """Let the stiffness reference come to rest from the measured place and speed, without turning round."""
        omega_ms = self.stiffness_velocity
        at = theta_ms + omega_ms / self._slew[_SLEW_BANDWIDTH]
        at = min(max(at, self.limits.theta_ms_stiff), self.limits.theta_ms_soft)
        self._slew = self._slew.copy()
        self._slew[0] = 0.0
        self._slew[_SLEW_FROM : _SLEW_TO + 1] = at
        self._slewed[:] = at, theta_ms, omega_ms, 0.0
        self._held = True
        self._state[CLIPPED_AT] = 0.0


def _check_fits_encoders(scenario: Scenario, tuning: Tuning) -> None:
    check_observer_fits(tuning, scenario.sensors.model_copy(update={"velocities": False}))
