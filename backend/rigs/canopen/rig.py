"""The rig on a CAN bus: connecting, configuring and disconnecting, around the cyclic exchange."""

import logging
import time
from collections.abc import Callable
from functools import partial

import can
import canopen

from backend.rigs.canopen import objects
from backend.rigs.canopen.cia402 import Goal
from backend.rigs.canopen.commissioning import Commissioned, commission, unwatch
from backend.rigs.canopen.configuration import HEARTBEAT_MS
from backend.rigs.canopen.cycle import Cycle
from backend.rigs.canopen.drive import DriveChannel
from backend.rigs.canopen.emergency import error_words, fault_of
from backend.rigs.canopen.identity import Device, Place, device_of, mismatches, places
from backend.rigs.canopen.nodes import Node, NodeError
from backend.rigs.canopen.opening import open_bus
from backend.rigs.faults import BUS_OFF, CORRUPTED, REBOOTED, WRONG_DEVICE, Fault
from backend.rigs.rig import AXES, Axis, AxisStatus, BusHealth, Identity, Measured, RigError, RigKind
from backend.rigs.rig_file import Bus, RigFile

HEARTBEATS_A_LIMIT = 8
"""Heartbeats of ours in the time within which a drive must have one."""
CLOSING_CYCLES = 5
log = logging.getLogger(__name__)


class CanopenRig:
    """Two CiA 402 drives and a link encoder; `gear_ratio` is the actuator's N. Follows the Rig protocol."""

    def __init__(
        self,
        rig_file: RigFile,
        gear_ratio: float,
        *,
        opened: Callable[[Bus], can.BusABC] = open_bus,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        self.period_s = 1.0 / rig_file.rate_hz
        self._file, self._gear_ratio = rig_file, gear_ratio
        self._opened, self._clock = opened, clock
        self._bus: can.BusABC | None = None
        self._network: canopen.Network | None = None
        self._nodes: dict[Place, Node] = {}
        self._devices: dict[Place, Device] = {}
        self._parts: Commissioned | None = None
        self._cycle: Cycle | None = None
        self._offset = 0.0

    @property
    def without(self) -> tuple[str, ...]:
        """What nodes would not take over and may be without, in words."""
        return tuple(self._parts.refused) if self._parts else ()

    def connect(self) -> None:
        """Open the bus and find every node."""
        self._bus = self._opened(self._file.bus)
        self._network = canopen.Network(self._bus)
        silent = []
        for place in places(self._file):
            node = self._nodes[place] = Node(self._network, place.node, self._clock)
            try:
                self._devices[place] = device_of(node)
            except NodeError:
                silent.append(place.words)
        if silent:
            raise RigError(WRONG_DEVICE, f"no answer from {' and '.join(silent)}")

    def identify(self) -> Identity:
        """Return who answered, compared with what the rig's file expects."""
        lines = []
        for place, device in self._devices.items():
            for what, found, expected in mismatches(place, device):
                raise RigError(WRONG_DEVICE, f"{place.words}: {what} is {found}, the file says {expected}")
            lines.append((place.words, device.words + self._rating(place)))
        kind: RigKind = "emulated" if any(d.kind == "emulated" for d in self._devices.values()) else "real"
        return Identity(kind, self._file.name, (*lines, *(("not taken over", words) for words in self.without)))

    def _rating(self, place: Place) -> str:
        if place.drive is None:
            return ""
        try:
            rated = self._nodes[place].read(objects.RATED_TORQUE, 0, "<I")
        except NodeError:
            return ""
        return f", rated {rated * place.drive.rated_torque_unit:.3g} N·m"

    def configure(self) -> None:
        """Write what the file and the safety of the drives ask for, read it back, and start the cyclic exchange."""
        if self._bus is None or self._network is None:
            raise RuntimeError("the rig is not connected")
        parts = commission(self._file, self._gear_ratio, self._nodes)
        for words in parts.refused:
            log.warning("%s", words)
        answers = [channel.answer for channel in (parts.motor, parts.stiffness)]
        answers += [channel.torque_answer for channel in (parts.motor, parts.stiffness)]
        if parts.link.answer not in answers:
            answers.append(parts.link.answer)
        commands = parts.motor.message, parts.stiffness.message
        self._cycle = Cycle(
            self._network, self._bus, commands, tuple(answers), self.period_s, self._file.answer_share,
            HEARTBEAT_MS / 1000.0 / HEARTBEATS_A_LIMIT, self._clock,
        )  # fmt: skip
        self._parts = parts

    def home(self, stiffness_offset: float) -> None:
        """Take `stiffness_offset` [rad] off the stiffness motor's position from now on."""
        self._offset += stiffness_offset

    def arm(self, axis: Axis) -> None:
        """Let an axis go to "enabled"; never out of a fault."""
        self._channel(axis).goal = Goal.ENABLED

    def stop(self, axis: Axis) -> None:
        """Let the drive stop an axis by its quick stop."""
        self._channel(axis).goal = Goal.STOPPED

    def disarm(self, axis: Axis) -> None:
        """Let an axis go to "disabled"."""
        self._channel(axis).goal = Goal.DISABLED

    def reset(self, axis: Axis) -> None:
        """Ask the drive once to leave its fault; it stays disabled."""
        self._channel(axis).goal = Goal.RESET

    def exchange(self, motor_torque: float, stiffness_torque: float) -> Measured:
        """Send torques [N m, gear side], return what was measured as they took effect."""
        parts, cycle = self._running()
        motor, stiffness, link = parts.motor, parts.stiffness, parts.link
        motor.command(motor_torque)
        stiffness.command(stiffness_torque)
        taken = cycle.turn()
        motor.settle(taken)
        stiffness.settle(taken)
        link.settle()
        return Measured(
            link.position,
            motor.position,
            stiffness.position - self._offset,
            link.age,
            motor.age,
            stiffness.age,
            motor.torque,
            stiffness.torque,
            motor.torque_seen,
            stiffness.torque_seen,
        )

    def axis(self, axis: Axis) -> AxisStatus:
        """Return where an axis is."""
        return self._channel(axis).status()

    def bus_faults(self) -> tuple[tuple[Fault, str], ...]:
        """Return what went wrong on the bus since the last call: each fault with its detail."""
        if self._cycle is None:
            return ()
        faults = [(BUS_OFF, words) for words in self._cycle.take_errors()]
        if self._cycle.take_corrupted():
            faults.append((CORRUPTED, ""))
        for place, node in self._nodes.items():
            faults += [
                (fault_of(code, place.fault), f"{place.words}: {error_words(code)}") for code in node.take_errors()
            ]
            if node.restarted:
                node.restarted = False
                faults.append((REBOOTED, place.words))
        return tuple(faults)

    def health(self) -> BusHealth:
        """Return the figures of the exchange."""
        cycle = self._cycle
        return BusHealth() if cycle is None else BusHealth(cycle.cycles, cycle.late, cycle.round_trip_s * 1e6)

    def close(self) -> None:
        """Disable both axes if they answer, then close the bus. Never raises."""
        ends: list[Callable[[], None]] = [self._disable]
        ends += [partial(self._release, place, node) for place, node in self._nodes.items()]
        for end in (*ends, self._shut):
            try:
                end()
            except Exception:
                log.warning("The rig did not close cleanly", exc_info=True)

    def _disable(self) -> None:
        if self._cycle is not None:
            for axis in AXES:
                if self.axis(axis).state != "stopping":  # a drive that holds a load by its quick stop goes on with it
                    self.disarm(axis)
            for _ in range(CLOSING_CYCLES):
                self.exchange(0.0, 0.0)

    def _release(self, place: Place, node: Node) -> None:
        if self._parts is None:
            return
        channels = {"motor": self._parts.motor, "stiffness": self._parts.stiffness}
        if place.axis is not None:
            channel = channels[place.axis]
            if channel.age < CLOSING_CYCLES and channel.status().state in ("disabled", "fault"):
                unwatch(node)  # else its watch of us is what stops it
        node.manage("PRE-OPERATIONAL")

    def _shut(self) -> None:
        bus, self._bus, self._network = self._bus, None, None
        self._parts = self._cycle = None
        if bus is not None:
            bus.shutdown()

    def _channel(self, axis: Axis) -> DriveChannel:
        parts, _ = self._running()
        return parts.motor if axis == "motor" else parts.stiffness

    def _running(self) -> tuple[Commissioned, Cycle]:
        if self._parts is None or self._cycle is None:
            raise RuntimeError("the rig is not configured")
        return self._parts, self._cycle
