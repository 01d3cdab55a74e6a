"""What the session knows of its rig: its file, its newest report, and what is really in force there."""

from dataclasses import asdict
from typing import Any

from backend.loop.messages import RigReport, State
from backend.rigs.rig_file import RigFile
from vssea_core.scenario import Scenario

LABELS = {"simulated": "simulated rig", "emulated": "emulated rig", "real": "real rig"}
SIMULATED: dict[str, Any] = {"kind": "simulated", "label": LABELS["simulated"], "name": None, "connected": False}
OF_REPORT = ("homed", "span_found", "motion", "link_age", "lease_left_s")


class RigState:
    """Nothing is known while the session is simulated."""

    def __init__(self) -> None:
        self.file: RigFile | None = None
        self.connected = False
        self.connecting = False
        self.lost = False
        """Whether its control process has ended, so that it has to be connected anew."""
        self.leaving = False
        """Whether it is being disconnected: that it stops is no news."""
        self.report: RigReport | None = None
        self._state: State | None = None
        self._told_in: State | None = None
        self.in_force: Scenario | None = None
        """The scenario with the reference that the rig really follows; the document's is the one that is wanted."""

    def begin(self, file: RigFile) -> None:
        """Know the rig that is being connected."""
        self.end()
        self.file, self.connecting = file, True

    def up(self, scenario: Scenario) -> None:
        """Know that it is connected, with a scenario in force."""
        self.connected, self.connecting, self.lost, self.in_force = True, False, False, scenario

    def end(self) -> None:
        """Know nothing."""
        self.file, self.report, self.in_force = None, None, None
        self.connected = self.connecting = self.lost = self.leaving = False

    def enter(self, state: State) -> None:
        """Hear of a state; what was reported before says nothing of it."""
        self._state = state

    def take(self, report: RigReport) -> bool:
        """Take the newest report; return whether it says something new beyond its figures."""
        before, self.report = self.report, report
        is_first, self._told_in = self._told_in != self._state, self._state
        return is_first or before is None or _words(before) != _words(report)

    @property
    def motion(self) -> str:
        """What the link does, in words; "" until the present state has told it."""
        return self.report.motion if self.report is not None and self._told_in == self._state else ""

    @property
    def name(self) -> str:
        """Name of the rig, of its file."""
        return self.file.name if self.file is not None else ""

    @property
    def kind(self) -> str:
        """Which kind of rig it is; before it has said so it counts as a real one."""
        if self.file is None:
            return "simulated"
        return self.report.kind if self.report is not None else "real"

    def fault_sentence(self) -> str | None:
        """Return number and sentence of the first fault that latched, None if none did."""
        faults = self.report.faults if self.report is not None else ()
        return f"{faults[0].number}: {faults[0].sentence}" if faults else None

    def document(self, scenario: Scenario) -> dict[str, Any]:
        """Return it as docs/protocol.md has it; `scenario` is the one in the document."""
        file, report = self.file, self.report
        if file is None:
            return dict(SIMULATED)
        known = {"kind": self.kind, "label": LABELS[self.kind], "name": file.name, "connected": self.connected}
        known |= {
            "limits": file.limits.model_dump(mode="json"), "rate_hz": file.rate_hz,
            "gear_ratio": scenario.actuator.motor.gear_ratio, "torque_constant": file.motor.torque_constant,
            "efficiency": file.motor.efficiency,
        }  # fmt: skip
        return known | (_of_report(report) if report is not None else {})


def _of_report(report: RigReport) -> dict[str, Any]:
    return {name: getattr(report, name) for name in OF_REPORT} | {
        "cannot_arm": list(report.cannot_arm),
        "axes": [asdict(axis) for axis in report.axes],
        "faults": [asdict(fault) for fault in report.faults],
        "bus": {
            "cycles": report.cycles, "late_answers": report.late_answers, "missed_cycles": report.missed_cycles,
            "round_trip_us": report.round_trip_us,
        },
        "devices": [list(device) for device in report.identity.devices],
    }  # fmt: skip


def _words(report: RigReport) -> tuple[Any, ...]:
    axes = tuple((axis.state, axis.error_code) for axis in report.axes)
    return report.kind, report.homed, report.cannot_arm, axes, report.faults, report.identity
