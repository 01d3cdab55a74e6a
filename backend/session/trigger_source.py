"""What a trigger waits for, without clock and session: samples and events in, the instant at which it fires out."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, field_validator

from backend.session.arguments import Arguments
from backend.session.events import Event, Kind
from backend.telemetry.ring import EPOCH, Samples
from vssea_core.channels import CHANNELS, INDEX

Edge = Literal["rising", "falling", "either"]
EVENTS: dict[str, frozenset[Kind]] = {
    "limit": frozenset({"limit"}), "fault": frozenset({"fault"}), "tuning": frozenset({"tuning", "sequence"}),
    "disturbance": frozenset({"disturbance"}),
    "any": frozenset({"limit", "fault", "tuning", "sequence", "disturbance", "stiffness", "reference"}),
}  # fmt: skip


class EventSource(Arguments):
    """Fires at an event of the log."""

    kind: Literal["event"]
    event: Literal["limit", "fault", "tuning", "disturbance", "any"] = "any"

    def words(self) -> str:
        """Return what it waits for."""
        return "any event" if self.event == "any" else f"the next event of kind {self.event}"

    def fires_at(self, event: Event) -> bool:
        """Return whether an event is of the kind that it waits for."""
        return event.kind in EVENTS[self.event]


class LevelSource(Arguments):
    """Fires when a channel crosses a level."""

    kind: Literal["level"]
    channel: str = "error"
    level: float = Field(0.0, strict=True, description="In the channel's unit.")
    edge: Edge = "rising"

    @field_validator("channel")
    @classmethod
    def _known_channel(cls, name: str) -> str:
        if name not in INDEX or name == "time":
            raise ValueError(f"{name!r} is not a channel to trigger on; expected one of {', '.join(list(INDEX)[1:])}")
        return name

    def words(self) -> str:
        """Return what it waits for."""
        channel = CHANNELS[INDEX[self.channel]]
        return f"{channel.label} {self._way()} {self.level:.4g} {channel.unit}".rstrip()

    def _way(self) -> str:
        return {"rising": "rising through", "falling": "falling through", "either": "crossing"}[self.edge]


Source = Annotated[EventSource | LevelSource, Field(discriminator="kind")]


class Arming(Arguments):
    """What a trigger waits for, how much it keeps before and after, and whether it goes on afterwards."""

    source: Source
    before_s: float = Field(2.0, ge=0.0, le=30.0, strict=True, description="Seconds kept before the instant.")
    after_s: float = Field(1.0, ge=0.0, le=30.0, strict=True, description="Seconds kept after the instant.")
    repeat: bool = False


class Crossing:
    """Finds crossings of a level in consecutive pieces of samples; a crossing between two pieces is found too."""

    def __init__(self, source: LevelSource) -> None:
        self._column = INDEX[source.channel]
        self._level, self._edge = source.level, source.edge
        self._before: tuple[float, float] | None = None

    def forget(self) -> None:
        """Let the next sample be the first: samples before it are not known."""
        self._before = None

    def first(self, samples: Samples) -> int | None:
        """Return the index of the first sample (n, COLUMNS) that lies beyond the level when the one before did not.

        The first sample of all, and the first of each run, has none before it.
        """
        if not len(samples):
            return None
        values, runs = samples[:, self._column], samples[:, EPOCH]
        before_value, before_run = self._before or (np.nan, np.nan)
        previous = np.concatenate(([before_value], values[:-1]))
        same_run = np.concatenate(([before_run], runs[:-1])) == runs
        rising = (previous < self._level) & (values >= self._level)
        falling = (previous > self._level) & (values <= self._level)
        wanted = {"rising": rising, "falling": falling, "either": rising | falling}[self._edge]
        self._before = float(values[-1]), float(runs[-1])
        found = np.flatnonzero(wanted & same_run)
        return int(found[0]) if len(found) else None
