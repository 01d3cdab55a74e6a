"""What travels between web process and control process: small frozen dataclasses, commands down and reports up."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from backend.rigs.rig import Axis, AxisState, Identity, RigKind
from backend.rigs.rig_file import RigFile
from vssea_core.control.tuning import Tuning
from vssea_core.scenario import Scenario
from vssea_core.signals.documents import Disturbances, Reference, StiffnessReference
from vssea_core.simulation.plan import Follower, PreparedRun

State = Literal[
    "starting", "ready", "running", "paused", "stopped", "fault", "connected", "homing", "armed", "stopping"
]
"""A simulated session is starting, ready, running, paused, stopped or at fault. A rig is connected (not homed), homing, ready
(homed, drives off), armed (holding), running (moving), stopping (braking), stopped or at fault."""

JOG_LASTS_S = 0.3
"""A jog ends this long after its renewal was sent."""


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


@dataclass(frozen=True)
class Connect:
    """Open a rig, check who answers, configure it; then measure. The scenario is the rig's, with the tuning to begin with."""

    rig: RigFile
    scenario: Scenario
    prepared: NDArray[np.float64]
    tuning_id: int


@dataclass(frozen=True)
class Home:
    """Find both end stops of the stiffness axis; from connected or ready."""


@dataclass(frozen=True)
class Arm:
    """Close the loops, bumplessly, holding where the rig is; from ready, refused with reasons."""


@dataclass(frozen=True)
class Disarm:
    """Come to rest, open the loops, back to ready; the operator's own quiet end."""


@dataclass(frozen=True)
class Follow:
    """Follow the reference that was set; from armed."""


@dataclass(frozen=True)
class Hold:
    """Come to rest and hold; from running."""


@dataclass(frozen=True)
class Jog:
    """Move with a velocity for as long as this is renewed: link [rad/s], stiffness [N m/rad/s]. 0, 0 = let go.

    `sent_s` is time.monotonic() of the sender; an old one is dropped, never made up for.
    """

    link: float
    stiffness: float
    sent_s: float


@dataclass(frozen=True)
class GoTo:
    """Move the link to a position [rad] within `speed` [rad/s] and the rig's acceleration, jerk and snap; from armed."""

    position: float
    speed: float


@dataclass(frozen=True)
class Disconnect:
    """Stop, disable, close the bus; the process ends."""


Command = (
    Connect
    | Home
    | Arm
    | Disarm
    | Follow
    | Hold
    | Jog
    | GoTo
    | Disconnect
    | Load
    | Install
    | Plan
    | SetReference
    | SetStiffness
    | SetDisturbances
    | Pause
    | Resume
    | Step
    | Reset
    | SetPace
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


@dataclass(frozen=True)
class AxisReport:
    """One drive as the page shows it."""

    axis: Axis
    state: AxisState
    words: str
    status_word: int
    error_code: int
    error_words: str
    age: int
    torque: float
    torque_seen: float


@dataclass(frozen=True)
class LatchedFault:
    """A fault that latched, and whether its cause still stands."""

    number: int
    name: str
    sentence: str
    at_s: float
    stands: bool


@dataclass(frozen=True)
class RigReport:
    """How the rig is, ten times a second and at each change of state."""

    kind: RigKind
    homed: bool
    span_found: float | None
    motion: str  # what the link does, in words: "holding 0.312 rad", "jogging 0.30 rad/s", "tracking"
    cannot_arm: tuple[str, ...]  # why arming would be refused now; empty = it would not
    axes: tuple[AxisReport, ...]
    link_age: int
    faults: tuple[LatchedFault, ...]
    cycles: int
    late_answers: int
    missed_cycles: int
    round_trip_us: float
    lease_left_s: float
    identity: Identity


@dataclass(frozen=True)
class Moved:
    """The reference or the stiffness reference in force is another one, by jog, go-to, hold, follow or arming."""

    part: Literal["reference", "stiffness_reference"]
    scenario: Scenario
    time_s: float
    why: str


Report = RigReport | Moved | Ready | Done | Refused | Changed | Followed
