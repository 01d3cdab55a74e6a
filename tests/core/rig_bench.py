"""A controller on a simulated rig, cycle by cycle, for tests that break it or change something in between."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backend.rigs.rig import AXES, Measured
from backend.rigs.simulated import SimulatedRig
from vssea_core.actuator.parameters import Timing
from vssea_core.actuator.spring import stiffness_motor_position
from vssea_core.channels import CHANNELS, INDEX, LIMITS
from vssea_core.control.prepared import prepare
from vssea_core.control.tuning import Tuning
from vssea_core.scenario import Scenario
from vssea_core.scenarios import REALISTIC
from vssea_core.signals.documents import ConstantStiffness, Disturbances
from vssea_core.tick.controller import CLOSED, READING, Controller, RigLimits

SPRING_CONSTANT = REALISTIC.actuator.stiffness.spring_constant
LIMITS_OF_RIG = RigLimits(
    motor_torque=70.0,
    motor_torque_rate=20000.0,
    motor_speed=3.0,
    stiffness_torque=0.75,
    stiffness_speed=400.0,
    link_low=-1.6,
    link_high=1.6,
    braking=8.0,
    deflection=0.6,
    theta_ms_stiff=stiffness_motor_position(900.0, SPRING_CONSTANT),
    theta_ms_soft=stiffness_motor_position(25.0, SPRING_CONSTANT),
)
NEVER_REACHED = RigLimits(1e3, 1e9, 1e3, 1e3, 1e5, -50.0, 50.0, 1e4, 3.0, 1.0, 500.0)
LINK, MOTOR, STIFFNESS_MOTOR = 0, 2, 4
"""Columns of the true positions in what `run` returns."""


def rig_scenario(stiffness: float = 200.0, sample_time_s: float = 2e-3, link: tuple = ()) -> Scenario:
    return REALISTIC.model_copy(
        update={
            "timing": Timing(sample_time_s=sample_time_s, compute_delay_samples=1),
            "stiffness_reference": ConstantStiffness(stiffness=stiffness),
            "disturbances": Disturbances(link=link),
        }
    )


def bits_in(rows: NDArray[np.float64]) -> set[str]:
    """Return the names of all limits that acted in some row."""
    acted = int(np.bitwise_or.reduce(rows[:, INDEX["limits"]].astype(int)))
    return {limit.name for limit in LIMITS if acted & limit.bit}


def column(rows: NDArray[np.float64], name: str) -> NDArray[np.float64]:
    return rows[:, INDEX[name]]


class RigBench:
    """The controller of a scenario on its simulated rig, drives off at first."""

    def __init__(self, scenario: Scenario, limits: RigLimits = LIMITS_OF_RIG) -> None:
        self.rig = SimulatedRig(scenario)
        self.rig.configure()
        self.period = scenario.timing.sample_time_s
        self.controller = Controller(scenario, prepare(scenario.tuning, self.period), limits)
        self.sent = (0.0, 0.0)
        self.measured: Measured | None = None

    def run(
        self, cycles: int, mode: int, blend: Callable[[int], float] = lambda k: 1.0, missed: tuple[int, ...] = ()
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the rows and the true states (PlantState) at the start of each cycle."""
        rows, states = np.zeros((cycles, len(CHANNELS))), np.zeros((cycles, 7))
        for k in range(cycles):
            states[k] = self.rig.plant
            y = self.measured = self.rig.exchange(*self.sent)
            if k in missed:
                self.sent = self.controller.missed(rows[k], mode, blend(k))
                continue
            self.sent = self.controller.tick(
                y.link_position, y.motor_position, y.stiffness_position, y.motor_torque, y.stiffness_torque,
                mode, blend(k), rows[k],
            )  # fmt: skip
        return rows, states

    def enable(self) -> None:
        """Bring both drives into operation, without torque."""
        for axis in AXES:
            self.rig.arm(axis)
        self.run(6, READING)

    def arm(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Close the loops over 100 ms where the rig is; return rows and states of that time."""
        self.enable()
        y = self.measured
        self.controller.begin(y.link_position, y.motor_position, y.stiffness_position)
        cycles = round(0.1 / self.period)
        return self.run(cycles, CLOSED, lambda k: k / cycles)

    def install(self, tuning: Tuning, tuning_id: int) -> None:
        self.controller.install(tuning, prepare(tuning, self.period), tuning_id)
