"""A look at a rig that moves nothing and writes nothing: who answers, and whether that is what its file says."""

import time
from collections.abc import Callable
from typing import TypedDict

from backend.rigs.rig import RigError
from backend.rigs.rig_file import SIMULATED, RigFile
from vssea_core.actuator.parameters import Actuator


class CheckLine(TypedDict):
    """One thing that was looked at."""

    what: str
    found: str
    expected: str
    ok: bool
    sentence: str  # what is wrong and what to do; "" where it is ok


def line(what: str, found: str, expected: str, problem: str = "") -> CheckLine:
    """Return a line that is ok where there is no problem."""
    return CheckLine(what=what, found=found, expected=expected, ok=not problem, sentence=problem)


def check_rig(
    rig_file: RigFile, gear_ratio: float | None = None, *, clock: Callable[[], float] = time.monotonic
) -> list[CheckLine]:
    """Return what was found beside what the file expects; `gear_ratio` is the actuator's, the default one's if not given."""
    if rig_file.bus.interface == SIMULATED:
        return [line("rig", "simulated, no bus", "simulated, no bus")]
    from backend.rigs.canopen.inspection import inspected
    from backend.rigs.canopen.opening import open_bus

    where = f"{rig_file.bus.interface} {rig_file.bus.channel}"
    try:
        bus = open_bus(rig_file.bus)
    except RigError as error:
        return [line("CAN bus", "not open", where, str(error))]
    ratio = Actuator().motor.gear_ratio if gear_ratio is None else gear_ratio
    try:
        return [line("CAN bus", where, where), *inspected(bus, rig_file, ratio, clock)]
    finally:
        bus.shutdown()
