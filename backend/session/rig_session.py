"""All that a session has for rigs: the connection, who is in control, the commands, and what watches over them."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from backend.compute.pool import Pool
from backend.loop.messages import Changed, Moved, RigReport, State
from backend.loop.rig_states import DRIVEN
from backend.rigs.rig_file import RigFile
from backend.session.control_commands import ControlCommands
from backend.session.fault_excerpt import FaultExcerpts
from backend.session.good_tuning import GoodTuning
from backend.session.rig_commands import RigCommands
from backend.session.rig_connection import RigConnection, RigFiles
from backend.session.rig_limits import check_parts
from backend.session.rig_moves import RigMoves
from backend.session.rig_state import RigState
from backend.session.spare_core import SpareCore
from backend.session.tuning_return import return_to_good
from backend.session.tuning_trial import TuningTrial
from vssea_core.scenario import Scenario

if TYPE_CHECKING:
    from backend.session.session import Session

Message = dict[str, Any]


class RigSession:
    """Simulated sessions have one too; it then does nothing but keep faults."""

    def __init__(self, session: "Session", pool: Pool, files: RigFiles, clock: Callable[[], float]) -> None:
        self._session = session
        self.state = RigState()
        self.control = ControlCommands(session, clock)
        self.connection = RigConnection(session, files)
        self.commands = RigCommands(session, clock)
        self.moves = RigMoves(session, self.state)
        self.trial = TuningTrial(session, pool.simulation)
        self.faults = FaultExcerpts(session, clock)
        self.good = GoodTuning(clock)
        self.cores = SpareCore(pool.process_ids)

    @property
    def connected(self) -> bool:
        """Whether a rig is connected."""
        return self.state.connected

    @property
    def file(self) -> RigFile | None:
        """The rig's file, None while the session is simulated."""
        return self.state.file

    @property
    def name(self) -> str:
        """The rig's name."""
        return self.state.name

    def document(self, scenario: Scenario) -> Message:
        """Return rig and control, as the snapshot has them."""
        return {"rig": self.state.document(scenario), "control": self.control.document()}

    def check(self, new: Scenario, parts: list[str]) -> None:
        """Raise Problem if changed parts of the scenario ask for what a connected rig does not stand."""
        if self.connected and self.file is not None:
            check_parts(self.file, new, parts)

    def take(self, report: RigReport) -> None:
        """Take how the rig is."""
        if self.state.file is not None and self.state.take(report):
            self._session.tell_state()

    def moved(self, report: Moved) -> None:
        """Take what is really in force."""
        self.moves.take(report)

    def changed(self, report: Changed) -> None:
        """Take a change of the session's state: what follows a fault, and what must not run beside a rig under torque."""
        session = self._session
        self.state.enter(report.state)
        if report.state == "fault" and not self.state.connecting:
            self.faults.begin(report.epoch, report.time_s, session.sentence())
        if not self.connected:
            return
        if report.state not in ("stopping", "stopped"):
            session.status.stopped_by = None
        if self.good.enter(report.state, session.scenario.tuning):
            session.spawn(return_to_good(session, self.good))
        self._keep_core(report.state)

    def lost(self) -> None:
        """Take the end of the control process; the drives' own watchdogs stop a rig then."""
        session = self._session
        self.state.lost = self.connected
        self.faults.begin(session.status.epoch, session.status.time_s, session.sentence())
        self._keep_core("fault")

    def watch(self) -> None:
        """Look after what time alone changes; called ten times a second."""
        self.control.watch()
        self.faults.watch()
        if self.connected:
            self.commands.ends.look()
            self.good.install(self._session.scenario.tuning)
            self._keep_core(self._session.status.state)

    def leave(self, key: str) -> None:
        """Take control from a page that has closed; a rig under torque stops."""
        self.control.leave(key)

    async def close(self) -> None:
        """Disconnect as the server ends."""
        await self.connection.close()
        self.cores.give_back()

    def _keep_core(self, state: State) -> None:
        if self.connected and state in DRIVEN:
            self.cores.keep()
        else:
            self.cores.give_back()
