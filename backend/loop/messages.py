"""What travels between web process and control process: small frozen dataclasses, commands down and reports up."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from vssea_core.control.tuning import Tuning
from vssea_core.scenario import Scenario
from vssea_core.signals.documents import Disturbances, Reference, StiffnessReference
from vssea_core.simulation.plan import Follower, PreparedRun

State = Literal["starting", "ready", "running", "paused", "stopped", "fault"]


@dataclass(frozen=True)
class Load:
    """Restart with another scenario, at t = 0; `run` starts it at once."""

    scenario: Scenario
    planned: PreparedRun
    tuning_id: int
    run: bool


@dataclass(frozen=True)
class Install:
    """Swap the tuning, whole, before the next tick."""

    tuning: Tuning
    prepared: NDArray[np.float64]
    tuning_id: int


@dataclass(frozen=True)
class Plan:
    """Replace what is left of the scenario's sequence."""

    followers: tuple[Follower, ...]


@dataclass(frozen=True)
class SetReference:
    """Follow another reference, without a jump."""

    reference: Reference


@dataclass(frozen=True)
class SetStiffness:
    """Command another stiffness."""

    reference: StiffnessReference


@dataclass(frozen=True)
class SetDisturbances:
    """Apply other disturbances."""

    disturbances: Disturbances


@dataclass(frozen=True)
class Pause:
    """Hold time."""


@dataclass(frozen=True)
class Resume:
    """Let time run."""


@dataclass(frozen=True)
class Step:
    """Advance a paused session by some samples."""

    samples: int


@dataclass(frozen=True)
class Reset:
    """Back to t = 0; the only way out of a stop or a fault."""


@dataclass(frozen=True)
class SetPace:
    """Ask for another real-time factor."""

    factor: float


Command = (
    Load | Install | Plan | SetReference | SetStiffness | SetDisturbances | Pause | Resume | Step | Reset | SetPace
)


@dataclass(frozen=True)
class Ready:
    """The kernels are compiled; the loop turns."""


@dataclass(frozen=True)
class Done:
    """A command took effect, from the sample at `time_s` on."""

    number: int
    time_s: float


@dataclass(frozen=True)
class Refused:
    """A command was refused, and why; nothing changed."""

    number: int
    sentence: str


@dataclass(frozen=True)
class Changed:
    """The session's state changed at `time_s`."""

    state: State
    reason: str | None
    epoch: int
    time_s: float


@dataclass(frozen=True)
class Followed:
    """A change of the scenario's sequence took effect."""

    index: int
    time_s: float
    tuning_id: int


Report = Ready | Done | Refused | Changed | Followed
