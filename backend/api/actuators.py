"""Actuators over REST: plants with where each value comes from and what was measured of them."""

import asyncio
from typing import Any, Self

from fastapi import APIRouter, Request
from pydantic import BaseModel, ConfigDict, Field, model_validator

from backend.api.caller import By
from backend.api.resources import body_named, body_of
from backend.api.versioned import Saved, checked, versioned_routes
from backend.compute.pool import JobFailedError, JobRefusedError, Pool
from backend.presets.contents import ActuatorContent, CalibrationPoint, ValueProvenance, live_actuator
from backend.problem import Problem, refused
from backend.session.session import Session
from vssea_core.actuator.parameters import Actuator


class SavedActuator(Saved):
    """What to save: without an actuator, the plant that runs live."""

    actuator: Actuator | None = None
    provenance: dict[str, ValueProvenance] | None = Field(None, max_length=64)
    calibration: tuple[CalibrationPoint, ...] = Field((), max_length=400)

    @model_validator(mode="after")
    def _whole(self) -> Self:
        if self.actuator is None and (self.provenance or self.calibration):
            raise ValueError(
                "provenance and calibration are of an actuator; give it too, or nothing for the one that runs"
            )
        if self.actuator is not None:
            ActuatorContent(actuator=self.actuator, provenance=self.provenance or {})
        return self


class WhichVersion(BaseModel):
    """Which version of an actuator to load; the newest if none is named."""

    model_config = ConfigDict(extra="forbid")

    version: int | None = Field(None, ge=1, strict=True)


def actuator_routes(session: Session, pool: Pool) -> APIRouter:
    """Return the routes; fits are computed by the analysis worker."""
    actuators = session.presets.actuators

    def content_of(asked: SavedActuator, _: str) -> ActuatorContent:
        if asked.actuator is None:
            return live_actuator(session.scenario)
        return ActuatorContent(
            actuator=asked.actuator, provenance=asked.provenance or {}, calibration=asked.calibration
        )

    router = versioned_routes(session, actuators, SavedActuator, content_of)

    @router.get("/actuators/{name}/calibration")
    async def calibration(name: str, version: int | None = None) -> dict[str, Any]:
        """Return the measured stiffness beside the model's, and the spring constant that fits best."""
        found = await asyncio.to_thread(actuators.get, name, version)
        content: ActuatorContent = found.content
        points = [(point.stiffness_motor_position, point.stiffness) for point in content.calibration]
        try:
            answer: dict[str, Any] = await pool.analysis.run(
                "calibrate", content.actuator.stiffness.spring_constant, points
            )
        except JobRefusedError as refusal:
            raise refused(f"{str(refusal)[:1].upper()}{str(refusal)[1:]}.") from refusal
        except JobFailedError as failure:
            raise Problem(503, "Not computed", f"The calibration could not be computed: {failure}.") from failure
        for row, point in zip(answer["rows"], content.calibration, strict=True):
            row["note"] = point.note
        return answer | {"version": found.version.number}

    @router.post("/actuators/{name}/apply", openapi_extra=body_named("version"))
    async def apply(name: str, request: Request, by: By) -> dict[str, Any]:
        """Load the live scenario anew, at t = 0, with a saved actuator as its plant."""
        asked = checked(WhichVersion, await body_of(request))
        return await session.presets.load_plant(name, asked.version, by)

    return router
