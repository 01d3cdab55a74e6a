"""What state a session is in, and since when: kept from the control process's reports, told in words and figures."""

from dataclasses import dataclass
from typing import Any

from backend.loop.messages import Changed, State
from backend.session.rig_sentences import rig_sentence
from backend.session.rig_state import RigState
from backend.session.sentences import state_sentence
from backend.telemetry.ring import EPOCH, Samples
from vssea_core.channels import INDEX
from vssea_core.scenario import Scenario


@dataclass
class Status:
    """The state of one session as the web process knows it."""

    state: State = "starting"
    reason: str | None = None
    stopped_by: str | None = None
    epoch: int = 0
    time_s: float = 0.0
    changed_at_s: float = 0.0
    pace: float = 1.0
    tuning_id: int = 0

    def take(self, report: Changed) -> None:
        """Adopt a change of state."""
        self.state, self.reason = report.state, report.reason
        self.epoch = report.epoch
        self.time_s = self.changed_at_s = report.time_s

    def fail(self, reason: str) -> None:
        """Adopt a fault that the control process cannot tell of itself."""
        self.state, self.reason = "fault", reason

    def follow(self, newest: Samples | None) -> None:
        """Let time go on with the newest sample of this epoch."""
        if newest is not None and newest[EPOCH] == self.epoch:
            self.time_s = max(self.time_s, float(newest[INDEX["time"]]))

    def sentence(self, scenario: Scenario) -> str:
        """Return what a simulated session is doing, and why."""
        return state_sentence(self.state, self.reason, self.changed_at_s, self.stopped_by, scenario)

    def rig_sentence(self, rig: RigState) -> str:
        """Return what a rig is doing, and why."""
        return rig_sentence(self.state, self.reason, self.changed_at_s, self.stopped_by, rig)

    def snapshot(self, sentence: str, rig: dict[str, Any], figures: dict[str, Any], pages: int) -> dict[str, Any]:
        """Return the state, `rig` with who is in control, and `figures` of the ring as docs/protocol.md has them."""
        return {
            "state": self.state,
            "sentence": sentence,
            "reason": self.reason,
            **rig,
            "time_s": self.time_s,
            "epoch": self.epoch,
            "tuning_id": self.tuning_id,
            "pace": {"asked": self.pace, "achieved": figures.pop("achieved")},
            "pages": pages,
            **figures,
        }
