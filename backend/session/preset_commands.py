"""The session's commands on presets: save the tuning in force, use a saved one, delete one."""

import asyncio
from typing import TYPE_CHECKING, Any

from backend.presets.store import PresetStore
from backend.session.arguments import Named
from backend.session.changes import Changes
from vssea_core.control.tuning import Tuning

if TYPE_CHECKING:
    from backend.session.session import Session

Message = dict[str, Any]


class PresetCommands:
    """Saves, applies and deletes; every page is told."""

    def __init__(self, store: PresetStore, session: "Session") -> None:
        self._store, self._session = store, session

    async def save(self, asked: Named, by: str) -> Message:
        """Save the tuning in force under a name."""
        session = self._session
        return await self.save_tuning(asked.name, session.scenario.tuning, by)

    async def save_tuning(self, name: str, tuning: Tuning, by: str) -> Message:
        """Save any tuning under a name; if it is the one in force, the session is now on that preset."""
        session = self._session
        preset = await asyncio.to_thread(self._store.save, name, tuning)
        if tuning == session.scenario.tuning:
            session.preset = name
            session.save_soon()
        session.tell(session.document(by))
        session.note("preset", f"preset {name} saved", by)
        return preset.document()

    async def apply(self, asked: Named, by: str) -> Message:
        """Use a saved tuning."""
        session = self._session
        preset = await asyncio.to_thread(self._store.get, asked.name)
        answer = await session.tune(Changes(replace=preset.tuning.model_dump(mode="json")), by)
        session.preset = asked.name
        session.save_soon()
        session.tell(session.document(by))
        session.note("preset", f"preset {asked.name} applied", by)
        return answer

    async def delete(self, asked: Named, by: str) -> Message:
        """Delete a saved tuning; the one in force stays."""
        session = self._session
        await asyncio.to_thread(self._store.delete, asked.name)
        if session.preset == asked.name:
            session.preset = None
        session.tell(session.document(by))
        session.note("preset", f"preset {asked.name} deleted", by)
        return {}
