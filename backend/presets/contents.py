"""What presets and actuators hold."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from vssea_core import __version__
from vssea_core.actuator.parameters import Actuator
from vssea_core.control.tuning import Tuning
from vssea_core.fields import Part
from vssea_core.scenario import Scenario

PresetName = Annotated[
    str, Field(min_length=1, max_length=80, pattern=r"^[^/\\\x00-\x1f]*[^/\\\x00-\x1f.][^/\\\x00-\x1f]*$")
]
"""A name that can stand in an address: no slash, no control character, not dots alone."""
Tag = Annotated[str, Field(min_length=1, max_length=40, pattern=r"^[^\x00-\x1f,]+$")]
Tags = Annotated[tuple[Tag, ...], Field(max_length=20)]
Note = Annotated[str, Field(max_length=2000)]
SOURCES = {"D": "datasheet", "P": "assumed", "E": "estimate", "C": "assumed"}
"""What a default's basis (vssea_core.fields.Basis) says of a value that still is the default."""


class Content(BaseModel):
    """A version's content; unknown names are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class PresetProvenance(Content):
    """Where a tuning comes from."""

    source: Literal["live", "rest", "import", "restored"] = "import"
    vssea: str = Field("", max_length=40)
    recording: str | None = Field(None, max_length=120)
    at_s: float | None = None
    by: str = Field("", max_length=80)


class PresetContent(Content):
    """A tuning, and the whole scenario that it was made with, if that is known."""

    tuning: Tuning
    scenario: Scenario | None = None
    provenance: PresetProvenance = PresetProvenance()


class ValueProvenance(Content):
    """Where one value of an actuator comes from; `uncertainty` in the unit of the value."""

    source: Literal["datasheet", "measured", "identified", "estimate", "assumed"] = "assumed"
    note: str = Field("", max_length=400)
    uncertainty: float | None = Field(None, ge=0.0, le=1e12)


class CalibrationPoint(Content):
    """A stiffness [N m/rad] that was measured at a stiffness motor position [rad], unloaded."""

    stiffness_motor_position: float = Field(gt=0.0, le=1e4)
    stiffness: float = Field(gt=0.0, le=1e6)
    note: str = Field("", max_length=400)


class ActuatorContent(Content):
    """A plant, where each of its values comes from, and its measured stiffness."""

    actuator: Actuator
    provenance: dict[str, ValueProvenance] = Field(default_factory=dict)
    calibration: tuple[CalibrationPoint, ...] = Field((), max_length=400)

    @model_validator(mode="after")
    def _of_own_fields(self) -> Self:
        known = set(leaves(self.actuator))
        for path in self.provenance:
            if path not in known:
                raise ValueError(f"provenance.{path} is no parameter of an actuator; known: {', '.join(sorted(known))}")
        return self


@dataclass(frozen=True)
class Kind:
    """What is kept alike and differs in its content: `part` names what is compared and applied."""

    name: str
    model: type[PresetContent] | type[ActuatorContent]
    part: str
    summary: Callable[[Any], str]

    @property
    def plural(self) -> str:
        """Its collection, as in the address."""
        return f"{self.name}s"


def leaves(part: Part, path: str = "") -> dict[str, str]:
    """Return the basis of every value of a part, by path."""
    found: dict[str, str] = {}
    for name, info in type(part).model_fields.items():
        value, place = getattr(part, name), f"{path}.{name}".lstrip(".")
        if isinstance(value, Part):
            found |= leaves(value, place)
        else:
            extra = info.json_schema_extra if isinstance(info.json_schema_extra, dict) else {}
            found[place] = str(extra.get("basis") or "C")
    return found


def live_preset(scenario: Scenario, at_s: float, by: str) -> PresetContent:
    """Return what runs, as a preset's content."""
    provenance = PresetProvenance(source="live", vssea=__version__, at_s=at_s, by=by[:80])
    return PresetContent(tuning=scenario.tuning, scenario=scenario, provenance=provenance)


def live_actuator(scenario: Scenario) -> ActuatorContent:
    """Return the plant that runs; a value that is the default comes from where the default comes from."""
    actuator, default = scenario.actuator, Actuator()
    changed = _flat(actuator.model_dump()), _flat(default.model_dump())
    provenance = {
        path: ValueProvenance(source=SOURCES[basis] if changed[0][path] == changed[1][path] else "assumed")  # type: ignore[arg-type]
        for path, basis in leaves(actuator).items()
    }
    return ActuatorContent(actuator=actuator, provenance=provenance)


def preset_summary(content: PresetContent) -> str:
    """Return controller and observer in a few words."""
    controller, observer = content.tuning.controller, content.tuning.observer
    match controller.kind:
        case "sliding_mode":
            first = f"sliding mode, {controller.switch.replace('_', ' ')}, poles {controller.surface_pole:g} rad/s"
        case _ if controller.design == "poles":
            first = f"{controller.kind.replace('_', ' ')}, poles {controller.natural_frequency:g} rad/s"
        case _:
            first = f"{controller.kind.replace('_', ' ')}, LQR"
    second = "no observer" if observer.kind == "off" else f"{observer.kind} observer {observer.bandwidth:g} rad/s"
    return f"{first}; {second}"


def actuator_summary(content: ActuatorContent) -> str:
    """Return inertias and range of stiffness in a few words."""
    link, motor, spring = content.actuator.link, content.actuator.motor, content.actuator.stiffness
    words = f"link {link.inertia:g}, motor {motor.inertia:g} kg·m²; {spring.softest:g} to {spring.stiffest:g} N·m/rad"
    count = len(content.calibration)
    return f"{words}; {count} calibration point{'s' if count != 1 else ''}" if count else words


def _flat(document: dict[str, Any], path: str = "") -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, value in document.items():
        place = f"{path}.{name}".lstrip(".")
        found |= _flat(value, place) if isinstance(value, dict) else {place: value}
    return found


PRESET = Kind("preset", PresetContent, "tuning", preset_summary)
ACTUATOR = Kind("actuator", ActuatorContent, "actuator", actuator_summary)
