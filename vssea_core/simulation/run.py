"""A scenario simulated, whole: `simulate(scenario) -> Trajectory`."""

import numpy as np

from vssea_core.channels import CHANNELS
from vssea_core.control.prepared import prepare
from vssea_core.scenario import Scenario
from vssea_core.signals.references import reference_row
from vssea_core.signals.stiffness import slew_row
from vssea_core.simulation.kernel import ENDINGS, RUNNING, run
from vssea_core.simulation.state import equilibrium_state, inputs_of
from vssea_core.simulation.trajectory import Trajectory


def simulate(scenario: Scenario) -> Trajectory:
    """Return the trajectory of `scenario`, every sample.

    A diverging run is not an error: it ends early and the trajectory's `ending` says why. Raises ValueError if the
    scenario cannot start (see equilibrium_state).
    """
    period = scenario.timing.sample_time_s
    count = max(1, round(scenario.duration_s / period))
    inputs = inputs_of(scenario)
    prepared = prepare(scenario.tuning, period)
    rows = np.empty((count, len(CHANNELS)))
    done, end = run(
        inputs.rig,
        prepared,
        prepared,
        reference_row(scenario.reference),
        slew_row(scenario.stiffness_reference, scenario.tuning, scenario.actuator.stiffness, period),
        inputs.link_terms,
        inputs.motor_terms,
        inputs.stiffness_terms,
        True,
        1.0,
        equilibrium_state(scenario),
        0,
        count,
        rows,
    )
    kept = rows if end == RUNNING else rows[: done + 1]
    ending = None if end == RUNNING else f"stopped at t = {done * period:.3f} s: {ENDINGS[end]}"
    return Trajectory(kept, period, ending)
