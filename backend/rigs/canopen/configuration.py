"""What a drive is told before anything moves, read back and compared; mostly what it is to do when this computer is gone.

A drive that refuses what its safety needs is refused, unless the rig's file accepts it by name; what is only of use is
reported.
"""

from dataclasses import dataclass, replace
from typing import Literal

from backend.rigs.canopen import objects
from backend.rigs.canopen.nodes import Node, NodeError
from backend.rigs.canopen.objects import OWN_NODE, Pdo
from backend.rigs.faults import CONFIGURATION
from backend.rigs.rig import Axis, RigError
from backend.rigs.rig_file import Drive

HEARTBEAT_MS = 100
"""A drive stops when this computer's heartbeat has stayed away for so long; nodes send their own as often."""
DEADLINE_CYCLES, SHORTEST_DEADLINE_MS = 15, 50
"""A drive stops when no torque has come for so long; above the 10 cycles after which the loop itself gives up."""
_NO_RTR, _INVALID = 1 << 30, 1 << 31

Need = Literal["needed", "safety", "optional"]


@dataclass(frozen=True)
class Setting:
    """One object and the value it is to have."""

    index: int
    subindex: int
    form: str
    value: int
    need: Need
    what: str
    keep: int = 0  # bits that stay as they are

    @property
    def name(self) -> str:
        """The object in words."""
        return f"0x{self.index:04X}{f':{self.subindex:02X}' if self.subindex else ''} {self.what}"


def deadline_ms(period_s: float) -> int:
    """Return how long a drive goes on without new torque."""
    return max(SHORTEST_DEADLINE_MS, round(DEADLINE_CYCLES * period_s * 1000.0))


def drive_settings(axis: Axis, drive: Drive, period_s: float, torque_limit: int) -> list[Setting]:
    """Return what a drive is told beside its PDOs; `torque_limit` in thousandths of its rated torque."""
    # A compliant joint stores energy. When this computer is gone, both motors are braked by their drives' quick stop
    # (0x6007 = 3; 2 would let them coast). The equilibrium motor then lets go (2): that takes the load off the spring. The
    # stiffness motor stays in quick stop and holds (6): let go under load it would be thrown into its end stop.
    quick_stop = 2 if axis == "motor" else 6
    settings = [
        Setting(objects.TARGET_TORQUE, 0, "<h", 0, "needed", "target torque"),
        Setting(objects.MODE, 0, "<b", objects.CYCLIC_TORQUE, "needed", "mode of operation"),
        Setting(objects.MAX_TORQUE, 0, "<H", torque_limit, "safety", "maximum torque"),
        Setting(objects.ABORT_CONNECTION, 0, "<h", 3, "safety", "reaction to a lost connection"),
        Setting(objects.QUICK_STOP_OPTION, 0, "<h", quick_stop, "safety", "quick stop"),
        # CiA 402 ends every fault with the power stage off: braking first is the most that can be asked for.
        Setting(objects.FAULT_REACTION_OPTION, 0, "<h", 2, "safety", "reaction to a fault"),
        Setting(objects.INTERPOLATION_TIME, 1, "<B", round(period_s * 1000.0), "optional", "interpolation time"),
        Setting(objects.INTERPOLATION_TIME, 2, "<b", -3, "optional", "interpolation time"),
        Setting(
            objects.CONSUMER_HEARTBEAT, 1, "<I", OWN_NODE << 16 | HEARTBEAT_MS, "safety", "watch on this computer",
        ),
        # Else a drive that has missed this computer would leave the cycle, and nobody could see how it stands.
        Setting(objects.ERROR_BEHAVIOUR, 1, "<B", 1, "optional", "stay in the cycle after errors"),
        heartbeat(),
    ]  # fmt: skip
    if drive.quick_stop_deceleration is not None:
        deceleration = drive.quick_stop_deceleration
        settings.append(
            Setting(objects.QUICK_STOP_DECELERATION, 0, "<I", deceleration, "needed", "quick stop deceleration")
        )
    return settings


def heartbeat() -> Setting:
    """Return the setting of a node's own heartbeat."""
    return Setting(objects.PRODUCER_HEARTBEAT, 0, "<H", HEARTBEAT_MS, "optional", "heartbeat")


class Configurator:
    """Tells one node what it is to do, and notes what it would not take."""

    def __init__(self, node: Node, where: str, accepted: tuple[int, ...] = ()) -> None:
        self._node, self._where, self._accepted = node, where, accepted
        self.refused: list[str] = []

    def settings(self, settings: list[Setting]) -> None:
        """Write, read back and compare. Raises RigError for what must not be missing."""
        for setting in settings:
            self._set(setting)

    def pdo(self, pdo: Pdo) -> None:
        """Lay out a PDO and make it synchronous, once a SYNC. Raises RigError."""
        identifier = Setting(pdo.communication, 1, "<I", pdo.can_id, "needed", "PDO identifier", keep=_NO_RTR)
        self._set(replace(identifier, value=pdo.can_id | _INVALID))
        self._set(Setting(pdo.communication, 2, "<B", 1, "needed", "PDO transmission type"))
        if not self._is_mapped(pdo):
            self._set(Setting(pdo.mapping, 0, "<B", 0, "needed", "PDO mapping"))
            for place, entry in enumerate(pdo.entries, start=1):
                self._set(Setting(pdo.mapping, place, "<I", entry.number, "needed", "PDO mapping"))
            self._set(Setting(pdo.mapping, 0, "<B", len(pdo.entries), "needed", "PDO mapping"))
        if pdo.deadline_ms:
            self._set(Setting(pdo.communication, 5, "<H", pdo.deadline_ms, "optional", "RPDO deadline"))
        self._set(identifier)

    def silence(self, communication: int) -> None:
        """Switch a PDO off that would only load the bus, where the node has it."""
        try:
            value = self._node.read(communication, 1, "<I")
            if not value & _INVALID:
                self._node.write(communication, 1, "<I", value | _INVALID)
        except NodeError:
            return

    def _is_mapped(self, pdo: Pdo) -> bool:
        """Return whether the layout is there already; some nodes' cannot be changed."""
        try:
            count = self._node.read(pdo.mapping, 0, "<B")
            entries = [self._node.read(pdo.mapping, place, "<I") for place in range(1, count + 1)]
        except NodeError:
            return False
        return entries == [entry.number for entry in pdo.entries]

    def _set(self, setting: Setting) -> None:
        index, subindex, form = setting.index, setting.subindex, setting.form
        value, reason = setting.value, ""
        try:
            if setting.keep:
                value |= self._node.read(index, subindex, form) & setting.keep
            self._node.write(index, subindex, form, value)
        except NodeError as error:
            reason = str(error)  # not the last word: what cannot be written may have the right value
        try:
            found = self._node.read(index, subindex, form)
        except NodeError as error:
            self._refuse(setting, reason or str(error))
            return
        if found != value:
            self._refuse(setting, reason or f"is {found} and stayed so, expected {value}")

    def _refuse(self, setting: Setting, reason: str) -> None:
        self.refused.append(f"{setting.name} ({reason})")
        if setting.need == "optional" or (setting.need == "safety" and setting.index in self._accepted):
            return
        accept = f"; if you accept that, list 0x{setting.index:04X} in `without`" if setting.need == "safety" else ""
        raise RigError(CONFIGURATION, f"{self._where}: {setting.name}: {reason}{accept}")


def mode_taken(node: Node, where: str) -> None:
    """Refuse a drive that does not say it is in cyclic synchronous torque mode. Raises RigError."""
    try:
        mode = node.read(objects.MODE_DISPLAY, 0, "<b")
    except NodeError as error:
        raise RigError(CONFIGURATION, f"{where}: {error}") from error
    if mode != objects.CYCLIC_TORQUE:
        raise RigError(
            CONFIGURATION, f"{where}: mode of operation is {mode}, expected {objects.CYCLIC_TORQUE} (cyclic torque)"
        )
