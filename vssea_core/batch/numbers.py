"""A scenario as the numbers that its run reads; those of a part that another run had too are taken over."""

from collections import OrderedDict
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vssea_core.batch.lanes import Variant
from vssea_core.control.law import GAINS, POSITION_FORM, SLIDING_MODE, TANH, Law
from vssea_core.control.packing import TABLE_AT
from vssea_core.control.prepared import prepare
from vssea_core.control.tuning import Tuning
from vssea_core.scenario import Scenario
from vssea_core.signals.disturbances import SINE
from vssea_core.signals.references import reference_row
from vssea_core.signals.stiffness import Slew, slew_row
from vssea_core.simulation.state import (
    DELAY_AT,
    DELAY_SIZE,
    ENCODERS_AT,
    ENCODERS_SIZE,
    NOISE_AT,
    NOISE_SIZE,
    SLEWED,
    Inputs,
    equilibrium_state,
    inputs_of,
)  # fmt: skip

Numbers = NDArray[np.float64]
KEPT = 4096
"""Prepared tunings that are kept for the runs that share them."""
SLEW_TO = Slew._fields.index("theta_to")
_OBSERVER_AT, _PREDICT_AT, _SWITCH_AT = (
    Law._fields.index(name) - GAINS for name in ("observer", "predict", "switch")
)  # fmt: skip


@dataclass(frozen=True)
class RunNumbers:
    """What a run of `count` samples reads; `variant` is the kernel that can run it in a lane, None if it is run alone."""

    scenario: Scenario
    count: int
    inputs: Inputs
    prepared: Numbers
    reference: Numbers
    slew: Numbers
    state: Numbers
    variant: Variant | None

    @property
    def delayed(self) -> bool:
        """Whether each torque acts a sample later."""
        return self.scenario.timing.compute_delay_samples != 0

    @property
    def is_scheduled(self) -> bool:
        """Whether gains follow the stiffness."""
        return bool(self.prepared[TABLE_AT] > 1.0)

    @property
    def course(self) -> bytes:
        """What its course depends on besides the period: runs with the same share one."""
        inputs = self.inputs
        parts = (self.reference, self.slew[:6], inputs.link_terms, inputs.motor_terms)
        return b"|".join(part.tobytes() for part in parts)


class NumbersOf:
    """Makes the RunNumbers of scenarios."""

    def __init__(self) -> None:
        self._prepared: OrderedDict[tuple[int, float, float, float], tuple[Tuning, Numbers]] = OrderedDict()

    def __call__(self, scenario: Scenario) -> RunNumbers:
        """Return the numbers of `scenario`. Raises ValueError if it cannot start or a design has no solution."""
        period, mechanism = scenario.timing.sample_time_s, scenario.actuator.stiffness
        inputs = inputs_of(scenario)
        prepared = self._prepared_of(scenario.tuning, period, (mechanism.softest, mechanism.stiffest))
        slew = slew_row(scenario.stiffness_reference, scenario.tuning, mechanism, period)
        state = equilibrium_state(scenario, inputs)
        return RunNumbers(
            scenario,
            max(1, round(scenario.duration_s / period)),
            inputs,
            prepared,
            reference_row(scenario.reference),
            slew,
            state,
            variant_of(scenario, inputs, prepared, slew, state),
        )

    def _prepared_of(self, tuning: Tuning, period_s: float, stiffnesses: tuple[float, float]) -> Numbers:
        key = (id(tuning), period_s, *stiffnesses)
        found = self._prepared.get(key)
        if found is None:
            found = self._prepared[key] = (
                tuning,
                prepare(tuning, period_s, stiffnesses),
            )  # the tuning stays: so does its id
            if len(self._prepared) > KEPT:
                self._prepared.popitem(last=False)
        return found[1]


def variant_of(scenario: Scenario, inputs: Inputs, prepared: Numbers, slew: Numbers, state: Numbers) -> Variant | None:
    """Return the kernel in whose lanes a scenario can run; None for what few runs need, and lanes leave out."""
    rig = inputs.rig
    is_late, is_noisy = rig[DELAY_AT : DELAY_AT + DELAY_SIZE].any(), rig[NOISE_AT + NOISE_SIZE - 1] != 0.0
    is_loaded_otherwise = (
        len(inputs.stiffness_terms) or (inputs.link_terms[:, 0] > SINE).any() or (inputs.motor_terms[:, 0] > SINE).any()
    )
    if scenario.sequence or is_late or is_noisy or is_loaded_otherwise or prepared[_SWITCH_AT] == TANH:
        return None
    return Variant(
        bool(prepared[_OBSERVER_AT] == POSITION_FORM),
        bool(prepared[_PREDICT_AT]) and scenario.timing.compute_delay_samples != 0,
        bool(prepared[0] == SLIDING_MODE),
        bool(rig[ENCODERS_AT : ENCODERS_AT + ENCODERS_SIZE].any()),
        scenario.actuator.motor.coulomb_friction != 0.0,
        scenario.stiffness_reference.kind != "constant" or state[SLEWED] != slew[SLEW_TO],
    )
