"""The closed loop of one scenario, advanced piece by piece: what a simulation and a live session both run.

It keeps the arrays of the compiled tick, takes changes between two samples, and makes those of the scenario's sequence by
itself at their time.
"""

import numpy as np
from numpy.typing import NDArray

from vssea_core.control.tuning import Tuning
from vssea_core.scenario import Scenario
from vssea_core.signals.disturbances import disturbance_tables
from vssea_core.signals.documents import Disturbances, Reference, StiffnessReference
from vssea_core.signals.references import TRANSITION_SIZE, change_reference, reference_row
from vssea_core.signals.stiffness import slew_row
from vssea_core.simulation.kernel import ENDINGS, run
from vssea_core.simulation.plan import Follower, PreparedRun
from vssea_core.simulation.state import TRANSITION, equilibrium_state, inputs_of

Numbers = NDArray[np.float64]


class ClosedLoop:
    """The closed loop of `scenario`, from equilibrium at t = 0."""

    def __init__(self, scenario: Scenario, planned: PreparedRun, tuning_id: int = 1) -> None:
        self.scenario = scenario
        self._prepared = self._before = planned.prepared
        self._planned = planned
        self.tuning_id = tuning_id
        self.restart()

    @property
    def period_s(self) -> float:
        """Sample time."""
        return self.scenario.timing.sample_time_s

    @property
    def time_s(self) -> float:
        """Time of the next sample."""
        return self._sample * self.period_s

    def restart(self) -> None:
        """Go back to t = 0, in equilibrium. Raises ValueError if the spring cannot carry the load at t = 0."""
        state = equilibrium_state(self.scenario)
        inputs = inputs_of(self.scenario)
        self._state, self._sample, self.enabled = state, 0, True
        self._rig, self._terms = inputs.rig, (inputs.link_terms, inputs.motor_terms, inputs.stiffness_terms)
        self._reference = reference_row(self.scenario.reference)
        self._slew = self._slewing(0.0)
        self._left = list(self._planned.followers)
        self.passed: list[Follower] = []

    def _slewing(self, set_at_s: float) -> Numbers:
        scenario = self.scenario
        return slew_row(
            scenario.stiffness_reference, scenario.tuning, scenario.actuator.stiffness, self.period_s, set_at_s
        )

    def plan(self, followers: tuple[Follower, ...]) -> None:
        """Replace what is left of the sequence."""
        self._planned = PreparedRun(self._prepared, followers)
        self._left = [follower for follower in followers if self._sample_of(follower) >= self._sample]

    def install(self, tuning: Tuning, prepared: Numbers, tuning_id: int) -> None:
        """Use another tuning from the next sample on; the observer's last period stays with the old one."""
        set_at_s = self._slew[5]
        self.scenario = self.scenario.model_copy(update={"tuning": tuning})
        self._prepared, self.tuning_id = prepared, tuning_id
        self._slew = self._slewing(set_at_s)

    def set_reference(self, reference: Reference) -> None:
        """Follow another reference from the next sample on, position and four derivatives continuous."""
        row = reference_row(reference, self.time_s)
        transition = self._state[TRANSITION : TRANSITION + TRANSITION_SIZE]
        change_reference(self._reference, row, self.time_s, transition)
        self.scenario = self.scenario.model_copy(update={"reference": reference})
        self._reference = row

    def set_stiffness(self, reference: StiffnessReference) -> None:
        """Command another stiffness from the next sample on."""
        self.scenario = self.scenario.model_copy(update={"stiffness_reference": reference})
        self._slew = self._slewing(self.time_s)

    def set_disturbances(self, disturbances: Disturbances) -> None:
        """Apply other disturbances from the next sample on."""
        self.scenario = self.scenario.model_copy(update={"disturbances": disturbances})
        self._terms = disturbance_tables(disturbances, self.period_s, self.scenario.seed)

    def advance(self, rows: Numbers) -> tuple[int, str | None]:
        """Advance by as many samples as `rows` (n, columns) has; return how many went well, and why it could not go on."""
        done = 0
        while done < len(rows):
            self._make_due_changes()
            until = len(rows)
            if self._left:
                until = min(until, done + self._sample_of(self._left[0]) - self._sample)
            part = rows[done:until]
            went, end = run(
                self._rig, self._before, self._prepared, self._reference, self._slew, *self._terms,
                self.enabled, float(self.tuning_id), self._state, self._sample, len(part), part,
            )  # fmt: skip
            self._before = self._prepared
            self._sample += went
            done += went
            if end in ENDINGS:
                return done, ENDINGS[end]
        return done, None

    def _sample_of(self, follower: Follower) -> int:
        """Return the first sample at or after the follower's time; sample times are k T in floating point."""
        return int(np.ceil(follower.at_s / self.period_s - 1e-6))

    def _make_due_changes(self) -> None:
        """Make the changes of the sequence that are in force from the next sample on."""
        while self._left and self._sample_of(self._left[0]) <= self._sample:
            follower = self._left.pop(0)
            before, after = self.scenario, follower.scenario
            if after.tuning != before.tuning:
                self.install(after.tuning, follower.prepared, self.tuning_id + 1)
            if after.reference != before.reference:
                self.set_reference(after.reference)
            if after.stiffness_reference != before.stiffness_reference:
                self.set_stiffness(after.stiffness_reference)
            if after.disturbances != before.disturbances:
                self.set_disturbances(after.disturbances)
            self.passed.append(follower)
