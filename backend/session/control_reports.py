"""What the control process reports: its state, changes that the sequence made, how a rig is, and its end."""

from typing import TYPE_CHECKING

from backend.loop import messages
from backend.session.events import Severity

if TYPE_CHECKING:
    from backend.session.session import Session


LOST = "the control process ended unexpectedly. Press Reset to start it anew."
RIG_LOST = (
    "the control process ended unexpectedly; the drives stop the rig by their own watchdogs. Press Reset to connect it anew, "
    "or disconnect."
)


class ControlReports:
    """Takes each report over into the session's state and log."""

    def __init__(self, session: "Session") -> None:
        self._session = session

    def take(self, report: messages.Report) -> None:
        """Take a report that answers no command."""
        if isinstance(report, messages.Followed):
            self._session.parts.follow(report)
        elif isinstance(report, messages.Changed):
            if report.state == "fault" or not self._session.rig.state.leaving:
                self._take_state(report)
        elif isinstance(report, messages.RigReport):
            self._session.rig.take(report)
        elif isinstance(report, messages.Moved):
            self._session.rig.moved(report)

    def lost(self) -> None:
        """Take the unexpected end of the control process."""
        session = self._session
        if session.rig.state.connecting:
            return  # who connects hears it as the answer
        session.status.fail(RIG_LOST if session.rig.connected else LOST)
        session.rig.lost()
        session.note("fault", session.sentence(), "server", "fault")
        session.tell_state()

    def _take_state(self, report: messages.Changed) -> None:
        session = self._session
        session.status.take(report)
        state = session.status.state
        severity: Severity = "fault" if state == "fault" else "warning" if state == "stopped" else "info"
        by = session.status.stopped_by or "server" if state == "stopped" else "session"
        session.rig.changed(report)
        session.note("fault" if state == "fault" else "state", session.sentence(), by, severity)
        session.tell_state()
