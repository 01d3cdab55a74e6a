"""The emulator's rig file on the bus in memory."""

from importlib.resources import files
from typing import Any

import can

from backend.rigs.canopen import CanopenRig
from backend.rigs.faults import Fault
from backend.rigs.library import rig_file_of
from backend.rigs.rig import Measured
from backend.rigs.rig_file import Bus, RigFile
from tests.hardware.fake_bus import FakeBus, FakeDrive, FakeEncoder
from tests.injected_clock import Clock

RIG_FILE = rig_file_of((files("backend.rigs") / "emulator.toml").read_text("utf-8"))
GEAR_RATIO = 100.0
RATED_UNITS = {"motor": 533_000, "stiffness": 440_000}  # µN·m


def changed(**changes: Any) -> RigFile:
    """The rig file with other fields, by section."""
    document = RIG_FILE.model_dump()
    for section, fields in changes.items():
        document[section] = {**document[section], **fields} if isinstance(fields, dict) else fields
    return RigFile.model_validate(document)


class FakeRig:
    """A rig and what stands behind it."""

    def __init__(self, rig_file: RigFile = RIG_FILE) -> None:
        self.file = rig_file
        self.clock = Clock()
        self.bus = FakeBus(self.clock)
        self.motor = FakeDrive(self.bus, 1, RATED_UNITS["motor"])
        self.stiffness = FakeDrive(self.bus, 2, RATED_UNITS["stiffness"])
        self.link = FakeEncoder(self.bus, 3)
        self.rig = CanopenRig(rig_file, GEAR_RATIO, opened=self._opened, clock=self.clock)

    def _opened(self, bus: Bus) -> can.BusABC:
        return self.bus  # type: ignore[return-value]

    def ready(self) -> "FakeRig":
        self.rig.connect()
        self.rig.identify()
        self.rig.configure()
        return self

    def turn(self, motor: float = 0.0, stiffness: float = 0.0, cycles: int = 1) -> Measured:
        """Some cycles, each a period after the one before it."""
        for _ in range(cycles):
            began = self.clock.now
            measured = self.rig.exchange(motor, stiffness)
            self.clock.now = max(self.clock.now, began + self.rig.period_s)
        return measured

    def armed(self) -> "FakeRig":
        self.ready()
        self.turn()
        for axis in ("motor", "stiffness"):
            self.rig.arm(axis)
        self.turn(cycles=4)
        assert self.rig.axis("motor").state == self.rig.axis("stiffness").state == "enabled"
        return self


MOTOR_UNIT = 0.533 * 100.0 * 0.7 / 1000.0
"""N m at the gear side in a thousandth of the motor's rated torque."""


def ages(measured: Measured) -> tuple[int, int, int]:
    return measured.link_age, measured.motor_age, measured.stiffness_age


def faults(fake: FakeRig) -> list[Fault]:
    return [fault for fault, _ in fake.rig.bus_faults()]
