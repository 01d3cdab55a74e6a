"""One session's closed loop: the arrays that the compiled tick works on, and how live changes reach them."""

import numpy as np
from numpy.typing import NDArray

from vssea_core.control.tuning import Tuning
from vssea_core.scenario import Scenario
from vssea_core.signals.disturbances import disturbance_tables
from vssea_core.signals.documents import Disturbances, Reference, StiffnessReference
from vssea_core.signals.references import TRANSITION_SIZE, change_reference, reference_row
from vssea_core.signals.stiffness import slew_row
from vssea_core.simulation.kernel import ENDINGS, run
from vssea_core.simulation.state import TRANSITION, equilibrium_state, inputs_of

Numbers = NDArray[np.float64]


class Engine:
    """The closed loop of one scenario, advanced sample by sample."""

    def __init__(self, scenario: Scenario, prepared: Numbers, tuning_id: int) -> None:
        self._scenario = scenario
        self._prepared = self._before = prepared
        self._tuning_id = float(tuning_id)
        self.restart()

    @property
    def period_s(self) -> float:
        """Sample time."""
        return self._scenario.timing.sample_time_s

    @property
    def time_s(self) -> float:
        """Time of the next sample."""
        return self._sample * self.period_s

    def restart(self) -> None:
        """Go back to t = 0, in equilibrium. Raises ValueError if the spring cannot carry the load at t = 0."""
        state = equilibrium_state(self._scenario)
        inputs = inputs_of(self._scenario)
        self._state, self._sample, self.enabled = state, 0, True
        self._rig, self._terms = inputs.rig, (inputs.link_terms, inputs.motor_terms, inputs.stiffness_terms)
        self._reference = reference_row(self._scenario.reference)
        self._slew = self._slewing(0.0)

    def _slewing(self, set_at_s: float) -> Numbers:
        scenario = self._scenario
        return slew_row(
            scenario.stiffness_reference, scenario.tuning, scenario.actuator.stiffness, self.period_s, set_at_s
        )

    def install(self, tuning: Tuning, prepared: Numbers, tuning_id: int) -> None:
        """Use another tuning from the next sample on; the observer's last period stays with the old one."""
        set_at_s = self._slew[5]
        self._scenario = self._scenario.model_copy(update={"tuning": tuning})
        self._prepared, self._tuning_id = prepared, float(tuning_id)
        self._slew = self._slewing(set_at_s)

    def set_reference(self, reference: Reference) -> None:
        """Follow another reference from the next sample on, position and four derivatives continuous."""
        row = reference_row(reference, self.time_s)
        transition = self._state[TRANSITION : TRANSITION + TRANSITION_SIZE]
        change_reference(self._reference, row, self.time_s, transition)
        self._scenario = self._scenario.model_copy(update={"reference": reference})
        self._reference = row

    def set_stiffness(self, reference: StiffnessReference) -> None:
        """Command another stiffness from the next sample on."""
        self._scenario = self._scenario.model_copy(update={"stiffness_reference": reference})
        self._slew = self._slewing(self.time_s)

    def set_disturbances(self, disturbances: Disturbances) -> None:
        """Apply other disturbances from the next sample on."""
        self._scenario = self._scenario.model_copy(update={"disturbances": disturbances})
        self._terms = disturbance_tables(disturbances, self.period_s, self._scenario.seed)

    def advance(self, rows: Numbers) -> tuple[int, str | None]:
        """Advance by as many samples as `rows` (n, columns) has; return how many went well, and a fault's reason."""
        done, end = run(
            self._rig, self._before, self._prepared, self._reference, self._slew, *self._terms,
            self.enabled, self._tuning_id, self._state, self._sample, len(rows), rows,
        )  # fmt: skip
        self._before = self._prepared
        self._sample += done
        return done, ENDINGS.get(end)
