"""Going from the simulation to a rig and back: one control process ends before the other begins, on the same ring."""

import asyncio
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from backend.loop import messages
from backend.presets.last import InForce
from backend.problem import Problem
from backend.rigs.rig_file import RigFile
from backend.session.arguments import Nothing
from backend.session.control_link import RIG_ENTRY
from backend.session.rig_arguments import RigName
from backend.session.rig_tuning import Begun, begun_scenario
from backend.session.uninterrupted import to_the_end
from vssea_core.scenario import Scenario

if TYPE_CHECKING:
    from backend.session.session import Session

Message = dict[str, Any]
CONNECT_LIMIT_S = 30.0


class RigFiles(Protocol):
    """Who knows the rigs by name. Its methods may wait for a disk, so they are called in threads."""

    def file(self, name: str) -> RigFile:
        """Return a rig's file. Raises Problem 404 if there is none, 422 if it is not right."""


class NoRigs:
    """No rig is known."""

    def file(self, name: str) -> RigFile:
        """Raise Problem 404."""
        raise Problem(404, "No such rig", f"There is no rig {name!r}.")


@dataclass(frozen=True)
class Simulation:
    """What ran before a rig was connected."""

    scenario: Scenario
    preset: InForce | None
    run: bool


class RigConnection:
    """Connects, disconnects, and starts a control process that died anew. Each holds the session's turn."""

    def __init__(self, session: "Session", files: RigFiles) -> None:
        self._session, self._files = session, files
        self._before: Simulation | None = None
        self.bus = asyncio.Lock()
        """Held by whoever opens a rig's bus from this server."""

    async def connect(self, asked: RigName, by: str, key: str | None) -> Message:
        """Connect a rig and take control of it; what is refused leaves the simulation, from t = 0."""
        return await to_the_end(self._connect(asked.rig, by, key))

    async def disconnect(self, _: Nothing, by: str) -> Message:
        """Stop and disable the rig, and go back to the simulation."""
        return await to_the_end(self._disconnect(by))

    async def reconnect(self, by: str) -> None:
        """Connect the rig anew whose control process has ended; the caller holds the session's turn. Raises Problem."""
        session = self._session
        file = session.rig.file
        if file is None:
            return
        begun = await begun_scenario(session, file)
        session.rig.state.connecting = True
        try:
            await self._open(file, begun)
        except Problem:
            await session.link.stop()
            session.rig.state.connecting = False
            session.status.fail(f"rig {file.name} does not answer. Reset to connect it anew, or disconnect.")
            session.tell_state()
            raise
        self._adopt(file, begun, by)

    async def close(self) -> None:
        """End the rig's control process in order: drives disabled, bus closed. Without a rig nothing happens."""
        session = self._session
        if session.rig.file is not None:
            session.rig.state.leaving = True
            await session.link.stop(messages.Disconnect())
            await session.rig.control.end()

    async def _connect(self, name: str, by: str, key: str | None) -> Message:
        session = self._session
        async with session.turn, self.bus:
            session.commands.permit("connect_rig", key)  # another page may have been faster
            party = session.rig.control.take_for_connecting(key)
            begun, file = await self._planned(name)
            await session.kept.now()
            ran = session.status.state in ("starting", "running")
            self._before = Simulation(session.beginning, session.preset, ran)
            session.rig.state.begin(file)
            self._say_starting(f"Connecting rig {name}: its drives are found, checked and configured")
            try:
                await self._open(file, begun)
            except Problem as problem:
                await self._back_to_simulation()
                detail = f"{problem.detail.rstrip('.')}. The simulation is back."
                session.note("rig", f"rig {name} is not connected: {problem.detail}", by, "warning")
                raise Problem(409 if problem.status == 422 else problem.status, "Not connected", detail) from problem
            self._adopt(file, begun, by)
            session.rig.control.keep(party)
        return {"rig": file.name, "key": party.key, "tuning_id": session.status.tuning_id}

    async def _planned(self, name: str) -> tuple[Begun, RigFile]:
        file = await asyncio.to_thread(self._files.file, name)
        return await begun_scenario(self._session, file), file

    async def _open(self, file: RigFile, begun: Begun) -> None:
        session = self._session
        beats = session.rig.control.heart.begin()
        names = session.ring_name, session.flag.name, beats
        await session.link.start(*names, epoch=session.status.epoch, entry=RIG_ENTRY)
        number = session.status.tuning_id + 1
        connect = messages.Connect(file, begun.scenario, begun.prepared, number)
        await session.link.command(connect, CONNECT_LIMIT_S)
        session.status.tuning_id = number

    def _adopt(self, file: RigFile, begun: Begun, by: str) -> None:
        session = self._session
        session.running.load(begun.scenario)
        session.preset = begun.preset
        session.rig.state.up(begun.scenario)
        session.rig.good.forget()
        session.rig.moves.by = by
        session.margins.ask(begun.scenario, session.status.tuning_id)
        session.runs.begun()
        session.history.begin()
        session.tell(session.document(by))
        session.note("rig", f"rig {file.name} connected; {begun.words}", by)
        session.tell_state()

    async def _disconnect(self, by: str) -> Message:
        session = self._session
        async with session.turn:
            session.commands.permit("disconnect_rig", None, harmless=True)
            name = session.rig.name
            await self._back_to_simulation()
            session.note("rig", f"rig {name} disconnected; the simulation is back", by)
        return {}

    async def _back_to_simulation(self) -> None:
        session, before = self._session, self._before
        self._say_starting("Going back to the simulation")
        await self.close()
        session.rig.state.end()
        session.rig.cores.give_back()
        if before is None:
            return
        await session.start_control()
        session.preset = before.preset
        session.running.load(before.scenario)  # what its first state is told of
        await session.runs.load(before.scenario, run=before.run)
        session.history.begin()
        session.tell_state()

    def _say_starting(self, sentence: str) -> None:
        session = self._session
        session.status.state, session.status.reason = "starting", sentence
        session.tell_state()
