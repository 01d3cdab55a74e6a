"""The one document: plant, sensors, timing, tuning, references, disturbances, initial state and duration.

It is what REST takes, what the command line reads, and what the live session runs. Imports no numba and no scipy.
"""

import json
from typing import Self

from pydantic import Field, JsonValue, ValidationError, model_validator

from vssea_core.actuator.parameters import Actuator, Sensors, Timing
from vssea_core.changes import UnknownPath, set_values
from vssea_core.control.tuning import NoObserver, Tuning, VelocityObserver
from vssea_core.field_errors import field_errors, sentence_of
from vssea_core.fields import Part, parameter
from vssea_core.signals.documents import ConstantStiffness, Disturbances, Reference, SineReference, StiffnessReference

MAX_SAMPLES = 200_000
CHANGEABLE = ("tuning", "reference", "stiffness_reference", "disturbances")
"""Parts of the document that may change while it runs."""


class Initial(Part):
    """The actuator starts at rest, in equilibrium under the disturbances that act at t = 0."""

    link_position: float = parameter(
        0.0,
        "link position",
        unit="rad",
        symbol="θ_l(0)",
        low=-6.3,
        high=6.3,
        step=0.01,
        meaning="Where the link rests at t = 0.",
    )


class TimedChange(Part):
    """What changes at one instant of the run: paths of the scenario, with their new values."""

    at_s: float = parameter(
        5.0, "at", unit="s", low=0.0, high=1e4, typical=(0.0, 20.0), step=0.1,
        meaning="Scenario time from which the change is in force; takes effect at the next tick.",
    )  # fmt: skip
    changes: dict[str, JsonValue] = Field(
        default_factory=dict, max_length=64, title="changes",
        description="Values by path, such as tuning.observer.bandwidth, stiffness_reference.stiffness or reference.kind.",
    )  # fmt: skip


class Scenario(Part):
    """One experiment, whole."""

    name: str = Field("untitled", min_length=1, max_length=80)
    description: str = Field("", max_length=2000)
    actuator: Actuator = Actuator()
    sensors: Sensors = Sensors()
    timing: Timing = Timing()
    tuning: Tuning = Tuning()
    reference: Reference = SineReference()
    stiffness_reference: StiffnessReference = ConstantStiffness()
    disturbances: Disturbances = Disturbances()
    sequence: tuple[TimedChange, ...] = Field((), max_length=32, title="sequence")
    initial: Initial = Initial()
    duration_s: float = parameter(
        10.0, "duration", unit="s", low=0.001, high=120.0, step=0.1, meaning="Length of a simulation."
    )
    seed: int = parameter(
        0,
        "seed",
        unit="",
        low=0,
        high=2**31 - 1,
        typical=(0, 1000),
        step=1,
        meaning="Of all noise: the same seed gives the same run.",
    )

    @model_validator(mode="after")
    def _parts_fit(self) -> Self:
        check_fits(self)
        return self


def check_fits(scenario: Scenario) -> None:
    """Raise ValueError if the parts of a scenario, each sound by itself, do not go together."""
    check_observer_fits(scenario.tuning, scenario.sensors)
    check_stiffness_fits(scenario.stiffness_reference, scenario.actuator)
    samples = scenario.duration_s / scenario.timing.sample_time_s
    if samples > MAX_SAMPLES:
        raise ValueError(
            f"duration_s {scenario.duration_s:g} s is {samples:.0f} samples of {scenario.timing.sample_time_s:g} s; "
            f"expected at most {MAX_SAMPLES}, so shorten it or lengthen timing.sample_time_s"
        )
    after_changes(scenario)


def after_changes(scenario: Scenario) -> list[tuple[float, Scenario]]:
    """Return the scenario after each change of its sequence, with the time [s] from which it is in force, in order.

    Raises ValueError for a path that may not change, is unknown, or gets a value out of range.
    """
    followers: list[tuple[float, Scenario]] = []
    if not scenario.sequence:
        return followers
    document = scenario.model_dump(mode="json", exclude={"sequence"})
    last_s = 0.0
    for number, change in enumerate(scenario.sequence):
        if change.at_s < last_s:
            raise ValueError(
                f"sequence.{number}.at_s {change.at_s:g} s is before the change ahead of it at {last_s:g} s"
            )
        last_s = change.at_s
        for path in change.changes:
            if path.split(".")[0] not in CHANGEABLE:
                raise ValueError(
                    f"sequence.{number} changes {path}; expected a path that starts with {', '.join(CHANGEABLE)}"
                )
        try:
            set_values(document, Scenario, dict(change.changes))
            followers.append((change.at_s, Scenario.model_validate_json(json.dumps(document))))
        except UnknownPath as unknown:
            raise ValueError(f"sequence.{number}: {unknown}") from unknown
        except ValidationError as error:
            raise ValueError(f"sequence.{number}: {sentence_of(field_errors(error, Scenario))}") from error
    return followers


def check_observer_fits(tuning: Tuning, sensors: Sensors) -> None:
    """Raise ValueError if the observer needs a velocity signal that the sensors do not give."""
    observer = tuning.observer
    if (
        isinstance(observer, VelocityObserver | NoObserver)
        and observer.velocity_source == "measured"
        and not sensors.velocities
    ):
        raise ValueError(
            "tuning.observer.velocity_source is 'measured', but these sensors measure no velocities; "
            "choose the position observer, or velocity_source 'difference'"
        )


def check_stiffness_fits(reference: StiffnessReference, actuator: Actuator) -> None:
    """Raise ValueError if a commanded stiffness lies outside the end stops."""
    low, high = actuator.stiffness.softest, actuator.stiffness.stiffest
    asked = [("stiffness", reference.stiffness)]
    if reference.kind == "move":
        asked.append(("target", reference.target))
    for name, value in asked:
        if not low <= value <= high:
            raise ValueError(
                f"stiffness_reference.{name} is {value:g} N·m/rad; expected {low:g} to {high:g} N·m/rad, the end stops"
            )
