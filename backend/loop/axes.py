"""The two drives of a rig: where each was told to go, where it is, and what it means if the two differ."""

from collections.abc import Callable

from backend.rigs.faults import HOT, LEFT_ENABLED, MOTOR_DRIVE, STIFFNESS_DRIVE, Fault
from backend.rigs.rig import AXES, Axis, AxisStatus, Rig, RigError

NAMES: dict[Axis, str] = {"motor": "motor drive", "stiffness": "stiffness drive"}
DRIVE_FAULT: dict[Axis, Fault] = {"motor": MOTOR_DRIVE, "stiffness": STIFFNESS_DRIVE}
TEMPERATURE_CODES = (0x41, 0x42, 0x43)
"""High bytes of the CiA 402 error codes of an over-temperature: ambient, device, drive."""

Found = list[tuple[Fault, str]]


class Axes:
    """Tells the drives where to go, never raises, and looks once a cycle where they are."""

    def __init__(self, rig: Rig) -> None:
        self._rig = rig
        self._on: dict[Axis, bool] = {"motor": False, "stiffness": False}  # told to be enabled, and seen to be
        self._wanted: dict[Axis, bool] = dict(self._on)
        self._errors: Found = []
        self.status: dict[Axis, AxisStatus] = {axis: AxisStatus(axis, "unknown", "not yet seen") for axis in AXES}

    def arm(self, axis: Axis) -> None:
        """Let an axis go to "enabled"."""
        if not self._wanted[axis]:
            self._wanted[axis], self._on[axis] = True, False
            self._tell(self._rig.arm, axis)

    def stop(self, axis: Axis) -> None:
        """Let the drive stop an axis by itself."""
        self._wanted[axis] = self._on[axis] = False
        self._tell(self._rig.stop, axis)

    def disarm(self, axis: Axis) -> None:
        """Let an axis go to "disabled"."""
        self._wanted[axis] = self._on[axis] = False
        self._tell(self._rig.disarm, axis)

    def reset_faults(self) -> None:
        """Ask each drive that is at fault once to leave it."""
        for axis in AXES:
            if self.status[axis].state == "fault":
                self._tell(self._rig.reset, axis)

    def enabled(self, *axes: Axis) -> bool:
        """Return whether all of `axes` are meant to be enabled and have come to be so, as far as is known."""
        return all(self._on[axis] for axis in axes)

    def on(self, axis: Axis) -> bool:
        """Return whether an axis may still give a torque: it is on its way to enabled, enabled or stopping."""
        return self._wanted[axis] or self.status[axis].state in ("enabling", "enabled", "stopping")

    @property
    def any_on(self) -> bool:
        """Whether any axis is on."""
        return any(self.on(axis) for axis in AXES)

    def at_fault(self) -> str | None:
        """Return in words which drive still reports a fault, or None."""
        for axis in AXES:
            if self.status[axis].state == "fault":
                return f"the {NAMES[axis]} still reports {_error(self.status[axis])}"
        return None

    def look(self) -> Found:
        """Return what is wrong with the drives: their own faults, and leaving operation untold."""
        found, self._errors = self._errors, []
        for axis in AXES:
            self._tell(self._see, axis)
            status = self.status[axis]
            if status.state == "fault":
                hot = status.error_code >> 8 in TEMPERATURE_CODES
                found.append(
                    (HOT if hot else DRIVE_FAULT[axis], f"{NAMES[axis]}: {_error(status)}" if hot else _error(status))
                )
                self._give_up(axis)
            elif self._wanted[axis] and status.state == "enabled":
                self._on[axis] = True
            elif self._on[axis] and status.state != "unknown":
                found.append((LEFT_ENABLED, f"{NAMES[axis]}: {status.words}"))
                self._give_up(axis)
        return found

    def _give_up(self, axis: Axis) -> None:
        """Take back the wish to be enabled, so that nothing brings the axis back; a drive that stops it may go on with that."""
        if self._wanted[axis]:
            (self.stop if self.status[axis].state == "stopping" else self.disarm)(axis)

    def _see(self, axis: Axis) -> None:
        self.status[axis] = self._rig.axis(axis)

    def _tell(self, order: Callable[[Axis], None], axis: Axis) -> None:
        try:
            order(axis)
        except RigError as error:
            self._errors.append((error.fault, error.detail))


def _error(status: AxisStatus) -> str:
    """Return a drive's own words for its error, with the code."""
    code = f"error 0x{status.error_code:04X}" if status.error_code else "a fault"
    return f"{code}, {status.error_words}" if status.error_words else code
