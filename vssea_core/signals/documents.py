"""References and stiffness references as parts of the scenario document; disturbances are in disturbance_documents.

Every reference but the raw step has four continuous derivatives, also from rest and through a live change.
"""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from vssea_core.fields import Part, choice, kind, parameter
from vssea_core.signals.disturbance_documents import (
    ChirpDisturbance,
    ConstantDisturbance,
    ContactDisturbance,
    Disturbance,
    Disturbances,
    LinkDisturbance,
    MultisineDisturbance,
    NoiseDisturbance,
    PendulumDisturbance,
    PulseDisturbance,
    SineDisturbance,
    TorqueComponent,
)
from vssea_core.signals.document_fields import angle, frequency, move_duration, seconds

__all__ = [
    "Reference", "SineReference", "MoveReference", "StepReference", "MultisineReference", "PositionComponent",
    "FilteredStepReference", "ChirpReference", "JogReference", "RecordedReference",
    "StiffnessReference", "ConstantStiffness", "MoveStiffness",
    "Disturbances", "Disturbance", "LinkDisturbance", "ConstantDisturbance", "SineDisturbance", "MultisineDisturbance",
    "TorqueComponent", "ChirpDisturbance", "NoiseDisturbance", "PulseDisturbance", "PendulumDisturbance",
    "ContactDisturbance",
]

MAX_COMPONENTS = 8
MAX_RECORDED = 2000
SHORTEST_RECORDED_S = 1e-3


def _fade_in() -> float:
    return seconds(
        1.0, "fade-in", "Time over which the reference grows from zero, with continuous snap; 0 = none.", high=60.0
    )


class SineReference(Part):
    """offset + amplitude sin(2 pi f t), both faded in so that four derivatives are continuous from rest."""

    kind: Literal["sine"] = kind("sine")
    amplitude: float = parameter(
        0.5, "amplitude", unit="rad", symbol="A", low=0.0, high=3.2, typical=(0.0, 1.0), step=0.01,
        meaning="The motor follows 0.5 rad for long up to about 0.5 Hz.",
    )
    frequency_hz: float = parameter(
        0.25, "frequency", unit="Hz", symbol="f", low=0.0, high=50.0, typical=(0.05, 2.0), step=0.01, scale="linear",
        meaning="Frequency of the sine.",
    )
    offset: float = angle(0.0, "offset", "r₀", "Centre of the sine.")
    fade_in_s: float = _fade_in()


class MoveReference(Part):
    """Rest-to-rest moves from origin to target along the polynomial of 9th order, once or to and fro."""

    kind: Literal["move"] = kind("move")
    origin: float = angle(0.0, "from", "r_a", "Where it starts, and returns to.")
    target: float = angle(0.5, "to", "r_b", "Where the move ends.")
    duration_s: float = move_duration(1.0)
    dwell_s: float = seconds(1.0, "dwell", "Rest between two moves.", high=60.0)
    repeat: bool = choice(True, "to and fro", meaning="Moves back after the dwell, and so on.")
    start_s: float = seconds(0.5, "start", "Time of the first move, counted from when this reference is set.")


class StepReference(Part):
    """A raw step: r' = ... = r'''' = 0, so the first torque is kappa p^4 per rad."""

    kind: Literal["step"] = kind("step")
    origin: float = angle(0.0, "from", "r_a", "Where it starts, and returns to.")
    target: float = angle(0.2, "to", "r_b", "Where the step leads.")
    dwell_s: float = seconds(2.0, "dwell", "Time between two steps.", low=0.01, high=60.0)
    repeat: bool = choice(True, "to and fro", meaning="Steps back after the dwell, and so on.")
    start_s: float = seconds(0.5, "start", "Time of the first step, counted from when this reference is set.")


class PositionComponent(Part):
    """One sine of a multi-sine reference: amplitude sin(2 pi f t + phase)."""

    amplitude: float = parameter(
        0.1, "component", unit="rad", symbol="A_i", low=0.0, high=3.2, typical=(0.0, 0.5), step=0.01,
        meaning="Amplitude of this component.",
    )
    frequency_hz: float = frequency(0.5, "component frequency", "f_i", "Frequency of this component.")
    phase: float = parameter(
        0.0, "component phase", unit="rad", symbol="φ_i", low=-6.3, high=6.3, step=0.01,
        meaning="Phase when this reference is set.",
    )


class MultisineReference(Part):
    """offset plus a sum of up to 8 sines, faded in so that four derivatives are continuous from rest."""

    kind: Literal["multisine"] = kind("multisine")
    components: tuple[PositionComponent, ...] = Field(
        (PositionComponent(amplitude=0.3, frequency_hz=0.2), PositionComponent()),
        max_length=MAX_COMPONENTS, title="components", description="The sines that are added.",
    )
    offset: float = angle(0.0, "offset", "r₀", "Centre of the sines.")
    fade_in_s: float = _fade_in()


class FilteredStepReference(Part):
    """A step, once or to and fro, through (s / w + 1)^-5: the filter's five real poles keep four derivatives continuous."""

    kind: Literal["filtered_step"] = kind("filtered_step")
    origin: float = angle(0.0, "from", "r_a", "Where it starts, and returns to.")
    target: float = angle(0.5, "to", "r_b", "Where the step leads.")
    bandwidth: float = parameter(
        20.0, "filter bandwidth", unit="rad/s", symbol="w", low=0.5, high=200.0, typical=(2.0, 40.0), step=0.5,
        scale="log", meaning="The filter's five-fold pole; the reference is 95 % there after 9.2 / w.",
    )
    dwell_s: float = seconds(2.0, "dwell", "Time between two steps.", low=0.01, high=60.0)
    repeat: bool = choice(True, "to and fro", meaning="Steps back after the dwell, and so on: a filtered square wave.")
    start_s: float = seconds(0.5, "start", "Time of the first step, counted from when this reference is set.")

    @model_validator(mode="after")
    def _dwells_long_enough(self) -> Self:
        if self.repeat and self.bandwidth * self.dwell_s < 1.0:
            raise ValueError(
                f"dwell_s {self.dwell_s:g} s is shorter than 1 / bandwidth, {1.0 / self.bandwidth:.3g} s, so hardly anything "
                "of the steps is left; lengthen the dwell or raise the bandwidth"
            )
        return self


class ChirpReference(Part):
    """offset + amplitude sin(phase), the frequency sweeping from one value to another; faded in.

    In its last tenth the sweep eases into the end frequency, so that four derivatives stay continuous.
    """

    kind: Literal["chirp"] = kind("chirp")
    amplitude: float = parameter(
        0.1, "amplitude", unit="rad", symbol="A", low=0.0, high=3.2, typical=(0.0, 0.5), step=0.01,
        meaning="The torque grows with the fourth power of the frequency: keep it small.",
    )
    start_frequency_hz: float = frequency(0.1, "from frequency", "f₀", "Frequency when it is set.", low=0.01)
    end_frequency_hz: float = frequency(2.0, "to frequency", "f₁", "Frequency at the end of the sweep.", low=0.01)
    duration_s: float = seconds(20.0, "sweep", "Length of the sweep.", low=0.5, high=1000.0)
    sweep: Literal["linear", "logarithmic"] = choice(
        "logarithmic", "sweep law", meaning="Whether equal times cover equal differences or equal ratios of frequency."
    )
    after: Literal["hold", "stop"] = choice(
        "hold", "after the sweep",
        meaning="hold: the end frequency stays. stop: the sine fades out over the sweep's last part, as long as the fade-in.",
    )
    offset: float = angle(0.0, "offset", "r₀", "Centre of the sine.")
    fade_in_s: float = _fade_in()

    @model_validator(mode="after")
    def _fade_fits(self) -> Self:
        if self.after == "stop" and 2.0 * self.fade_in_s > self.duration_s:
            raise ValueError(
                f"fade_in_s {self.fade_in_s:g} s is more than half of duration_s {self.duration_s:g} s, so fading in and out "
                "do not fit; shorten the fade-in or lengthen the sweep"
            )
        return self


class JogReference(Part):
    """Motion at one velocity, reached within limits of acceleration, jerk and snap; starts from where the reference is.

    Velocity follows the 9th-order step, so snap is continuous. Set live, it starts with the present position and velocity.
    """

    kind: Literal["jog"] = kind("jog")
    velocity: float = parameter(
        0.3, "velocity", unit="rad/s", symbol="v", low=-20.0, high=20.0, typical=(-2.0, 2.0), step=0.01,
        meaning="Target velocity; its sign is the direction. 0 = come to rest.",
    )
    acceleration: float = parameter(
        3.0, "acceleration limit", unit="rad/s²", symbol="a_max", low=0.01, high=1e3, typical=(0.1, 20.0), step=0.1,
        scale="log", meaning="Largest acceleration while the velocity changes.",
    )
    jerk: float = parameter(
        50.0, "jerk limit", unit="rad/s³", symbol="j_max", low=0.1, high=1e5, typical=(1.0, 500.0), step=1.0,
        scale="log", meaning="Largest jerk while the velocity changes.",
    )
    snap: float = parameter(
        2000.0, "snap limit", unit="rad/s⁴", symbol="s_max", low=1.0, high=1e7, typical=(10.0, 2e4), step=10.0,
        scale="log", meaning="Largest snap while the velocity changes; J_l J_e / k times it is motor torque.",
    )
    distance: float | None = parameter(
        None, "distance", unit="rad", symbol="Δ", low=1e-4, high=1e3, typical=(0.01, 6.3), step=0.01,
        meaning="Comes to rest this far from where it started, in the direction of the velocity; empty = goes on.",
    )
    duration_s: float | None = seconds(
        None, "duration", "Time after which it begins to slow down; empty = never.", low=0.01, high=1e4
    )
    origin: float = angle(0.0, "from", "r_a", "Where it starts if the scenario begins with it; set live, where it then is.")


RecordedTime = Annotated[float, Field(strict=True, ge=0.0, le=1e4)]
RecordedPosition = Annotated[float, Field(strict=True, ge=-100.0, le=100.0)]


class RecordedReference(Part):
    """Samples joined by a spline of degree 5, four derivatives continuous; at rest before the first and after the last."""

    kind: Literal["recorded"] = kind("recorded")
    times_s: tuple[RecordedTime, ...] = Field(
        (0.5, 1.0, 1.5, 2.0), max_length=MAX_RECORDED, title="times",
        description="Times of the samples, rising by 1 ms at least, counted from when this reference is set.",
        json_schema_extra={"unit": "s"},
    )
    positions: tuple[RecordedPosition, ...] = Field(
        (0.0, 0.2, 0.3, 0.3), max_length=MAX_RECORDED, title="positions",
        description="Link position at each of the times.", json_schema_extra={"unit": "rad"},
    )

    @model_validator(mode="after")
    def _is_a_course(self) -> Self:
        if len(self.times_s) != len(self.positions):
            raise ValueError(
                f"times_s has {len(self.times_s)} values and positions {len(self.positions)}; expected as many of both"
            )
        if len(self.times_s) < 2:
            raise ValueError(f"times_s has {len(self.times_s)} values; expected at least 2 samples")
        for number, (before, after) in enumerate(zip(self.times_s, self.times_s[1:], strict=False)):
            if after - before < SHORTEST_RECORDED_S * (1.0 - 1e-6):
                raise ValueError(
                    f"times_s rises from {before:g} s to {after:g} s after sample {number}; "
                    "expected times that rise by 0.001 s at least, so sort or thin them out"
                )
        return self


Reference = Annotated[
    SineReference | MoveReference | StepReference | MultisineReference | FilteredStepReference | ChirpReference
    | JogReference | RecordedReference,
    Field(discriminator="kind"),
]


def _stiffness(default: float, title: str, symbol: str, meaning: str = "") -> float:
    field: float = parameter(
        default, title, unit="N·m/rad", symbol=symbol, low=1.0, high=1e5, typical=(20.0, 1000.0), step=1.0, scale="log",
        equation="(4)", basis="P", meaning=meaning,
    )
    return field


class ConstantStiffness(Part):
    """One commanded stiffness."""

    kind: Literal["constant"] = kind("constant")
    stiffness: float = _stiffness(200.0, "stiffness", "k", "Commanded stiffness at zero deflection: θ_ms = (Y_τ/(2k))^(1/3).")


class MoveStiffness(Part):
    """One rest-to-rest move of the stiffness motor between two stiffnesses."""

    kind: Literal["move"] = kind("move")
    stiffness: float = _stiffness(200.0, "stiffness before", "k_a", "Stiffness until the move starts.")
    target: float = _stiffness(400.0, "stiffness after", "k_b", "Stiffness from the end of the move on.")
    start_s: float = seconds(1.0, "start", "Time at which the move starts, counted from when it is set.")
    duration_s: float = move_duration(0.5)


StiffnessReference = Annotated[ConstantStiffness | MoveStiffness, Field(discriminator="kind")]
