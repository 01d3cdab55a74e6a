"""From nodes that answer to nodes that take part in the cycle: PDOs, modes, limits, watchdogs, and NMT start."""

from typing import Literal, NamedTuple

import can

from backend.rigs.canopen import objects
from backend.rigs.canopen.answer import Answer
from backend.rigs.canopen.cia402 import DriveState
from backend.rigs.canopen.cia402 import drive_state as state_of
from backend.rigs.canopen.configuration import Configurator, deadline_ms, drive_settings, heartbeat, mode_taken
from backend.rigs.canopen.drive import DriveChannel, is_status, is_torque
from backend.rigs.canopen.identity import Place
from backend.rigs.canopen.link import LinkChannel, link_entry
from backend.rigs.canopen.nodes import Node, NodeError
from backend.rigs.canopen.scaling import LinkPosition, MotorPosition, TorqueScale
from backend.rigs.faults import CONFIGURATION
from backend.rigs.rig import Axis, RigError
from backend.rigs.rig_file import Drive, RigFile

_OTHER_TPDOS = (0x1801, 0x1802, 0x1803)


class Commissioned(NamedTuple):
    """What takes part in the cycle, and what nodes refused."""

    motor: DriveChannel
    stiffness: DriveChannel
    link: LinkChannel
    refused: list[str]


def commission(rig_file: RigFile, gear_ratio: float, nodes: dict[Place, Node]) -> Commissioned:
    """Configure every node and start it. Raises RigError."""
    for node in nodes.values():
        _manage(node, "PRE-OPERATIONAL")
    drives: dict[Axis, DriveChannel] = {}
    link: LinkChannel | None = None
    refused: list[str] = []
    for place, node in nodes.items():
        configurator = Configurator(node, place.words, place.drive.without if place.drive else ())
        if place.axis is None:
            link = _encoder(rig_file, node, configurator)
        else:
            drives[place.axis] = _drive(
                place, rig_file, gear_ratio if place.axis == "motor" else 1.0, node, configurator
            )
        refused += [f"{place.words}: {words}" for words in configurator.refused]
    if link is None:
        host = drives["motor" if rig_file.link.source == "motor_drive" else "stiffness"]
        link = LinkChannel(host.torque_answer, 1, LinkPosition(rig_file.link))
    for node in nodes.values():
        _manage(node, "OPERATIONAL")
        node.forget()
    return Commissioned(drives["motor"], drives["stiffness"], link, refused)


def unwatch(node: Node) -> None:
    """End a drive's watch on this computer, so that a quiet end leaves no fault behind. Raises NodeError."""
    node.write(objects.CONSUMER_HEARTBEAT, 1, "<I", 0)


def _manage(node: Node, state: Literal["OPERATIONAL", "PRE-OPERATIONAL"]) -> None:
    try:
        node.manage(state)
    except (can.CanError, OSError) as error:
        raise RigError(CONFIGURATION, f"node {node.number} cannot be told to be {state.lower()}: {error}") from error


def _drive(place: Place, rig_file: RigFile, gear_ratio: float, node: Node, configurator: Configurator) -> DriveChannel:
    drive, axis = place.drive, place.axis
    if drive is None or axis is None:
        raise RigError(CONFIGURATION, f"{place.words} is no drive")
    period_s = 1.0 / rig_file.rate_hz
    scale = _scale(place, drive, gear_ratio, node)
    has_link = rig_file.link.source == f"{axis}_drive"
    command = objects.torque_command(node.number, deadline_ms(period_s))
    state = objects.drive_state(node.number)
    torque = objects.drive_torque(node.number, link_entry(rig_file.link) if has_link else None)
    for pdo in (command, state, torque):
        configurator.pdo(pdo)
    for other in _OTHER_TPDOS[1:]:
        configurator.silence(other)
    configurator.settings(drive_settings(axis, drive, period_s, scale.limit))
    mode_taken(node, place.words)
    try:
        found = node.read(objects.STATUS_WORD, 0, "<H")
        if state_of(found) in (DriveState.FAULT, DriveState.FAULT_REACTION):
            node.error_code = node.read(objects.ERROR_CODE, 0, "<H")
    except NodeError as error:
        raise RigError(CONFIGURATION, f"{place.words}: {error}") from error
    answers = Answer(state.can_id, state.form, is_status), Answer(torque.can_id, torque.form, is_torque)
    return DriveChannel(axis, node, found, command, answers, scale, MotorPosition(drive, gear_ratio))


def _encoder(rig_file: RigFile, node: Node, configurator: Configurator) -> LinkChannel:
    pdo = objects.encoder_position(node.number, link_entry(rig_file.link))
    configurator.pdo(pdo)
    for other in _OTHER_TPDOS:
        configurator.silence(other)
    configurator.settings([heartbeat()])
    return LinkChannel(Answer(pdo.can_id, pdo.form), 0, LinkPosition(rig_file.link))


def _scale(place: Place, drive: Drive, gear_ratio: float, node: Node) -> TorqueScale:
    try:
        scale = TorqueScale.of(drive, node.read(objects.RATED_TORQUE, 0, "<I"), gear_ratio)
    except (NodeError, ValueError) as error:
        raise RigError(CONFIGURATION, f"{place.words}: rated torque: {error}") from error
    if scale.limit < 1:
        raise RigError(
            CONFIGURATION, f"{place.words}: torque_limit {drive.torque_limit:g} N·m is less than the drive can resolve"
        )
    return scale
