"""A rig that answers, and the law on its measurements: one exchange and one tick a cycle, with what is asked of the next."""

import math

import numpy as np
from numpy.typing import NDArray

from backend.loop.axes import Axes, Found
from backend.loop.freshness import STOPS, oldest
from backend.loop.homing import HomingLaw, Stops
from backend.loop.messages import Connect
from backend.rigs.faults import CORRUPTED
from backend.rigs.rig import Identity, Measured, Rig, RigError
from backend.rigs.rig_file import RigFile
from vssea_core.actuator.parameters import Actuator
from vssea_core.actuator.spring import stiffness_motor_position
from vssea_core.channels import INDEX
from vssea_core.control.packing import law_of
from vssea_core.control.tuning import Tuning
from vssea_core.tick.controller import READING, Controller, RigLimits

NOTHING_YET = Measured(0.0, 0.0, 0.0, 1, 1, 1, 0.0, 0.0, 0.0, 0.0)
FARTHEST = 6.3  # rad; a reference can be no farther, and no rig can be armed there
KNOWN_UNHOMED = tuple(INDEX[name] for name in ("time", "link_position", "motor_position", "tuning_id", "motor_torque"))


def rig_limits(file: RigFile, actuator: Actuator) -> RigLimits:
    """Return the limits of a rig's file as the last stage of the law takes them."""
    limits, constant = file.limits, actuator.stiffness.spring_constant
    return RigLimits(
        motor_torque=min(limits.motor_torque, file.motor.torque_limit),
        motor_torque_rate=limits.motor_torque_rate,
        motor_speed=limits.motor_speed,
        stiffness_torque=min(limits.stiffness_torque, file.stiffness.torque_limit),
        stiffness_speed=limits.stiffness_speed,
        link_low=limits.link_low,
        link_high=limits.link_high,
        braking=limits.braking,
        deflection=limits.deflection,
        theta_ms_stiff=stiffness_motor_position(limits.stiffness_high, constant),
        theta_ms_soft=stiffness_motor_position(limits.stiffness_low, constant),
    )


def tuning_period_s(prepared: NDArray[np.float64]) -> float:
    """Return the cycle [s] that a prepared tuning is made for."""
    return float(law_of(prepared).period)


class ConnectedRig:
    """Owns a rig between Connect and Disconnect. Raises ValueError if the scenario is made for another rate."""

    def __init__(self, rig: Rig, identity: Identity, command: Connect) -> None:
        scenario, self.file = command.scenario, command.rig
        if abs(scenario.timing.sample_time_s - rig.period_s) > 1e-9:
            raise ValueError(
                f"the scenario is made for cycles of {scenario.timing.sample_time_s * 1e3:g} ms, "
                f"the rig's are {rig.period_s * 1e3:g} ms; set timing.sample_time_s to {rig.period_s:g} s"
            )
        self.rig, self.identity, self.limits = rig, identity, command.rig.limits
        self.actuator, self.period_s = scenario.actuator, rig.period_s
        self.last_stage = rig_limits(command.rig, self.actuator)
        self.controller = Controller(scenario, command.prepared, self.last_stage, command.tuning_id)
        self.tuning_period_s = tuning_period_s(command.prepared)
        self.axes = Axes(rig)
        self.measured = NOTHING_YET
        self.homed = False
        self.span_found: float | None = None
        self.motor_torque = self.stiffness_torque = 0.0  # for the next exchange
        self._middle = 0.5 * (self.last_stage.theta_ms_stiff + self.last_stage.theta_ms_soft)
        self._begun = False
        self._told = (READING, 0.0)  # mode and share of the last tick
        self._motor_zero = 0.0  # what an incremental motor encoder shows where the link's shows 0 [rad]

    @property
    def running(self) -> bool:
        """Whether the law runs on measurements: there has been one of every node, and none is missing for long."""
        return self._begun and oldest(self.measured) < STOPS

    def exchange(self) -> Found:
        """Exchange one cycle; what was not measured anew keeps its value and gets older. Return what went wrong."""
        try:
            measured = self.rig.exchange(self.motor_torque, self.stiffness_torque)
            measured = measured._replace(motor_position=measured.motor_position - self._motor_zero)
            found = list(self.rig.bus_faults())
        except RigError as error:
            self.measured = _older(self.measured, True, True, True)
            return [(error.fault, error.detail)]
        link, motor, stiffness = (
            not math.isfinite(position)
            for position in (measured.link_position, measured.motor_position, measured.stiffness_position)
        )
        if not (link or motor or stiffness):
            self.measured = measured
            return found
        before = self.measured
        self.measured = _older(
            measured._replace(
                link_position=before.link_position if link else measured.link_position,
                motor_position=before.motor_position if motor else measured.motor_position,
                stiffness_position=before.stiffness_position if stiffness else measured.stiffness_position,
            ),
            link, motor, stiffness,
        )  # fmt: skip
        found.append((CORRUPTED, "a position is no number"))
        return found

    def tick(self, mode: int, blend: float, row: NDArray[np.float64]) -> tuple[float, float]:
        """Run the law on what was measured, fill `row` (WIDTH) and return both torques [N m]."""
        m, controller = self.measured, self.controller
        self._told = mode, blend
        if not self._begun:
            self.begin()
            self._begun = oldest(m) == 0
        if 0 < oldest(m) < STOPS:
            torques = controller.missed(row, mode, blend)
        else:
            torques = controller.tick(
                m.link_position, m.motor_position, self._theta_ms, m.motor_torque, m.stiffness_torque, mode, blend, row
            )
        if not self.homed:
            self._blank(row)
        return torques

    def skip(self, row: NDArray[np.float64]) -> None:
        """Pass a cycle in which this computer was too late to exchange: the drives hold, the state goes on as predicted."""
        self.controller.missed(row, *self._told)
        if not self.homed:
            self._blank(row)

    def begin(self) -> None:
        """Start observers and references from what is measured."""
        link = min(max(self.measured.link_position, -FARTHEST), FARTHEST)
        self.controller.begin(link, self.measured.motor_position, self._theta_ms)

    def install(self, tuning: Tuning, prepared: NDArray[np.float64], tuning_id: int) -> None:
        """Swap the tuning before the next tick. Raises ValueError if it is made for another rate."""
        period_s = tuning_period_s(prepared)
        if abs(period_s - self.period_s) > 1e-9:
            raise ValueError(
                f"this tuning is prepared for cycles of {period_s * 1e3:g} ms; the rig runs at {self.period_s * 1e3:g} ms"
            )
        self.controller.install(tuning, prepared, tuning_id)
        self.tuning_period_s = period_s

    def begin_homing(self) -> HomingLaw:
        """Forget where theta_ms was and return the law that homes the stiffness axis, at its beginning."""
        self.homed, self.span_found = False, None
        self.rig.home(0.0)
        mechanism = self.actuator.stiffness
        constant = mechanism.spring_constant
        stiff, soft = (stiffness_motor_position(k, constant) for k in (mechanism.stiffest, mechanism.softest))
        stops = Stops(stiff, soft, self._middle)
        return HomingLaw(self.file.homing, stops, mechanism.inertia, mechanism.damping, self.period_s)

    def align_motor(self) -> None:
        """Take the spring to be undeflected now: with the motor off and the spring stiff, no load deflects it much."""
        m = self.measured
        self._motor_zero += m.motor_position - m.link_position
        self.measured = m._replace(motor_position=m.link_position)
        self.begin()

    def take_home(self, offset: float, span_found: float) -> None:
        """Let the stiffness motor's position be theta_ms from now on."""
        self.rig.home(offset)
        self.measured = self.measured._replace(stiffness_position=self.measured.stiffness_position - offset)
        self.homed, self.span_found = True, span_found
        self.begin()

    @property
    def _theta_ms(self) -> float:
        return self.measured.stiffness_position if self.homed else self._middle

    def _blank(self, row: NDArray[np.float64]) -> None:
        """Leave only what is known of a rig that is not homed: its law runs on a guess of theta_ms, to keep time."""
        known = [row[column] for column in KNOWN_UNHOMED]
        row[:] = np.nan
        for column, value in zip(KNOWN_UNHOMED, known, strict=True):
            row[column] = value
        row[INDEX["stiffness_motor_position"]] = self.measured.stiffness_position
        row[INDEX["stiffness_motor_torque"]] = self.measured.stiffness_torque
        row[INDEX["limits"]] = 0.0


def _older(measured: Measured, link: bool, motor: bool, stiffness: bool) -> Measured:
    return measured._replace(
        link_age=measured.link_age + link,
        motor_age=measured.motor_age + motor,
        stiffness_age=measured.stiffness_age + stiffness,
    )
