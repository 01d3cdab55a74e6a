"""The batch document: a base scenario, how it is varied, and what is kept of each run. Imports no numba and no scipy."""

import difflib
import math
from typing import Annotated, Literal, Self

from pydantic import Field, JsonValue, ValidationInfo, field_validator, model_validator

from vssea_core.channels import CHANNELS, INDEX
from vssea_core.fields import Part, choice, kind, parameter
from vssea_core.scenario import Scenario

Path = Annotated[str, Field(min_length=1, max_length=200, title="path")]
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
MOST_VALUES = 1_000_000


class Grid(Part):
    """Evenly spaced values of one field, ends included."""

    kind: Literal["grid"] = kind("grid")
    path: Path
    low: Number
    high: Number
    count: int = Field(11, ge=1, le=100_000, strict=True)
    spacing: Literal["linear", "log"] = "linear"
    factor: bool = Field(False, description="Whether the values are factors of what the base scenario has there.")


class Listed(Part):
    """The values of one field, written down; they may be of any type the field takes."""

    kind: Literal["list"] = kind("list")
    path: Path
    values: tuple[JsonValue, ...] = Field(min_length=1, max_length=100_000)
    factor: bool = Field(False, description="Whether the values are factors of what the base scenario has there.")

    @field_validator("values")
    @classmethod
    def _are_finite(cls, values: tuple[JsonValue, ...], info: ValidationInfo) -> tuple[JsonValue, ...]:
        for place, value in enumerate(values):
            if not _is_finite(value):
                raise ValueError(f"value {place} of {info.data.get('path')} is {value}; expected finite numbers")
        return values


class Uniform(Part):
    """Any value between two ends, each as likely as the others."""

    kind: Literal["uniform"] = kind("uniform")
    low: Number
    high: Number


class LogUniform(Part):
    """Any value between two positive ends, each decade as likely as the others."""

    kind: Literal["log_uniform"] = kind("log_uniform")
    low: Number = Field(gt=0.0)
    high: Number = Field(gt=0.0)


class Normal(Part):
    """Values around a mean; none further away than `within` standard deviations."""

    kind: Literal["normal"] = kind("normal")
    mean: Number
    std: Number = Field(ge=0.0)
    within: Number = Field(4.0, gt=0.0, le=8.0)


Distribution = Annotated[Uniform | LogUniform | Normal, Field(discriminator="kind")]


class Draw(Part):
    """One field of a sample, and how it is distributed."""

    path: Path
    distribution: Distribution
    factor: bool = Field(False, description="Whether the values are factors of what the base scenario has there.")

    @model_validator(mode="after")
    def _ends_are_in_order(self) -> Self:
        if not isinstance(self.distribution, Normal):
            low, high = self.distribution.low, self.distribution.high
            if low > high:
                raise ValueError(f"{self.path} is drawn from {low:g} to {high:g}; expected the lower end first")
            if not math.isfinite(high - low):
                raise ValueError(f"{self.path} is drawn from {low:g} to {high:g}; expected ends closer together")
        return self


class Sample(Part):
    """Random values of several fields at once: independent, or spread evenly over the space of all of them."""

    kind: Literal["sample"] = kind("sample")
    count: int = Field(1000, ge=1, le=MOST_VALUES, strict=True)
    method: Literal["random", "sobol", "latin_hypercube"] = "random"
    draws: tuple[Draw, ...] = Field(min_length=1, max_length=32)


class Zipped(Part):
    """Fields that are varied together: the first values of all, then the second ones, and so on."""

    kind: Literal["zip"] = kind("zip")
    members: tuple[Annotated[Grid | Listed, Field(discriminator="kind")], ...] = Field(min_length=1, max_length=32)

    @model_validator(mode="after")
    def _lengths_agree(self) -> Self:
        lengths = [count_of(member) for member in self.members]
        if len(set(lengths)) > 1:
            told = ", ".join(f"{member.path} {length}" for member, length in zip(self.members, lengths, strict=True))
            raise ValueError(f"fields varied together need equally many values, but there are {told}")
        return self


Variation = Annotated[Grid | Listed | Sample | Zipped, Field(discriminator="kind")]


class Keep(Part):
    """What is kept of each run besides its metrics."""

    trajectories: Literal["none", "ended", "all"] = choice(
        "none", "trajectories", meaning="Of which runs samples are kept: of none, of those that ended early, or of all."
    )
    channels: tuple[str, ...] = Field(
        ("reference", "link_position", "motor_torque"), min_length=1, max_length=len(CHANNELS)
    )
    every: int = Field(10, ge=1, le=100_000, strict=True, description="Keeps one sample of so many.")
    precision: Literal["float32", "float64"] = "float32"

    @field_validator("channels")
    @classmethod
    def _known_channels(cls, names: tuple[str, ...]) -> tuple[str, ...]:
        for name in names:
            if name not in INDEX:
                near = difflib.get_close_matches(name, INDEX, 3, cutoff=0.3)
                raise ValueError(f"there is no channel {name!r}; nearest: {', '.join(near or list(INDEX)[:3])}")
        return names


class Batch(Part):
    """Many runs of one scenario with some of its fields varied; the parts of `vary` are crossed, the last one changes fastest."""

    name: str = Field("batch", min_length=1, max_length=80)
    description: str = Field("", max_length=2000)
    scenario: Scenario = Scenario()
    vary: tuple[Variation, ...] = Field((), max_length=16)
    seed: int = parameter(
        0, "seed", unit="", low=0, high=2**31 - 1, typical=(0, 1000), step=1,
        meaning="Of all random values: the same seed gives the same runs, however many computers share them.",
    )  # fmt: skip
    noise: Literal["same", "own"] = choice(
        "same",
        "noise",
        meaning="Whether all runs have the scenario's seed, or each its own: seed plus the run's number.",
    )
    keep: Keep = Keep()


def count_of(variation: Grid | Listed | Sample | Zipped) -> int:
    """Return how many values a variation has."""
    match variation:
        case Listed():
            return len(variation.values)
        case Zipped():
            return count_of(variation.members[0])
        case _:
            return variation.count


def _is_finite(value: JsonValue) -> bool:
    match value:
        case float():
            return math.isfinite(value)
        case list():
            return all(map(_is_finite, value))
        case dict():
            return all(map(_is_finite, value.values()))
        case _:
            return True
