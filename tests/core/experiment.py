"""A scenario that is run in pieces, so that a test can change something in between or start from any state."""

import numpy as np

from vssea_core.actuator.drive import Drives
from vssea_core.actuator.dynamics import Plant, PlantState
from vssea_core.actuator.parameters import Timing
from vssea_core.actuator.sensors import Encoders
from vssea_core.channels import CHANNELS
from vssea_core.control.prepared import prepare
from vssea_core.control.tuning import Tuning
from vssea_core.scenario import Scenario
from vssea_core.signals.references import reference_row
from vssea_core.signals.stiffness import slew_row
from vssea_core.simulation.kernel import RUNNING, run
from vssea_core.simulation.state import PLANT, equilibrium_state, inputs_of, rig_numbers
from vssea_core.simulation.trajectory import Trajectory

NO_TORQUE = Drives(0.0, 0.0, 1e12, 0.0, 0.0, 0.0, 1e12, 0.0, 1e12)


class Experiment:
    """State and inputs of a scenario; `advance` runs the kernel on from where it is."""

    def __init__(self, scenario: Scenario) -> None:
        self.scenario, self.period = scenario, scenario.timing.sample_time_s
        self.inputs, self.rig = inputs_of(scenario), inputs_of(scenario).rig
        self.reference = reference_row(scenario.reference)
        self.tuning = prepare(scenario.tuning, self.period)
        self.state, self.sample = equilibrium_state(scenario), 0

    def fork(self) -> "Experiment":
        """Return an independent copy at the same instant."""
        other = Experiment(self.scenario)
        other.state, other.sample, other.tuning, other.rig = self.state.copy(), self.sample, self.tuning, self.rig
        return other

    def advance(self, count: int, tuning: Tuning | None = None) -> Trajectory:
        """Run `count` samples, with `tuning` in force from the first of them if it is given."""
        before = self.tuning
        if tuning is not None:
            self.tuning = prepare(tuning, self.period)
        rows = np.empty((count, len(CHANNELS)))
        scenario, inputs = self.scenario, self.inputs
        slew = slew_row(scenario.stiffness_reference, scenario.tuning, scenario.actuator.stiffness, self.period)
        terms = inputs.link_terms, inputs.motor_terms, inputs.stiffness_terms
        _, end = run(
            self.rig, before, self.tuning, self.reference, slew, *terms, True, 1.0, self.state, self.sample, count, rows
        )
        self.sample += count
        assert end == RUNNING
        return Trajectory(rows, self.period)


def coasting(plant: Plant, start: PlantState, count: int, period: float = 1e-3) -> Trajectory:
    """Return `count` samples of `plant` from `start` with both motors without torque: no controller, no load."""
    scenario = Scenario()
    experiment = Experiment(scenario)
    experiment.period = period
    timing = Timing(sample_time_s=period)
    experiment.rig = rig_numbers(plant, NO_TORQUE, Encoders(0.0, 0.0, 0.0), 0.0, timing)
    experiment.tuning = prepare(scenario.tuning, period)
    experiment.state[:PLANT] = start
    return experiment.advance(count)
