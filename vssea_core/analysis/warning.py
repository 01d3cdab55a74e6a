"""One plain sentence when a tuning is close to instability: the nearest danger and its direction."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from vssea_core.analysis.robustness import Robustness, StableRange

THIN_GAIN = 1.5
THIN_PHASE = math.radians(20.0)
THIN_DELAY_SAMPLES = 1.5
THIN_PARAMETER = 1.25
WORDS = {
    "link_inertia": ("the link is {} lighter than assumed", "the link is {} heavier than assumed"),
    "motor_inertia": ("the motor is {} lighter than assumed", "the motor is {} heavier than assumed"),
    "spring_constant": ("the spring is {} softer than assumed", "the spring is {} stiffer than assumed"),
    "gain": ("the motor gives {} less torque than commanded", "the motor gives {} more torque than commanded"),
}


@dataclass(frozen=True)
class ThinMargin:
    """A thin margin: its sentence, what is concerned, and how thin it is (1 = at the threshold, 0 = at the border)."""

    sentence: str
    concerns: str
    share: float

    def document(self) -> dict[str, Any]:
        """Return plain values."""
        return {"sentence": self.sentence, "concerns": self.concerns, "share": self.share}


def warning(found: Robustness) -> ThinMargin | None:
    """Return the ThinMargin of the nearest danger, or None if every margin is ample.

    Thin is: a gain margin within 1.5, 20 degrees of phase, 1.5 samples of delay, or a border within 25 % of an inertia or the
    spring; at the limiter, a gain margin below one within 1.5, as saturation lowers the gain.
    """
    if not found.margins.stable:
        return ThinMargin(found.margins.note or "the closed loop is unstable", "stability", 0.0)
    return min(_thin(found), key=lambda each: each.share, default=None)


def _thin(found: Robustness) -> Iterator[ThinMargin]:
    for name in ("link_inertia", "motor_inertia", "spring_constant"):
        borders: StableRange | None = getattr(found, name)
        if borders is not None:
            yield from _factors(name, borders.below, borders.above, THIN_PARAMETER)
    plant, limiter = found.margins.plant, found.margins.limiter
    if plant is None or limiter is None:
        return
    yield from _factors("gain", plant.gain_down or None, plant.gain_up, THIN_GAIN)
    if plant.phase < THIN_PHASE:
        yield ThinMargin(
            f"only {math.degrees(plant.phase):.0f}° of phase are left at {plant.phase_frequency:.3g} rad/s",
            "phase",
            plant.phase / THIN_PHASE,
        )
    delays = [delay for delay in (found.delay_s, plant.delay_s) if delay is not None]
    samples = min(delays, default=math.inf) / found.period_s
    if samples < THIN_DELAY_SAMPLES:
        yield ThinMargin(
            f"unstable if the torque comes {samples * found.period_s * 1e3:.2g} ms ({samples:.2g} samples) later",
            "delay",
            samples / THIN_DELAY_SAMPLES,
        )
    if limiter.gain_down > 1.0 / THIN_GAIN:
        share = math.log(limiter.gain_down) / -math.log(THIN_GAIN)
        yield ThinMargin(
            f"unstable while limits let less than {100.0 * limiter.gain_down:.0f} % of the demanded torque through",
            "saturation",
            share,
        )


def _factors(name: str, below: float | None, above: float | None, thin: float) -> Iterator[ThinMargin]:
    less, more = WORDS[name]
    if below is not None and below > 1.0 / thin:
        yield ThinMargin(f"unstable if {less.format(_percent(1.0 - below))}", name, math.log(below) / -math.log(thin))
    if above is not None and above < thin:
        yield ThinMargin(f"unstable if {more.format(_percent(above - 1.0))}", name, math.log(above) / math.log(thin))


def _percent(share: float) -> str:
    return f"{100.0 * share:.0f} %" if share >= 0.095 else f"{100.0 * share:.2g} %"
