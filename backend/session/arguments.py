"""Arguments of the commands, as both REST and websocket take them."""

from typing import Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from backend.presets.contents import Note, PresetName, Tags
from vssea_core.scenario import Scenario


class Arguments(BaseModel):
    """Arguments of a command; unknown names are refused."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)

    @property
    def harmless(self) -> bool:
        """Whether these arguments can neither move a rig nor change how it moves, whatever the command else does."""
        return False


class Nothing(Arguments):
    """No arguments."""


class Named(Arguments):
    """A preset's name."""

    name: PresetName


class Saving(Named):
    """What to save the tuning in force as; `revision` is that of the preset as it is known."""

    note: Note = ""
    tags: Tags | None = None
    revision: int | None = Field(None, ge=1, strict=True, description="Needed where there is a preset of this name.")


class Applying(Named):
    """Which version of a preset to use, and which paths of the tuning; without them the newest, and all that differs."""

    version: int | None = Field(None, ge=1, strict=True)
    paths: list[str] | None = Field(None, max_length=64)


class Samples(Arguments):
    """How far to step."""

    samples: int = Field(1, ge=1, le=10_000, strict=True, description="Samples to advance.")


class Pace(Arguments):
    """How fast time runs."""

    factor: float = Field(ge=0.05, le=4.0, strict=True, description="Real-time factor asked.")


class SavePoint(Arguments):
    """What to call a save point."""

    name: str | None = Field(None, min_length=1, max_length=80, description="Its name; without one it gets its time.")


class EntryNumber(Arguments):
    """An entry of the history."""

    number: int = Field(ge=1, strict=True, description="Number of the entry.")


Label = Field(None, min_length=1, max_length=200, description="What to call it.")


class PinnedSpan(Arguments):
    """How much of the present run to pin."""

    seconds: float = Field(10.0, ge=0.1, le=60.0, strict=True, description="Length of the span.")
    to_s: float | None = Field(None, ge=0.0, strict=True, description="Where it ends in this run; without it, now.")
    label: str | None = Label


class ExcerptNumber(Arguments):
    """A pinned run, or what a trigger captured."""

    id: int = Field(ge=1, strict=True, description="Its number.")


class ExcerptChange(ExcerptNumber):
    """Another label, or whether it is shown."""

    label: str | None = Label
    shown: bool | None = Field(None, strict=True)


class Loading(Arguments):
    """Which scenario to load: a ready one by name, or a whole document."""

    name: str | None = Field(None, max_length=80)
    scenario: Scenario | None = None

    @model_validator(mode="after")
    def _one_of_them(self) -> Self:
        if (self.name is None) == (self.scenario is None):
            raise ValueError("give either a name or a scenario")
        return self
