"""Presets over REST: saved tunings with the scenario each was made with."""

from typing import Any

from fastapi import APIRouter, Request

from backend.api.caller import By, Key
from backend.api.resources import body_named, body_of
from backend.api.versioned import Saved, checked, versioned_routes
from backend.presets.contents import PresetContent, PresetProvenance, live_preset
from backend.session.arguments import Applying
from backend.session.session import Session
from vssea_core import __version__
from vssea_core.control.tuning import Tuning
from vssea_core.scenario import Scenario


class SavedPreset(Saved):
    """What to save: without both, what runs live; with a scenario alone, its own tuning."""

    tuning: Tuning | None = None
    scenario: Scenario | None = None


def preset_routes(session: Session) -> APIRouter:
    """Return the routes."""

    def content_of(asked: SavedPreset, by: str) -> PresetContent:
        tuning = asked.tuning or (asked.scenario.tuning if asked.scenario else None)
        if tuning is None:
            return live_preset(session.scenario, session.status.time_s, asked.author or by)
        provenance = PresetProvenance(source="rest", vssea=__version__, by=asked.author or by)
        return PresetContent(tuning=tuning, scenario=asked.scenario, provenance=provenance)

    router = versioned_routes(session, session.presets.presets, SavedPreset, content_of)

    @router.post("/presets/{name}/apply", openapi_extra=body_named("version, paths"))
    async def apply(name: str, request: Request, by: By, key: Key) -> dict[str, Any]:
        """Use a saved tuning in the live session: only what differs is sent."""
        body = await body_of(request)
        asked = checked(Applying, {"name": name} | body if isinstance(body, dict) else body)
        return await session.command("apply_preset", asked.model_dump() | {"name": name}, by, key)

    return router
