"""References, stiffness references and disturbances as parts of the scenario document."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from vssea_core.fields import Part, choice, kind, parameter


def _angle(default: float, title: str, symbol: str, meaning: str = "") -> float:
    field: float = parameter(
        default, title, unit="rad", symbol=symbol, low=-6.3, high=6.3, typical=(-1.0, 1.0), step=0.01, meaning=meaning
    )
    return field


def _seconds(default: float | None, title: str, meaning: str, low: float = 0.0, high: float = 1e4) -> float:
    field: float = parameter(
        default, title, unit="s", low=low, high=high, typical=(low, min(10.0, high)), step=0.01, meaning=meaning
    )
    return field


def _duration(default: float) -> float:
    field: float = parameter(
        default, "duration", unit="s", low=0.02, high=60.0, typical=(0.2, 4.0), step=0.01, meaning="Time of one move."
    )
    return field


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
    offset: float = _angle(0.0, "offset", "r₀", "Centre of the sine.")
    fade_in_s: float = _seconds(
        1.0, "fade-in", "Time over which the reference grows from zero, with continuous snap; 0 = none.", high=60.0
    )


class MoveReference(Part):
    """Rest-to-rest moves from origin to target along the polynomial of 9th order, once or to and fro."""

    kind: Literal["move"] = kind("move")
    origin: float = _angle(0.0, "from", "r_a", "Where it starts, and returns to.")
    target: float = _angle(0.5, "to", "r_b", "Where the move ends.")
    duration_s: float = _duration(1.0)
    dwell_s: float = _seconds(1.0, "dwell", "Rest between two moves.", high=60.0)
    repeat: bool = choice(True, "to and fro", meaning="Moves back after the dwell, and so on.")
    start_s: float = _seconds(0.5, "start", "Time of the first move, counted from when this reference is set.")


class StepReference(Part):
    """A raw step: r' = ... = r'''' = 0, so the first torque is kappa p^4 per rad."""

    kind: Literal["step"] = kind("step")
    origin: float = _angle(0.0, "from", "r_a", "Where it starts, and returns to.")
    target: float = _angle(0.2, "to", "r_b", "Where the step leads.")
    dwell_s: float = _seconds(2.0, "dwell", "Time between two steps.", low=0.01, high=60.0)
    repeat: bool = choice(True, "to and fro", meaning="Steps back after the dwell, and so on.")
    start_s: float = _seconds(0.5, "start", "Time of the first step, counted from when this reference is set.")


Reference = Annotated[SineReference | MoveReference | StepReference, Field(discriminator="kind")]


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
    start_s: float = _seconds(1.0, "start", "Time at which the move starts, counted from when it is set.")
    duration_s: float = _duration(0.5)


StiffnessReference = Annotated[ConstantStiffness | MoveStiffness, Field(discriminator="kind")]


class _Timed(Part):
    start_s: float = _seconds(0.0, "from", "Scenario time at which it starts; takes effect at the next tick.")
    end_s: float | None = _seconds(None, "until", "Scenario time at which it ends; empty = never.")

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.end_s is not None and self.end_s <= self.start_s:
            raise ValueError(f"end_s {self.end_s:g} s is not after start_s {self.start_s:g} s")
        return self


class ConstantDisturbance(_Timed):
    """A constant torque."""

    kind: Literal["constant"] = kind("constant")
    torque: float = parameter(
        3.0, "constant", unit="N·m", symbol="τ₀", low=-200.0, high=200.0, typical=(-10.0, 10.0), step=0.1,
        equation="(1)", meaning="Positive opposes positive motion, as in Eq. (1).",
    )


class SineDisturbance(_Timed):
    """amplitude sin(2 pi f t + phase), with t the scenario's time."""

    kind: Literal["sine"] = kind("sine")
    amplitude: float = parameter(
        3.0, "sine", unit="N·m", symbol="τ₁", low=0.0, high=200.0, typical=(0.0, 10.0), step=0.1, equation="(1)",
        meaning="Amplitude of the sine torque.",
    )
    frequency_hz: float = parameter(
        0.5, "sine frequency", unit="Hz", symbol="f_d", low=0.0, high=200.0, typical=(0.05, 10.0), step=0.01, scale="log",
        meaning="Frequency of the sine torque.",
    )
    phase: float = parameter(0.0, "phase", unit="rad", symbol="φ", low=-6.3, high=6.3, step=0.01, meaning="Phase at t = 0.")


Disturbance = Annotated[ConstantDisturbance | SineDisturbance, Field(discriminator="kind")]


class Disturbances(Part):
    """Torques on link and equilibrium motor; the terms of a list add up."""

    link: tuple[Disturbance, ...] = Field((), max_length=16, title="link disturbances")
    motor: tuple[Disturbance, ...] = Field((), max_length=16, title="motor disturbances")
