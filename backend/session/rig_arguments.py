"""Arguments of the commands of a rig and of control over it."""

from typing import Any

from pydantic import Field

from backend.session.arguments import Arguments
from backend.session.operator_lease import LONGEST_LEASE_S
from backend.telemetry.beats import LEASE_S


class RigName(Arguments):
    """Which rig to connect."""

    rig: str = Field(min_length=1, max_length=60, description="Its name, as `GET /api/rigs` lists it.")


class Jogging(Arguments):
    """Velocities for as long as this is renewed; both 0 = let go."""

    link: float = Field(0.0, strict=True, description="rad/s.")
    stiffness: float = Field(0.0, strict=True, description="N·m/rad a second.")

    @property
    def harmless(self) -> bool:
        """Letting go is allowed to anybody."""
        return self.link == 0.0 and self.stiffness == 0.0


class Going(Arguments):
    """Where to move the link, and how fast at most."""

    position: float = Field(strict=True, description="rad.")
    speed: float = Field(0.2, gt=0.0, strict=True, description="rad/s.")


class Trial(Arguments):
    """A tuning to try in simulation: paths relative to the tuning, with their values."""

    changes: dict[str, Any] = Field(default_factory=dict, max_length=64)


class TakingControl(Arguments):
    """For how long the lease lasts without a renewal; a page keeps the shortest."""

    expires_s: float = Field(LEASE_S, ge=LEASE_S, le=LONGEST_LEASE_S, strict=True)


class Handing(Arguments):
    """Whom to give control to."""

    to: str = Field(min_length=1, max_length=40, description="A page's name, or who asks.")
