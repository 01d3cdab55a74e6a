"""The session's commands on presets and actuators: save what is in force, use what is saved, tell every page."""

import asyncio
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from backend.presets.comparison import compared
from backend.presets.contents import ACTUATOR, PRESET, live_preset
from backend.presets.documents import Content, Documents
from backend.presets.found import Found, line
from backend.presets.last import InForce
from backend.session.arguments import Applying, Loading, Named, Saving
from backend.session.changes import Changes, validated
from backend.session.permission import Permission, granted
from backend.store.database import Database
from backend.store.document import Edit
from backend.store.expected import Expected

if TYPE_CHECKING:
    from backend.session.session import Session

Message = dict[str, Any]


class PresetCommands:
    """Saves, applies, edits and archives; what is in force and the log follow."""

    def __init__(self, database: Database, session: "Session") -> None:
        self.presets, self.actuators = Documents(database, PRESET), Documents(database, ACTUATOR)
        self._session = session

    async def save(self, asked: Saving, by: str) -> Message:
        """Save the tuning in force, with its scenario, as a new version; `revision` is needed where there is one already."""
        content = live_preset(self._session.scenario, self._session.status.time_s, by)
        expected = Expected.revision(asked.revision)
        found = await self.put(self.presets, asked.name, content, expected, by, by, asked.note, asked.tags)
        return line(found.document) | {"content": found.raw}

    async def apply(self, asked: Applying, by: str, permit: Permission = granted) -> Message:
        """Use a saved tuning: only what differs is sent, or only `paths` of it."""
        session = self._session
        live = session.scenario.tuning
        difference = await asyncio.to_thread(compared, self.presets, asked.name, asked.version, "live", live)
        changes = difference.chosen(asked.paths)
        answer: Message = {"tuning_id": session.status.tuning_id, "applied": {}}
        if changes:
            answer = await session.parts.tune(Changes(changes=changes), by, permit)
        found = difference.found
        if found.fit.model is not None and found.part == session.scenario.tuning:
            session.preset = InForce.of(found)
            session.kept.soon()
        session.tell(session.document(by))
        count = f"{len(changes)} change{'s' if len(changes) != 1 else ''}"
        session.note("preset", f"preset {asked.name} applied, version {found.version.number}: {count}", by)
        return answer

    async def delete(self, asked: Named, by: str) -> Message:
        """Archive a preset; the tuning in force stays."""
        await self.archive(self.presets, asked.name, None, by)
        return {}

    async def load_plant(self, name: str, version: int | None, by: str) -> Message:
        """Load the live scenario anew with a saved actuator as its plant; on a rig this is refused."""
        session = self._session
        session.commands.permit("load_scenario", None)
        found = await asyncio.to_thread(self.actuators.get, name, version)
        document = session.beginning.model_dump(mode="json") | {"actuator": found.part.model_dump(mode="json")}
        answer = await session.load_scenario(Loading(scenario=validated(document)), by)
        session.note("scenario", f"plant of actuator {name}, version {found.version.number}, loaded", by)
        return answer

    async def put(
        self, documents: Documents, name: str, content: Content, expected: Expected | None, by: str, author: str, note: str,
        tags: tuple[str, ...] | None,
    ) -> Found:  # fmt: skip
        """Save any content as a new version; if it is the tuning in force, the session is now on that preset."""
        found = await asyncio.to_thread(documents.put, name, content, expected, author, note, tags)
        self._changed(documents, found, f"saved, version {found.version.number}", by)
        return found

    async def edit(self, documents: Documents, name: str, asked: Edit, expected: Expected | None, by: str) -> Found:
        """Change what is said about a document."""
        found, words = await asyncio.to_thread(documents.edit, name, asked, expected, by)
        if words:
            self._changed(documents, found, words, by)
        return found

    async def restore(self, documents: Documents, name: str, number: int, expected: Expected | None, by: str) -> Found:
        """Make an old version the newest."""
        found = await asyncio.to_thread(documents.restore, name, number, expected, by)
        self._changed(documents, found, f"version {number} restored as version {found.version.number}", by)
        return found

    async def archive(self, documents: Documents, name: str, expected: Expected | None, by: str) -> Found:
        """Take a document out of the list."""
        found = await asyncio.to_thread(documents.archive, name, expected, by)
        self._changed(documents, found, "archived", by)
        return found

    def imported(self, documents: Documents, kept: list[Found], by: str) -> None:
        """Tell of documents that an import has changed."""
        for found in kept:
            self._changed(documents, found, f"imported, version {found.version.number}", by)

    def _changed(self, documents: Documents, found: Found, words: str, by: str) -> None:
        session = self._session
        if documents is self.presets:
            session.preset = self._in_force(found)
            session.tell(session.document(by))
            session.kept.soon()
        session.note("preset", f"{documents.kind.name} {found.document.name}: {words}", by)

    def _in_force(self, found: Found) -> InForce | None:
        now, document = self._session.preset, found.document
        is_it = now is not None and now.document_id == document.id
        if is_it and document.archived_at is not None:
            return None
        if found.fit.model is not None and found.part == self._session.scenario.tuning:
            return InForce.of(found)
        if now is None or not is_it:
            return now
        # The revision stays that of the version in force: saving over a newer one must be refused.
        revision = document.revision if document.newest.number == now.version else now.revision
        return replace(now, name=document.name, revision=revision)
