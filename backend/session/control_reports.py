"""What the control process reports: its state, changes that the sequence made, and its end."""

import asyncio
from typing import TYPE_CHECKING

from backend.loop import messages
from backend.session.events import Severity
from backend.session.fault_snapshot import save_fault_snapshot

if TYPE_CHECKING:
    from backend.session.session import Session

KEPT_OF_FAULT_S = 2.0


class ControlReports:
    """Takes each report over into the session's state and log."""

    def __init__(self, session: "Session") -> None:
        self._session = session

    def take(self, report: messages.Report) -> None:
        """Take a report that answers no command."""
        if isinstance(report, messages.Followed):
            self._session.parts.follow(report)
        if isinstance(report, messages.Changed):
            self._take_state(report)

    def lost(self) -> None:
        """Take the unexpected end of the control process."""
        session = self._session
        session.status.fail("the control process ended unexpectedly. Press Reset to start it anew.")
        session.note("fault", session.status.sentence(session.scenario), "server", "fault")
        session.tell_state()

    def _take_state(self, report: messages.Changed) -> None:
        session = self._session
        session.status.take(report)
        state = session.status.state
        severity: Severity = "fault" if state == "fault" else "warning" if state == "stopped" else "info"
        by = session.status.stopped_by or "server" if state == "stopped" else "session"
        session.note("fault" if state == "fault" else "state", session.status.sentence(session.scenario), by, severity)
        session.tell_state()
        if state == "fault":
            session.spawn(self._keep_fault())

    async def _keep_fault(self) -> None:
        session = self._session
        period_s = session.scenario.timing.sample_time_s
        file = await asyncio.to_thread(
            save_fault_snapshot,
            session.settings.data_dir,
            session.ring.last(round(KEPT_OF_FAULT_S / period_s)),
            session.scenario,
            session.status.reason,
        )
        session.note("fault", f"The last {KEPT_OF_FAULT_S:g} s before the fault are kept in {file}", "server")
