"""A scenario as the numbers that its run reads; those of a part that another run had too are taken over."""

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from vssea_core.batch.lanes import Variant
from vssea_core.control.law import GAINS, POSITION_FORM, SLIDING_MODE, TANH, Law
from vssea_core.control.packing import TABLE_AT
from vssea_core.control.prepared import prepare
from vssea_core.scenario import Scenario
from vssea_core.signals.disturbances import SINE, disturbance_tables
from vssea_core.signals.documents import Disturbances
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
    rig_row,
)  # fmt: skip

Result = TypeVar("Result")
Numbers = NDArray[np.float64]
KEPT = 1024
"""Of what is made of a part, so many are kept for the runs that share the part."""
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

    @cached_property
    def course(self) -> tuple[bytes, bytes, bytes]:
        """What reference, stiffness command and loads depend on besides the period: runs with the same share them."""
        inputs = self.inputs
        loads = inputs.link_terms.tobytes() + b"|" + inputs.motor_terms.tobytes()
        return self.reference.tobytes(), self.slew[:6].tobytes(), loads


class NumbersOf:
    """Makes the RunNumbers of scenarios."""

    def __init__(self) -> None:
        self._prepared = OfParts(prepare)
        self._loads = OfParts(Loads.of)
        self._reference_row = OfParts(reference_row)

    def __call__(self, scenario: Scenario) -> RunNumbers:
        """Return the numbers of `scenario`. Raises ValueError if it cannot start or a design has no solution."""
        period, mechanism = scenario.timing.sample_time_s, scenario.actuator.stiffness
        loads = self._loads(scenario.disturbances, period, scenario.seed)
        inputs = Inputs(rig_row(scenario), *loads.tables)
        prepared = self._prepared(scenario.tuning, period, (mechanism.softest, mechanism.stiffest))
        slew = slew_row(scenario.stiffness_reference, scenario.tuning, mechanism, period)
        state = equilibrium_state(scenario, inputs)
        fits = loads.are_plain and not scenario.sequence
        return RunNumbers(
            scenario,
            max(1, round(scenario.duration_s / period)),
            inputs,
            prepared,
            self._reference_row(scenario.reference),
            slew,
            state,
            variant_of(scenario, inputs.rig, prepared, slew, state) if fits else None,
        )


class OfParts(Generic[Result]):
    """What is made of a part of a scenario, made once for all scenarios that share the part."""

    def __init__(self, make: Callable[..., Result]) -> None:
        self._make = make
        self._made: OrderedDict[tuple[Any, ...], tuple[Any, Result]] = OrderedDict()

    def __call__(self, part: Any, *rest: Any) -> Result:
        """Return what is made of `part` and `rest`."""
        key = id(part), *rest
        found = self._made.get(key)
        if found is None:
            found = self._made[key] = part, self._make(part, *rest)  # the part stays: so does its id
            if len(self._made) > KEPT:
                self._made.popitem(last=False)
        return found[1]


class Loads(NamedTuple):
    """The disturbance terms of link, motor and stiffness motor, and whether lanes know all of them."""

    tables: tuple[Numbers, Numbers, Numbers]
    are_plain: bool

    @classmethod
    def of(cls, disturbances: Disturbances, sample_time_s: float, seed: int) -> "Loads":
        """Return those of a scenario."""
        link, motor, stiffness = tables = disturbance_tables(disturbances, sample_time_s, seed)
        return cls(tables, bool(len(stiffness) == 0 and (link[:, 0] <= SINE).all() and (motor[:, 0] <= SINE).all()))


def variant_of(scenario: Scenario, rig: Numbers, prepared: Numbers, slew: Numbers, state: Numbers) -> Variant | None:
    """Return the kernel in whose lanes a scenario can run; None for what few runs need, and lanes leave out."""
    is_late, is_noisy = rig[DELAY_AT : DELAY_AT + DELAY_SIZE].any(), rig[NOISE_AT + NOISE_SIZE - 1] != 0.0
    if is_late or is_noisy or prepared[_SWITCH_AT] == TANH:
        return None
    return Variant(
        bool(prepared[_OBSERVER_AT] == POSITION_FORM),
        bool(prepared[_PREDICT_AT]) and scenario.timing.compute_delay_samples != 0,
        bool(prepared[0] == SLIDING_MODE),
        bool(rig[ENCODERS_AT : ENCODERS_AT + ENCODERS_SIZE].any()),
        scenario.actuator.motor.coulomb_friction != 0.0,
        scenario.stiffness_reference.kind != "constant" or state[SLEWED] != slew[SLEW_TO],
    )
