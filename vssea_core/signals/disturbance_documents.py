"""Disturbances as parts of the scenario document: functions of time on all three inertias, and what the link meets.

A torque is positive where it opposes positive motion, as in Eq. (1): J theta'' = ... - torque. The terms of a list add up.
"""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from vssea_core.fields import Part, choice, kind, parameter
from vssea_core.signals.document_fields import angle, frequency, seconds

MAX_COMPONENTS = 8
MAX_TERMS = 16


class _Timed(Part):
    start_s: float = seconds(0.0, "from", "Scenario time at which it starts; takes effect at the next tick.")
    end_s: float | None = seconds(None, "until", "Scenario time at which it ends; empty = never.")

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.end_s is not None and self.end_s <= self.start_s:
            raise ValueError(f"end_s {self.end_s:g} s is not after start_s {self.start_s:g} s")
        return self


def _amplitude(default: float, title: str, symbol: str, meaning: str) -> float:
    field: float = parameter(
        default, title, unit="N·m", symbol=symbol, low=0.0, high=200.0, typical=(0.0, 10.0), step=0.1, equation="(1)",
        meaning=meaning,
    )
    return field


class ConstantDisturbance(_Timed):
    """A constant torque; with a start it is a step, with an end too a single pulse."""

    kind: Literal["constant"] = kind("constant")
    torque: float = parameter(
        3.0, "constant", unit="N·m", symbol="τ₀", low=-200.0, high=200.0, typical=(-10.0, 10.0), step=0.1,
        equation="(1)", meaning="Positive opposes positive motion, as in Eq. (1).",
    )


class SineDisturbance(_Timed):
    """amplitude sin(2 pi f t + phase), with t the scenario's time."""

    kind: Literal["sine"] = kind("sine")
    amplitude: float = _amplitude(3.0, "sine", "τ₁", "Amplitude of the sine torque.")
    frequency_hz: float = parameter(
        0.5, "sine frequency", unit="Hz", symbol="f_d", low=0.0, high=200.0, typical=(0.05, 10.0), step=0.01, scale="log",
        meaning="Frequency of the sine torque.",
    )
    phase: float = parameter(0.0, "phase", unit="rad", symbol="φ", low=-6.3, high=6.3, step=0.01, meaning="Phase at t = 0.")


class TorqueComponent(Part):
    """One sine of a multi-sine torque: amplitude sin(2 pi f t + phase)."""

    amplitude: float = _amplitude(1.0, "component", "τ_i", "Amplitude of this component.")
    frequency_hz: float = frequency(1.0, "component frequency", "f_i", "Frequency of this component.", high=200.0)
    phase: float = parameter(
        0.0, "component phase", unit="rad", symbol="φ_i", low=-6.3, high=6.3, step=0.01, meaning="Phase at t = 0."
    )


class MultisineDisturbance(_Timed):
    """A sum of up to 8 sines, with t the scenario's time."""

    kind: Literal["multisine"] = kind("multisine")
    components: tuple[TorqueComponent, ...] = Field(
        (TorqueComponent(),), max_length=MAX_COMPONENTS, title="components",
        description="The sines that are added.",
    )


class ChirpDisturbance(_Timed):
    """A sine whose frequency sweeps from one value to another, counted from its start, and then stays there."""

    kind: Literal["chirp"] = kind("chirp")
    amplitude: float = _amplitude(2.0, "chirp", "τ_c", "Amplitude of the swept torque.")
    start_frequency_hz: float = frequency(0.1, "from frequency", "f₀", "Frequency at its start.", low=0.01, high=200.0)
    end_frequency_hz: float = frequency(10.0, "to frequency", "f₁", "Frequency at the end of the sweep.", low=0.01, high=200.0)
    duration_s: float = seconds(10.0, "sweep", "Length of the sweep; then the last frequency stays.", low=0.1, high=1000.0)
    sweep: Literal["linear", "logarithmic"] = choice(
        "logarithmic", "sweep law", meaning="Whether equal times cover equal differences or equal ratios of frequency."
    )


class NoiseDisturbance(_Timed):
    """Seeded Gaussian noise: a smooth function of time, the same in every run with the scenario's seed."""

    kind: Literal["noise"] = kind("noise")
    rms: float = parameter(
        1.0, "noise", unit="N·m", symbol="τ_rms", low=0.0, high=100.0, typical=(0.0, 5.0), step=0.05, equation="(1)",
        meaning="Root mean square of the torque.",
    )
    bandwidth_hz: float = frequency(
        5.0, "noise bandwidth", "f_n", "Frequency at which its spectrum, flat below, is down by 3 dB.", low=0.01, high=100.0
    )


class PulseDisturbance(_Timed):
    """Rectangular pulses, the first at its start; each edge takes effect at the next tick."""

    kind: Literal["pulse"] = kind("pulse")
    torque: float = parameter(
        5.0, "pulse", unit="N·m", symbol="τ_p", low=-200.0, high=200.0, typical=(-20.0, 20.0), step=0.1, equation="(1)",
        meaning="Torque during a pulse; positive opposes positive motion.",
    )
    width_s: float = seconds(0.1, "width", "Length of a pulse.", low=0.005, high=1000.0)
    period_s: float = seconds(1.0, "period", "Time from one pulse to the next.", low=0.01, high=1e4)
    repeat: bool = choice(True, "repeated", meaning="Whether pulses follow each other; otherwise there is one.")

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if self.repeat and self.width_s >= self.period_s:
            raise ValueError(
                f"width_s {self.width_s:g} s is not shorter than period_s {self.period_s:g} s; "
                "shorten the pulse, lengthen the period, or take a constant"
            )
        return self


class PendulumDisturbance(_Timed):
    """A mass on the link in gravity: m g l sin(theta_l), hanging straight down at zero."""

    kind: Literal["pendulum"] = kind("pendulum")
    mass: float = parameter(
        0.5, "load mass", unit="kg", symbol="m", low=0.0, high=50.0, typical=(0.0, 5.0), step=0.05,
        meaning="Mass of the load; only its weight acts, its inertia belongs to the link's.",
    )
    length: float = parameter(
        0.3, "load distance", unit="m", symbol="l", low=0.0, high=5.0, typical=(0.0, 1.0), step=0.01,
        meaning="Distance of the mass from the link's axis.",
    )


class ContactDisturbance(_Timed):
    """A one-sided wall: max(0, k p + c p') while the link is p > 0 deep in it."""

    kind: Literal["contact"] = kind("contact")
    position: float = angle(0.4, "wall", "θ_w", "Link position at which the wall begins.")
    side: Literal["above", "below"] = choice(
        "above", "wall side", meaning="above: the wall stops motion to larger angles. below: to smaller ones."
    )
    stiffness: float = parameter(
        1000.0, "wall stiffness", unit="N·m/rad", symbol="k_w", low=0.0, high=1e5, typical=(100.0, 1e4), step=10.0,
        scale="log", meaning="Torque per radian of penetration.",
    )
    damping: float = parameter(
        2.0, "wall damping", unit="N·m·s/rad", symbol="c_w", low=0.0, high=100.0, typical=(0.0, 20.0), step=0.1,
        meaning="Torque per rad/s of penetration rate; the wall never pulls.",
    )


Disturbance = Annotated[
    ConstantDisturbance | SineDisturbance | MultisineDisturbance | ChirpDisturbance | NoiseDisturbance | PulseDisturbance,
    Field(discriminator="kind"),
]
"""A torque that is a function of time; it may act on any of the three inertias."""

LinkDisturbance = Annotated[
    ConstantDisturbance | SineDisturbance | MultisineDisturbance | ChirpDisturbance | NoiseDisturbance | PulseDisturbance
    | PendulumDisturbance | ContactDisturbance,
    Field(discriminator="kind"),
]
"""What may act on the link: also what depends on where it is."""


class Disturbances(Part):
    """Torques on link, equilibrium motor and stiffness motor; the terms of a list add up."""

    link: tuple[LinkDisturbance, ...] = Field((), max_length=MAX_TERMS, title="link disturbances")
    motor: tuple[Disturbance, ...] = Field((), max_length=MAX_TERMS, title="motor disturbances")
    stiffness_motor: tuple[Disturbance, ...] = Field((), max_length=MAX_TERMS, title="stiffness motor disturbances")
