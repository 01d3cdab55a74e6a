"""Who answers on the bus, compared with the rig's file."""

from typing import NamedTuple

from backend.rigs.canopen import objects
from backend.rigs.canopen.nodes import Node, NodeError
from backend.rigs.faults import LINK_ENCODER, MOTOR_DRIVE, STIFFNESS_DRIVE, Fault
from backend.rigs.rig import Axis, RigKind
from backend.rigs.rig_file import Drive, RigFile

ENCODER_PROFILE = 406
EMULATED = "emulated"


class Place(NamedTuple):
    """A node as the rig's file means it."""

    name: str  # "motor drive"
    node: int
    axis: Axis | None  # None = the link encoder
    drive: Drive | None
    fault: Fault  # what its emergencies are

    @property
    def words(self) -> str:
        """The place in words."""
        return f"{self.name}, node {self.node}"


class Device(NamedTuple):
    """What a node says of itself; None = it has no such object."""

    device_type: int
    name: str
    vendor: int | None
    product: int | None
    serial: int | None

    @property
    def words(self) -> str:
        """The device in words."""
        serial = "" if self.serial is None else f", serial {self.serial}"
        return f"{self.name or f'device type 0x{self.device_type:08X}'}{serial}"

    @property
    def kind(self) -> RigKind:
        """Whether it says that it is emulated."""
        return "emulated" if EMULATED in self.name.lower() else "real"


def places(rig_file: RigFile) -> list[Place]:
    """Return the nodes that a rig's file names."""
    found = [
        Place("motor drive", rig_file.motor.node, "motor", rig_file.motor, MOTOR_DRIVE),
        Place("stiffness drive", rig_file.stiffness.node, "stiffness", rig_file.stiffness, STIFFNESS_DRIVE),
    ]
    if rig_file.link.node is not None:
        found.append(Place("link encoder", rig_file.link.node, None, None, LINK_ENCODER))
    return found


def device_of(node: Node) -> Device:
    """Return who a node is. Raises NodeError where it does not answer."""

    def read(subindex: int) -> int | None:
        try:
            return node.read(objects.IDENTITY, subindex, "<I")
        except NodeError:
            return None

    kind = node.read(objects.DEVICE_TYPE, 0, "<I")
    return Device(kind, node.read_text(objects.DEVICE_NAME), read(1), read(2), read(4))


def mismatches(place: Place, device: Device) -> list[tuple[str, str, str]]:
    """Return what a device is not: what, found, expected."""
    wrong: list[tuple[str, str, str]] = []
    if place.drive is None:
        if device.device_type & 0xFFFF != ENCODER_PROFILE:
            wrong.append(("device type", f"0x{device.device_type:08X}", "an encoder, 0x....0196 (CiA 406)"))
        return wrong
    drive = place.drive
    if device.device_type != drive.device_type:
        wrong.append(("device type", f"0x{device.device_type:08X}", f"0x{drive.device_type:08X}"))
    if drive.vendor is not None and device.vendor != drive.vendor:
        wrong.append(("vendor", _shown(device.vendor), f"0x{drive.vendor:08X}"))
    if drive.serial is not None and device.serial != drive.serial:
        wrong.append(("serial", str(device.serial), str(drive.serial)))
    return wrong


def _shown(number: int | None) -> str:
    return "none" if number is None else f"0x{number:08X}"
