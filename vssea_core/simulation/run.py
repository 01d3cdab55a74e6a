"""A scenario simulated, whole: `simulate(scenario) -> Trajectory`."""

import numpy as np

from vssea_core.channels import CHANNELS
from vssea_core.control.prepared import prepare
from vssea_core.scenario import Scenario, after_changes
from vssea_core.simulation.closed_loop import ClosedLoop
from vssea_core.simulation.plan import Follower, PreparedRun
from vssea_core.simulation.trajectory import Trajectory


def prepare_scenario(scenario: Scenario) -> PreparedRun:
    """Return the numbers of the scenario's tuning, and of each change of its sequence.

    Raises ValueError if a design has no solution.
    """
    period, mechanism = scenario.timing.sample_time_s, scenario.actuator.stiffness
    stiffnesses = mechanism.softest, mechanism.stiffest
    prepared = prepare(scenario.tuning, period, stiffnesses)
    followers: list[Follower] = []
    tuning, numbers = scenario.tuning, prepared
    for index, (at_s, after) in enumerate(after_changes(scenario)):
        if after.tuning != tuning:
            tuning, numbers = after.tuning, prepare(after.tuning, period, stiffnesses)
        followers.append(Follower(at_s, index, after, numbers))
    return PreparedRun(prepared, tuple(followers))


def simulate(scenario: Scenario, tuning_id: int = 1) -> Trajectory:
    """Return the trajectory of `scenario`, every sample; its tuning has number `tuning_id`, the next one of its sequence one more.

    A diverging run is not an error: it ends early and the trajectory's `ending` says why. Raises ValueError if the
    scenario cannot start (see equilibrium_state) or a design has no solution.
    """
    period = scenario.timing.sample_time_s
    rows = np.empty((max(1, round(scenario.duration_s / period)), len(CHANNELS)))
    done, reason = ClosedLoop(scenario, prepare_scenario(scenario), tuning_id).advance(rows)
    if reason is None:
        return Trajectory(rows, period)
    return Trajectory(rows[: done + 1], period, f"stopped at t = {done * period:.3f} s: {reason}")
