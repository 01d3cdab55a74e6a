"""What every emulated CANopen node does: SDO, NMT, heartbeats out and in, emergencies, PDOs on SYNC (CiA 301).

canopen's LocalNode serves SDO and makes heartbeats and emergencies; PDOs, the heartbeat consumer and the states' effects
are here. Time comes from the network.
"""

import math
from collections.abc import Sequence
from typing import Any

import canopen
from canopen.sdo.exceptions import SdoAbortedError

from backend.emulator.network import EmulatedNetwork
from backend.emulator.objects import PDOS, UNUSED, Entry, dictionary
from backend.emulator.pdo import OVERDUE, ReceivePdo, TransmitPdo, check_pdo_write

START, STOP, PRE_OPERATIONAL, RESET_NODE, RESET_COMMUNICATION = 1, 2, 128, 129, 130
HEARTBEAT_LOST, EXCHANGE_ENDED, NO_ERROR = 0x8130, 0x8100, 0x0000
"""Error codes: no heartbeat of the host in time, the exchange ended with power on a motor, all well again."""
COMMUNICATION_ERROR = 0x10  # bit of the error register
BOOT_S = 0.3
"""How long a node is away when it restarts."""
NOT_A_VALUE = 0x06090030


class EmulatedNode:
    """One node, switched on: it sends its boot-up message and waits in pre-operational."""

    def __init__(self, number: int, entries: Sequence[Entry], network: EmulatedNetwork) -> None:
        self.number, self.network = number, network
        self.entries = {(entry.index, entry.sub): entry for entry in entries}
        self.values: dict[tuple[int, int], Any] = {}
        self._heard: dict[int, float] = {}  # by subindex of 0x1016: until when the next heartbeat has to be here
        self._lost: set[int] = set()  # subindices of 0x1016 whose heartbeat is missing
        self._back_at: float | None = None  # while it restarts
        self.local = canopen.LocalNode(number, dictionary(entries))
        self.local.add_read_callback(self._on_read)
        self.local.add_write_callback(self._on_write)
        network.add_node(self.local)
        # The library would go on serving SDO in every state, and stay in a reset.
        network.unsubscribe(0, self.local.nmt.on_command)
        network.unsubscribe(0x600 + number, self.local.sdo.on_request)
        network.subscribe(0, self._on_nmt)
        network.subscribe(0x600 + number, self._on_sdo)
        self.receives = [ReceivePdo(self, pdo) for pdo in range(PDOS) if (0x1400 + pdo, 1) in self.entries]
        self.transmits = [TransmitPdo(self, pdo) for pdo in range(PDOS) if (0x1800 + pdo, 1) in self.entries]
        self._boot()

    @property
    def now(self) -> float:
        """Time [s] of what is happening."""
        return self.network.now

    @property
    def nmt_state(self) -> str:
        """The node's NMT state in words."""
        return "RESTARTING" if self._back_at is not None else self.local.nmt.state

    @property
    def is_restarting(self) -> bool:
        """Whether the node is without power."""
        return self._back_at is not None

    @property
    def is_operational(self) -> bool:
        """Whether PDOs are exchanged."""
        return self.nmt_state == "OPERATIONAL"

    def value(self, index: int, sub: int = 0) -> int:
        """Return the value of an object."""
        return self.values[index, sub]

    # What kinds of nodes add -----------------------------------------------------------------------------------------

    def latch(self) -> None:
        """Put what is measured now into the dictionary."""

    def check(self, index: int, sub: int, value: int) -> None:
        """Refuse a value for an object. Raises SdoAbortedError."""

    def wrote(self, index: int, sub: int, value: int) -> None:
        """Act on a new value."""

    def connection_lost(self, code: int) -> None:
        """React to a host that is gone, or that has ended the exchange; `code` is the emergency that told it."""

    def switched_on(self) -> None:
        """Begin with the dictionary's default values."""

    def recovered(self) -> None:
        """Note that the host is heard again."""
        self.emergency(NO_ERROR)

    def powered_off(self) -> None:
        """Let go of what needs power."""

    def watch_time(self) -> None:
        """Do what only time calls for."""

    # The exchange ----------------------------------------------------------------------------------------------------

    def sync(self) -> None:
        """Take over what was received, latch what is measured, answer."""
        if not self.is_operational:
            return
        for pdo in self.receives:
            pdo.sync()
        self.latch()
        for answer in self.transmits:
            answer.sync()

    def take(self, objects: tuple[tuple[int, int], ...], values: tuple[int, ...]) -> None:
        """Take over the content of a receive PDO; a value that an object refuses changes nothing."""
        for key, value in zip(objects, values, strict=True):
            entry = self.entries.get(key)
            if entry is None or (entry.allowed and value not in entry.allowed):
                continue
            self.values[key] = value
            self.wrote(*key, value)

    def turn(self) -> None:
        """Look at the clock: deadlines, event timers, restarts."""
        if self._back_at is not None:
            if self.now >= self._back_at:
                self._boot()
            return
        for sub, due in tuple(self._heard.items()):
            if self.now >= due:
                del self._heard[sub]
                self._lost.add(sub)
                self._heartbeat_lost()
        if self.is_operational:
            for pdo in self.receives:
                if pdo.overdue():
                    self.emergency(OVERDUE, COMMUNICATION_ERROR)
                    self.connection_lost(OVERDUE)
            for answer in self.transmits:
                answer.event(self.latch)
        self.watch_time()

    def deadline(self) -> float:
        """Return when `turn` has to be called."""
        if self._back_at is not None:
            return self._back_at
        pdos = (*self.receives, *self.transmits) if self.is_operational else ()
        return min(*(pdo.deadline() for pdo in pdos), *self._heard.values(), math.inf, math.inf)

    def heard(self, producer: int) -> None:
        """Note a heartbeat of another node."""
        for sub in (1, 2):
            value = self.values[0x1016, sub]
            if value and (value >> 16) & 0x7F == producer and value & 0xFFFF:
                self._heard[sub] = self.now + 1e-3 * (value & 0xFFFF)
                if sub in self._lost:
                    self._lost.discard(sub)
                    self.recovered()

    def _heartbeat_lost(self) -> None:
        self.emergency(HEARTBEAT_LOST, COMMUNICATION_ERROR)
        self.connection_lost(HEARTBEAT_LOST)
        if self.is_operational:
            behaviour = self.value(0x1029, 1)
            if behaviour != 1:
                self._enter("STOPPED" if behaviour == 2 else "PRE-OPERATIONAL")

    def emergency(self, code: int, register: int = 0) -> None:
        """Send an emergency object and note it in the error history; code 0 takes the errors back."""
        if code == NO_ERROR:
            self.values[0x1001, 0] = 0
        else:
            self.values[0x1001, 0] |= register | 1
            for sub in range(8, 1, -1):
                self.values[0x1003, sub] = self.values[0x1003, sub - 1]
            self.values[0x1003, 1] = code
            self.values[0x1003, 0] = min(8, self.values[0x1003, 0] + 1)
        if not self.value(0x1014) & UNUSED and self.nmt_state in ("PRE-OPERATIONAL", "OPERATIONAL"):
            self.local.emcy.send(code, self.values[0x1001, 0])

    # SDO -------------------------------------------------------------------------------------------------------------

    def _on_sdo(self, can_id: int, data: bytearray, timestamp: float) -> None:
        if len(data) == 8 and self.nmt_state in ("PRE-OPERATIONAL", "OPERATIONAL"):
            self.local.sdo.on_request(can_id, data, timestamp)

    def _on_read(self, index: int, subindex: int, od: Any) -> Any:
        if index >= 0x6000:
            self.latch()
        return self.values[index, subindex]

    def _on_write(self, index: int, subindex: int, od: Any, data: bytes) -> None:
        value, entry = od.decode_raw(bytes(data)), self.entries[index, subindex]
        if entry.allowed and value not in entry.allowed:
            raise SdoAbortedError(NOT_A_VALUE)
        is_pdo = 0x1400 <= index < 0x1C00
        if is_pdo:
            check_pdo_write(self, index, subindex, value)
        self.check(index, subindex, value)
        self.values[index, subindex] = value
        if is_pdo:
            for pdo in (*self.receives, *self.transmits):
                if index in (pdo.communication, pdo.mapping):
                    pdo.configure()
        elif index == 0x1016:
            self._heard.pop(subindex, None)
        elif index == 0x1003:
            self.values.update({(0x1003, sub): 0 for sub in range(1, 9)})
        self.wrote(index, subindex, value)

    # NMT -------------------------------------------------------------------------------------------------------------

    def _on_nmt(self, _can_id: int, data: bytearray, _timestamp: float) -> None:
        if len(data) != 2 or data[1] not in (0, self.number) or self._back_at is not None:
            return
        command = data[0]
        if command == START:
            self._enter("OPERATIONAL")
        elif command == STOP:
            self._enter("STOPPED")
        elif command == PRE_OPERATIONAL:
            self._enter("PRE-OPERATIONAL")
        elif command in (RESET_NODE, RESET_COMMUNICATION):
            self._boot()

    def _enter(self, state: str) -> None:
        was_operational = self.is_operational
        self.local.nmt.state = state
        if was_operational and state != "OPERATIONAL":
            for pdo in self.receives:
                pdo.forget()
            self.connection_lost(EXCHANGE_ENDED)

    def restart(self) -> None:
        """Lose power for a moment: silent, then back with the boot-up message and without its configuration."""
        self.local.nmt.stop_heartbeat()
        self._back_at = self.now + BOOT_S
        self.powered_off()

    def _boot(self) -> None:
        self._back_at = None
        self._heard.clear()
        self._lost.clear()
        self.values = {key: entry.default for key, entry in self.entries.items()}
        self.local.data_store.clear()
        self.local.sdo._index = self.local.sdo._subindex = 0  # an abort before any request names an object
        for pdo in (*self.receives, *self.transmits):
            pdo.configure()
        self.local.nmt.state = "INITIALISING"
        self.local.nmt.state = "PRE-OPERATIONAL"
        self.switched_on()
