"""Poles of the sampled closed loop, as multipliers a sample and in the terms of continuous time."""

import cmath
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from vssea_core.analysis.loop import LoopModel

DEADBEAT = 1e-6
"""Multipliers below this die out within a few samples; their logarithm says nothing."""
TOGETHER = 0.25
"""Poles this close, as a share of their natural frequency, are told as one repeated pole that sampling has split."""


@dataclass(frozen=True)
class Pole:
    """One real pole, or one of a pair (imaginary part >= 0; `pair` tells)."""

    multiplier: complex  # z
    continuous: complex  # s = ln(z) / T [rad/s]
    natural_frequency: float  # |s| [rad/s]
    damping: float  # -Re s / |s|
    pair: bool

    def document(self) -> dict[str, Any]:
        """Return plain numbers; complex ones as [real, imaginary]."""
        return {
            "multiplier": [self.multiplier.real, self.multiplier.imag],
            "continuous": [self.continuous.real, self.continuous.imag],
            "natural_frequency": self.natural_frequency,
            "damping": self.damping,
            "pair": self.pair,
        }


@dataclass(frozen=True)
class Poles:
    """All poles, the slowest to decay first; `deadbeat` counts those at z = 0, which are left out of `poles`."""

    poles: tuple[Pole, ...]
    deadbeat: int
    stable: bool
    note: str | None

    @property
    def dominant(self) -> Pole:
        """The pole that decays most slowly, or grows fastest."""
        return self.poles[0]

    def document(self) -> dict[str, Any]:
        """Return plain numbers and lists."""
        return {
            "poles": [pole.document() for pole in self.poles],
            "dominant": self.dominant.document(),
            "deadbeat": self.deadbeat,
            "stable": self.stable,
            "note": self.note,
        }


def poles(loop: LoopModel) -> Poles:
    """Return the Poles of `loop`: ordered by decay, then by frequency."""
    multipliers = loop.multipliers
    lasting = multipliers[np.abs(multipliers) > DEADBEAT]
    found = [_pole(complex(z), loop.period_s) for z in lasting if z.imag >= 0.0]
    found.sort(key=lambda pole: (-pole.continuous.real, pole.natural_frequency))
    return Poles(tuple(found), len(multipliers) - len(lasting), loop.stable, _repeated(found))


def _pole(z: complex, period_s: float) -> Pole:
    s = cmath.log(z) / period_s
    size = abs(s)
    return Pole(z, s, size, -s.real / size if size > 0.0 else 1.0, z.imag > 0.0)


def _repeated(found: list[Pole]) -> str | None:
    """Return a note if three poles or more lie so close that they are meant as one repeated pole."""
    everything = [
        s
        for pole in found
        for s in ((pole.continuous, pole.continuous.conjugate()) if pole.pair else (pole.continuous,))
    ]
    clusters: list[str] = []
    left = sorted(everything, key=abs)
    while left:
        near = [s for s in left if abs(s - left[0]) < TOGETHER * abs(left[0])]
        if len(near) >= 3:
            centre = math.exp(sum(math.log(abs(s)) for s in near) / len(near))
            clusters.append(f"{len(near)} near {centre:.3g} rad/s")
        left = [s for s in left if s not in near]
    if not clusters:
        return None
    return (
        f"a repeated pole splits when it is sampled, and its place is not well determined ({'; '.join(clusters)}): "
        "compare responses, not single poles"
    )
