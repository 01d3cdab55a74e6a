"""A sentence of the paper as something that is measured and can fail."""

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from vssea_core.scenario import Scenario
from vssea_core.simulation.run import simulate
from vssea_core.simulation.trajectory import Trajectory

Relation = Literal["at least", "at most"]


@dataclass(frozen=True)
class Run:
    """A scenario and what it gave."""

    scenario: Scenario
    trajectory: Trajectory

    def __getitem__(self, channel: str) -> NDArray[np.float64]:
        """Return one channel (samples,)."""
        return self.trajectory[channel]


Runs = Mapping[str, Run]


@dataclass(frozen=True)
class Number:
    """One measured number; with a relation and a limit it is part of the claim's criterion."""

    label: str
    value: float
    unit: str = ""
    relation: Relation | None = None
    limit: float = math.nan

    @property
    def met(self) -> bool:
        """Whether the number is within its limit; one without a limit is only reported."""
        if self.relation is None:
            return True
        return self.value >= self.limit if self.relation == "at least" else self.value <= self.limit

    @property
    def text(self) -> str:
        """The value to three digits, with its unit."""
        return with_unit(self.value, self.unit)

    @property
    def criterion(self) -> str:
        """The limit in words; empty if there is none."""
        return "" if self.relation is None else f"{self.relation} {with_unit(self.limit, self.unit)}"


def with_unit(value: float, unit: str) -> str:
    """Return `value` to three significant digits with its unit, such as `11.1 rad`."""
    digits = f"{value:.3g}"
    if 1000.0 <= abs(value) < 1e6:
        digits = f"{float(digits):.0f}"
    return f"{digits} {unit}".strip()


@dataclass(frozen=True)
class Claim:
    """What the paper says (`source` is ours where it is our own), what is measured for it, and from which scenarios.

    `note` says what the sentence does not hold for, or at what price it holds.
    """

    number: int
    name: str
    source: str
    sentence: str
    measured: str
    scenarios: tuple[str, ...]
    measure: Callable[[Runs], tuple[Number, ...]]
    note: str = ""


@dataclass(frozen=True)
class Verdict:
    """A claim with its numbers; `ending` says which run broke off, if one did."""

    claim: Claim
    numbers: tuple[Number, ...]
    ending: str | None = None

    @property
    def passed(self) -> bool:
        """Whether every number with a limit is within it, and every run went to its end."""
        return self.ending is None and all(number.met for number in self.numbers)


def run_all(scenarios: Mapping[str, Scenario], tell: Callable[[float, str], object]) -> dict[str, Run]:
    """Return the run of each scenario by name; `tell` hears the share done [0, 1] and the name before each."""
    runs = {}
    for index, (name, scenario) in enumerate(scenarios.items()):
        tell(index / len(scenarios), name)
        runs[name] = Run(scenario, simulate(scenario))
    return runs


def judge(claims: Iterable[Claim], runs: Runs) -> tuple[Verdict, ...]:
    """Return the Verdict on each claim. Raises KeyError if a scenario that it needs was not run."""
    return tuple(_verdict(claim, runs) for claim in claims)


def _verdict(claim: Claim, runs: Runs) -> Verdict:
    used = {name: runs[name] for name in claim.scenarios}
    for name, run in used.items():
        if run.trajectory.ending is not None:
            return Verdict(claim, (), f"{name} {run.trajectory.ending}")
    return Verdict(claim, claim.measure(used))
