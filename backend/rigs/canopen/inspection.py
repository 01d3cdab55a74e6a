"""What the nodes of a bus say of themselves, beside what a rig's file expects; reads only."""

import math
from collections.abc import Callable

import can
import canopen

from backend.rigs.canopen import objects
from backend.rigs.canopen.cia402 import DriveState, drive_state
from backend.rigs.canopen.emergency import error_words
from backend.rigs.canopen.identity import Place, device_of, mismatches, places
from backend.rigs.canopen.nodes import Clock, Node, NodeError, hand_on
from backend.rigs.canopen.scaling import LinkPosition, TorqueScale
from backend.rigs.check import CheckLine, line
from backend.rigs.rig_file import Drive, RigFile

PAUSE_S, SEARCH_S = 1e-3, 0.3
"""Time between two questions to node numbers, so that no interface overflows, and for answers after the last."""
OUTSIDE_RAD = 0.1
"""How far beyond its limits the link may rest and still be plausible."""
MOST_OF_RATED = 10_000  # thousandths; a limit above it comes from a wrong unit
_QUESTION = b"\x40\x00\x10\x00\x00\x00\x00\x00"  # object 0x1000, to be read
_SAFETY = (
    (objects.CONSUMER_HEARTBEAT, 1, "watch on this computer"),
    (objects.ABORT_CONNECTION, 0, "reaction to a lost connection"),
    (objects.QUICK_STOP_OPTION, 0, "quick stop"),
    (objects.FAULT_REACTION_OPTION, 0, "reaction to a fault"),
    (objects.MAX_TORQUE, 0, "maximum torque"),
)


def inspected(bus: can.BusABC, rig_file: RigFile, gear_ratio: float, clock: Clock) -> list[CheckLine]:
    """Return a line for each thing that can be looked at on an open bus."""
    network = canopen.Network(bus)
    wanted, found = places(rig_file), _search(network, clock)
    missing = [place.words for place in wanted if place.node not in found]
    silent = f"No answer from {' and '.join(missing)}: check power, cable, bit rate and node number."
    lines = [line("nodes", _listed(found), _listed([place.node for place in wanted]), silent if missing else "")]
    for place in wanted:
        if place.node not in found:
            continue
        node = Node(network, place.node, clock)
        lines += _tried(place, "device", lambda: _device(place, node))  # noqa: B023 - called at once
        if place.drive is not None:
            lines += _drive(place, place.drive, node, gear_ratio if place.axis == "motor" else 1.0)
        if rig_file.link.source == (f"{place.axis}_drive" if place.axis else "node"):
            lines += _tried(place, "link position", lambda: _link(node, rig_file))  # noqa: B023 - called at once
    return lines


def _search(network: canopen.Network, clock: Clock) -> list[int]:
    answered: set[int] = set()

    def listen(until: float) -> None:
        while True:
            left = until - clock()
            message = network.bus.recv(max(0.0, left)) if network.bus else None
            if message is not None:
                if 0x580 < message.arbitration_id < 0x600:
                    answered.add(message.arbitration_id - 0x580)
                hand_on(network, message)
            elif left <= 0.0:
                return

    for number in range(1, 128):
        try:
            network.send_message(0x600 + number, _QUESTION)
        except (can.CanError, OSError):
            break
        listen(clock() + PAUSE_S)
    listen(clock() + SEARCH_S)
    return sorted(answered)


def _tried(place: Place, what: str, look: Callable[[], list[CheckLine]]) -> list[CheckLine]:
    try:
        return look()
    except NodeError as error:
        problem = f"The {place.name} does not tell this: {error}."
        return [line(f"{place.words}: {what}", str(error), "an answer", problem)]


def _device(place: Place, node: Node) -> list[CheckLine]:
    device = device_of(node)
    lines = [line(place.words, device.words, "an answer")]
    for what, found, expected in mismatches(place, device):
        problem = f"The {place.name} is another device: correct wiring, node number or file."
        lines.append(line(f"{place.words}: {what}", found, expected, problem))
    return lines


def _drive(place: Place, drive: Drive, node: Node, ratio: float) -> list[CheckLine]:
    name = place.words

    def modes() -> list[CheckLine]:
        modes = node.read(objects.SUPPORTED_MODES, 0, "<I")
        problem = (
            "" if modes & objects.CYCLIC_TORQUE_BIT else f"The {place.name} has no cyclic synchronous torque mode."
        )
        return [line(f"{name}: modes", f"0x{modes:08X}", "bit 9, cyclic synchronous torque", problem)]

    def rated() -> list[CheckLine]:
        units, problem = node.read(objects.RATED_TORQUE, 0, "<I"), ""
        share = 0
        try:
            share = TorqueScale.of(drive, units, ratio).limit
            if not 1 <= share <= MOST_OF_RATED:
                problem = f"rated_torque_unit, efficiency or torque_limit does not fit the {place.name}."
        except ValueError as error:
            problem = f"Set the motor data in the {place.name}: {error}."
        expected = f"{drive.torque_limit:g} N·m, {share / 10.0:g} % of rated, at most {MOST_OF_RATED // 10} %"
        return [line(f"{name}: rated torque", f"{units * drive.rated_torque_unit:.3g} N·m", expected, problem)]

    def position() -> list[CheckLine]:
        counts = node.read(objects.POSITION, 0, "<i")
        angle = drive.sign * math.tau * counts / (drive.counts_per_turn * ratio)
        return [line(f"{name}: position", f"{counts} counts, {angle:.3f} rad", "any")]

    def state() -> list[CheckLine]:
        there, problem = drive_state(node.read(objects.STATUS_WORD, 0, "<H")), ""
        words = str(there)
        if there in (DriveState.FAULT, DriveState.FAULT_REACTION, DriveState.UNKNOWN):
            words = f"{there} {error_words(node.read(objects.ERROR_CODE, 0, '<H'))}".strip()
            problem = f"The {place.name} reports {words}: clear its cause; Reset after connecting takes it out."
        return [line(f"{name}: state", words, "no fault", problem)]

    lines: list[CheckLine] = []
    for what, look in (("modes", modes), ("rated torque", rated), ("position", position), ("state", state)):
        lines += _tried(place, what, look)
    return lines + [_safety(place, drive, node, *entry) for entry in _SAFETY]


def _safety(place: Place, drive: Drive, node: Node, index: int, subindex: int, what: str) -> CheckLine:
    name = f"{place.words}: 0x{index:04X} {what}"
    try:
        return line(name, "0x" + node.read_bytes(index, subindex)[::-1].hex().upper(), "there")
    except NodeError as error:
        if index in drive.without:
            return line(name, str(error), "accepted to be missing")
        problem = f"The {place.name} lacks 0x{index:04X}: if you accept that, list it in `without`."
        return line(name, str(error), "there", problem)


def _link(node: Node, rig_file: RigFile) -> list[CheckLine]:
    link, limits = rig_file.link, rig_file.limits
    counts = node.read(link.index, link.subindex, f"<{objects.FORMS[link.bits]}")
    angle = LinkPosition(link).take(counts)
    inside = limits.link_low - OUTSIDE_RAD <= angle <= limits.link_high + OUTSIDE_RAD
    problem = (
        "" if inside else "Move the link inside its limits by hand, or correct link.zero, sign or counts_per_turn."
    )
    expected = f"{limits.link_low:g} to {limits.link_high:g} rad"
    return [line("link position", f"{counts} counts, {angle:.3f} rad", expected, problem)]


def _listed(numbers: list[int]) -> str:
    return ", ".join(map(str, sorted(numbers))) or "none"
