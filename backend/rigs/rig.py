"""What a rig is to the loop: two torque axes and a link encoder, exchanged once a cycle.

Nothing blocks between `configure` and `close` but `exchange`, and that for one cycle at most. `arm`, `stop` and `disarm`
only say where an axis is to go; the exchanges that follow take it there, and `axis` says where it is.
"""

from dataclasses import dataclass
from typing import Literal, NamedTuple, Protocol

from backend.rigs.faults import Fault

RigKind = Literal["simulated", "emulated", "real"]
Axis = Literal["motor", "stiffness"]
AXES: tuple[Axis, Axis] = ("motor", "stiffness")
AxisState = Literal["unknown", "disabled", "enabling", "enabled", "stopping", "fault"]


class Measured(NamedTuple):
    """What one cycle brought, gear side and SI; an age counts the cycles since a value was new, 0 = of this cycle."""

    link_position: float
    motor_position: float
    stiffness_position: float  # from the place where the rig was switched on, until homed; then theta_ms itself
    link_age: int
    motor_age: int
    stiffness_age: int
    motor_torque: float  # what the drives took over at the start of this cycle, after rounding to their unit [N m]
    stiffness_torque: float
    motor_torque_seen: float  # what the drives say they give [N m]
    stiffness_torque_seen: float


@dataclass(frozen=True)
class AxisStatus:
    """One drive in words: its CiA 402 state, the status word, and what ails it."""

    axis: Axis
    state: AxisState
    words: str  # such as "operation enabled"
    status_word: int = 0
    error_code: int = 0  # the newest emergency object's, 0 = none
    error_words: str = ""


@dataclass(frozen=True)
class Identity:
    """Who answered: what the drives and the encoder say of themselves."""

    kind: RigKind
    name: str
    devices: tuple[
        tuple[str, str], ...
    ] = ()  # ("motor drive, node 1", "EPOS4 Module 50/8, serial 12345, rated 0.53 N·m")


@dataclass(frozen=True)
class BusHealth:
    """Figures of the exchange since the rig was connected."""

    cycles: int = 0
    late_answers: int = 0  # cycles in which something came too late
    round_trip_us: float = 0.0  # from SYNC to the last answer, of the last cycle


class RigError(Exception):
    """A rig that cannot do what was asked; `fault` says which, `str()` is a sentence with what to do."""

    def __init__(self, fault: Fault, detail: str = "") -> None:
        self.fault, self.detail = fault, detail
        super().__init__(fault.sentence(detail))


class Rig(Protocol):
    """A rig. Every method but `close` may raise RigError."""

    period_s: float

    def connect(self) -> None:
        """Open the bus and find every node."""

    def identify(self) -> Identity:
        """Return who answered, compared with what the rig's file expects."""

    def configure(self) -> None:
        """Write what the file and the safety of the drives ask for, read it back, and start the cyclic exchange."""

    def home(self, stiffness_offset: float) -> None:
        """Take `stiffness_offset` [rad] off the stiffness motor's position from now on."""

    def arm(self, axis: Axis) -> None:
        """Let an axis go to "enabled"; never out of a fault."""

    def stop(self, axis: Axis) -> None:
        """Let the drive stop an axis by itself (quick stop), for when there is no measurement to brake with."""

    def disarm(self, axis: Axis) -> None:
        """Let an axis go to "disabled"."""

    def reset(self, axis: Axis) -> None:
        """Ask the drive once to leave its fault; it stays disabled."""

    def exchange(self, motor_torque: float, stiffness_torque: float) -> Measured:
        """Send torques [N m, gear side], return what was measured as they took effect."""

    def axis(self, axis: Axis) -> AxisStatus:
        """Return where an axis is."""

    def bus_faults(self) -> tuple[tuple[Fault, str], ...]:
        """Return what went wrong on the bus since the last call: each fault with its detail."""

    def health(self) -> BusHealth:
        """Return the figures of the exchange."""

    def close(self) -> None:
        """Disable both axes if they answer, then close the bus. Never raises."""
