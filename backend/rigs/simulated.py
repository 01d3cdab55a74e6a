"""A rig in memory: the compiled plant, encoders and torque lag of a scenario behind the protocol of a rig, without a clock.

An exchange passes one cycle in no time. Its drives obey as CiA 402 drives do, and can be broken on purpose: frozen or
jumping encoders, silent nodes, drive faults, a cut bus.
"""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from backend.rigs.faults import CONFIGURATION, Fault
from backend.rigs.rig import AXES, Axis, AxisState, AxisStatus, BusHealth, Identity, Measured, RigError
from vssea_core.actuator.dynamics import PlantState
from vssea_core.scenario import Scenario
from vssea_core.signals.disturbances import disturbance_tables
from vssea_core.signals.documents import Disturbances
from vssea_core.simulation.rig_period import PERIOD_STATE, pass_period, read_encoders
from vssea_core.simulation.state import DELAYED, PLANT, equilibrium_state, rig_row

Part = Literal["link", "motor", "stiffness"]
PARTS: tuple[Part, Part, Part] = ("link", "motor", "stiffness")
ENABLING_CYCLES = 4
"""Exchanges that a drive needs to come into operation."""
DEADLINE_CYCLES = 5
"""Exchanges without a set value after which a drive stops by itself."""
HALT_BANDWIDTH = 60.0  # rad/s of the drives' own halt
WORDS: dict[AxisState, tuple[str, int]] = {
    "unknown": ("unknown", 0x0000),
    "disabled": ("switch on disabled", 0x0250),
    "enabling": ("switched on", 0x0233),
    "enabled": ("operation enabled", 0x1237),
    "stopping": ("quick stop active", 0x0217),
    "fault": ("fault", 0x0218),
}


@dataclass
class _Drive:
    """One drive: where it is, and what was done to it."""

    state: AxisState = "disabled"
    cycles: int = 0  # in this state
    halt_at: float = math.nan  # where a stiffness motor halts [rad]
    error_code: int = 0
    error_words: str = ""
    ails: bool = False  # the cause of its fault stands

    def become(self, state: AxisState) -> None:
        self.state, self.cycles = state, 0


class SimulatedRig:
    """The rig of `scenario`, at rest in equilibrium; its stiffness position reads `stiffness_offset` [rad] too little.

    Raises ValueError if the spring cannot carry the load at t = 0.
    """

    def __init__(self, scenario: Scenario, stiffness_offset: float = 0.0) -> None:
        self.scenario, self.period_s = scenario, scenario.timing.sample_time_s
        start = equilibrium_state(scenario)
        self._rig, self._state = rig_row(scenario), np.zeros(PERIOD_STATE)
        self._state[:PLANT] = start[:PLANT]
        self._state[PLANT:] = start[DELAYED:]
        self._terms = disturbance_tables(scenario.disturbances, self.period_s, scenario.seed)
        self._offset, self._homed_by = stiffness_offset, 0.0
        self._sample, self._configured = 0, False
        self._drives: dict[Axis, _Drive] = {axis: _Drive() for axis in AXES}
        self._given = dict.fromkeys(AXES, 0.0)
        self._last = dict.fromkeys(PARTS, 0.0)
        self._age = dict.fromkeys(PARTS, 0)
        self._frozen: dict[Part, float] = {}
        self._jumped = dict.fromkeys(PARTS, 0.0)
        self._silent: set[Part] = set()
        self._cut = False
        self._bus_faults: list[tuple[Fault, str]] = []
        self._late = 0

    def connect(self) -> None:
        """Nothing has to be found."""

    def identify(self) -> Identity:
        """Return that it is a simulation, and of what."""
        return Identity("simulated", self.scenario.name, (("rig", f"simulation of {self.scenario.name}"),))

    def configure(self) -> None:
        """Start the cyclic exchange."""
        self._configured = True

    def home(self, stiffness_offset: float) -> None:
        """Take `stiffness_offset` [rad] off the stiffness motor's position from now on."""
        self._homed_by = stiffness_offset

    def arm(self, axis: Axis) -> None:
        """Let an axis go to "enabled" within a few exchanges, also out of a stop; out of a fault it does not go."""
        if self._drives[axis].state in ("disabled", "stopping"):
            self._drives[axis].become("enabling")

    def stop(self, axis: Axis) -> None:
        """Halt an axis by the drive itself: the motor by damping, the stiffness motor where it is; it stays so until disarmed."""
        drive = self._drives[axis]
        if drive.state in ("enabling", "enabled"):
            drive.halt_at = self.plant.theta_ms
            drive.become("stopping")

    def disarm(self, axis: Axis) -> None:
        """Take the torque off an axis."""
        drive = self._drives[axis]
        if drive.state in ("enabling", "enabled", "stopping"):
            drive.become("disabled")

    def reset(self, axis: Axis) -> None:
        """Leave the fault if its cause is gone; the axis stays disabled."""
        drive = self._drives[axis]
        if drive.state == "fault" and not drive.ails:
            drive.error_code, drive.error_words = 0, ""
            drive.become("disabled")

    def exchange(self, motor_torque: float, stiffness_torque: float) -> Measured:
        """Pass a cycle with torques [N m, gear side] that the drives take over at once; return what was measured then.

        Raises RigError before `configure`.
        """
        if not self._configured:
            raise RigError(CONFIGURATION, "the exchange begins after configure()")
        seen_before = dict(self._given)
        self._pass_drives()
        self._given = {
            "motor": self._taken("motor", motor_torque),
            "stiffness": self._taken("stiffness", stiffness_torque),
        }
        self._measure()
        pass_period(self._rig, self._state, self._given["motor"], self._given["stiffness"], *self._terms, self._sample)
        self._sample += 1
        self._late += any(self._age.values())
        return Measured(
            self._last["link"],
            self._last["motor"],
            self._last["stiffness"] - self._offset - self._homed_by,
            self._age["link"],
            self._age["motor"],
            self._age["stiffness"],
            self._given["motor"],
            self._given["stiffness"],
            seen_before["motor"],
            seen_before["stiffness"],
        )

    def axis(self, axis: Axis) -> AxisStatus:
        """Return where an axis is; "unknown" while its node is silent."""
        drive = self._drives[axis]
        state: AxisState = "unknown" if axis in self._silent or self._cut else drive.state
        words, status = WORDS[state]
        return AxisStatus(axis, state, words, status, drive.error_code, drive.error_words)

    def bus_faults(self) -> tuple[tuple[Fault, str], ...]:
        """Return what was reported since the last call."""
        faults, self._bus_faults = tuple(self._bus_faults), []
        return faults

    def health(self) -> BusHealth:
        """Return the number of cycles, and of those in which a value was old."""
        return BusHealth(self._sample, self._late, 0.0)

    def close(self) -> None:
        """Disable both axes."""
        for axis in AXES:
            self.disarm(axis)

    @property
    def plant(self) -> PlantState:
        """The true state at the next exchange, which no controller sees."""
        return PlantState(*(float(number) for number in self._state[:PLANT]))

    @property
    def given(self) -> tuple[float, float]:
        """Torques [N m] that motor and stiffness motor really have."""
        return self._given["motor"], self._given["stiffness"]

    def set_disturbances(self, disturbances: Disturbances) -> None:
        """Load the plant with other disturbances from the next exchange on."""
        self._terms = disturbance_tables(disturbances, self.period_s, self.scenario.seed)

    def freeze_encoder(self, part: Part) -> None:
        """Let an encoder say what it said last, with fresh answers."""
        self._frozen[part] = self._last[part]

    def jump_encoder(self, part: Part, angle: float) -> None:
        """Let an encoder read `angle` [rad] more from now on."""
        self._jumped[part] += angle

    def silence(self, part: Part) -> None:
        """Let a node answer no more; a drive still hears."""
        self._silent.add(part)

    def cut_bus(self) -> None:
        """Let nothing through in either direction; the drives stop by themselves at their deadline."""
        self._cut = True

    def fault_drive(self, axis: Axis, error_code: int = 0x2310, words: str = "continuous over-current") -> None:
        """Let a drive fall into its fault, whose cause stands until `mend`."""
        drive = self._drives[axis]
        drive.error_code, drive.error_words, drive.ails = error_code, words, True
        drive.become("fault")

    def report(self, fault: Fault, detail: str = "") -> None:
        """Let the bus report a fault once."""
        self._bus_faults.append((fault, detail))

    def mend(self) -> None:
        """Undo everything that was broken; drives stay in the state they are in."""
        self._frozen.clear()
        self._silent.clear()
        self._jumped = dict.fromkeys(PARTS, 0.0)
        self._cut = False
        for drive in self._drives.values():
            drive.ails = False

    def _pass_drives(self) -> None:
        for axis, drive in self._drives.items():
            drive.cycles = 0 if drive.state == "enabled" and not self._cut else drive.cycles + 1
            if drive.state == "enabling" and drive.cycles >= ENABLING_CYCLES:
                drive.become("enabled")
            if self._cut and drive.cycles >= DEADLINE_CYCLES:
                self.stop(axis)

    def _taken(self, axis: Axis, asked: float) -> float:
        """Return the torque [N m] that a drive gives."""
        drive, actuator, now = self._drives[axis], self.scenario.actuator, self.plant
        peak = actuator.motor.peak_torque if axis == "motor" else actuator.stiffness.peak_torque
        torque = 0.0
        if drive.state == "enabled":
            torque = self._given[axis] if self._cut or not math.isfinite(asked) else asked
        elif drive.state == "stopping" and axis == "motor":
            torque = -HALT_BANDWIDTH * actuator.motor.inertia * now.omega_e
        elif drive.state == "stopping":
            back = HALT_BANDWIDTH * (drive.halt_at - now.theta_ms) - 2.0 * now.omega_ms
            torque = HALT_BANDWIDTH * actuator.stiffness.inertia * back
        return min(max(torque, -peak), peak)

    def _measure(self) -> None:
        read = dict(zip(PARTS, read_encoders(self._rig, self._state, self._sample), strict=True))
        for part in PARTS:
            if part in self._silent or self._cut:
                self._age[part] += 1
                continue
            self._age[part] = 0
            self._last[part] = self._frozen.get(part, read[part] + self._jumped[part])
