"""The whole emulated rig, without sockets and without a clock: frames in, frames out, time told."""

from collections.abc import Callable
from typing import Any

from backend.emulator.drive import EmulatedDrive
from backend.emulator.link_encoder import EmulatedLinkEncoder
from backend.emulator.network import EmulatedNetwork
from backend.emulator.node import EmulatedNode
from backend.emulator.plant import AXES, DEFAULT_STIFFNESS, MOTOR, STIFFNESS, EmulatedPlant
from backend.emulator.wire import Wire
from vssea_core.actuator.parameters import Actuator

MOTOR_NODE, STIFFNESS_NODE, LINK_NODE = 1, 2, 3
SYNC, HEARTBEATS = 0x80, 0x700
TURN_S = 0.01
"""How often the clock is looked at when no deadline is nearer; one that is set in between is seen in time if it is longer."""
RANGE = 0xFF07  # error code: what the plant's model says has ended
Send = Callable[[int, bytes], None]


class Emulator:
    """Plant, cable and three nodes; `send` takes what goes to the host."""

    def __init__(
        self,
        actuator: Actuator,
        send: Send,
        now: float = 0.0,
        stiffness: float = DEFAULT_STIFFNESS,
        stiffness_offset: float = 0.0,
    ) -> None:
        self.plant = EmulatedPlant(actuator, stiffness)
        self.wire = Wire(send, self._to_nodes)
        self.network = EmulatedNetwork(self._from_node)
        self.network.now = now
        self._plant_time = now
        self._next_turn = now
        self.syncs = 0
        self.nodes: tuple[EmulatedNode, ...] = ()  # while they are switched on
        self.motor = EmulatedDrive(MOTOR_NODE, MOTOR, self.plant, self.network)
        self.stiffness = EmulatedDrive(STIFFNESS_NODE, STIFFNESS, self.plant, self.network, stiffness_offset)
        self.link = EmulatedLinkEncoder(LINK_NODE, self.plant, self.network)
        self.drives = (self.motor, self.stiffness)
        self.nodes = (self.motor, self.stiffness, self.link)
        self.network.subscribe(SYNC, self._sync)
        self.watch()

    def begin(self, now: float) -> None:
        """Let time count from now."""
        self.network.now = self._plant_time = self._next_turn = now

    def receive(self, can_id: int, data: bytes, now: float) -> None:
        """Take a frame of the host that arrived at `now`."""
        self.advance(now)
        self.wire.into(can_id, data)

    def turn(self, now: float) -> None:
        """Look at the clock."""
        if now < self._next_turn:
            self.wire.turn(now)
            return
        self.advance(now)
        self.network.turn(now)
        for node in self.nodes:
            node.turn()
        self.wire.turn(now)
        deadlines = (self.network.deadline(), *(node.deadline() for node in self.nodes))
        self._next_turn = min(now + TURN_S, *deadlines)

    def next_turn(self) -> float:
        """Return when `turn` has to be called at the latest."""
        late = self.wire.due()
        return self._next_turn if late is None else min(late, self._next_turn)

    def watch(self) -> None:
        """Begin peaks anew."""
        self.plant.watch()
        self._began = tuple((drive.times_enabled, drive.times_left) for drive in self.drives)

    def peaks(self) -> dict[str, Any]:
        """Return what happened since the last `watch`."""
        return {**self.plant.peaks(), "states": self.states(), "re_enabled": any(map(self._re_enabled, (0, 1)))}

    def _re_enabled(self, which: int) -> bool:
        """Return whether a drive came into operation after it had left it, since the last watch."""
        drive, (enabled, left) = self.drives[which], self._began[which]
        comings, was_enabled = drive.times_enabled - enabled, enabled > left
        return comings > (0 if was_enabled else 1)

    def states(self) -> dict[str, str]:
        """Return the state of each drive in words."""
        return {AXES[drive.axis]: drive.state.value for drive in self.drives}

    def state(self) -> dict[str, Any]:
        """Return everything about the rig as it truly is."""
        nodes = {
            str(node.number): {
                "nmt": node.nmt_state,
                "error_register": node.value(0x1001),
                "last_error": node.value(0x1003, 1),
            }
            for node in self.nodes
        }
        return {
            **self.plant.truth(),
            "motor_torque": self.plant.given(MOTOR),
            "stiffness_torque": self.plant.given(STIFFNESS),
            "states": self.states(),
            "statuswords": {AXES[drive.axis]: drive.statusword() for drive in self.drives},
            "nodes": nodes,
            "syncs": self.syncs,
            "skipped_s": self.plant.skipped_s,
        }

    def advance(self, now: float) -> None:
        """Let the plant come to `now`."""
        now = max(now, self._plant_time)
        self.network.now = now
        self.plant.advance(now - self._plant_time)
        self._plant_time = now
        if not self.plant.holds:
            self.plant.holds = True
            for drive in self.drives:
                drive.fail(RANGE, register=0x80)

    def _from_node(self, can_id: int, data: bytes) -> None:
        if can_id > HEARTBEATS:
            self._heard(can_id)
        self.wire.out(can_id, data, self.network.now)

    def _to_nodes(self, can_id: int, data: bytes) -> None:
        if can_id > HEARTBEATS:
            self._heard(can_id)
        else:
            self.network.notify(can_id, bytearray(data), self.network.now)

    def _heard(self, can_id: int) -> None:
        for node in self.nodes:
            node.heard(can_id & 0x7F)

    def _sync(self, _can_id: int, _data: bytearray, _timestamp: float) -> None:
        self.syncs += 1
        for node in self.nodes:
            node.sync()
