"""The true disturbance torques of a scenario and their first two derivatives, in closed form."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vssea_core.signals.documents import LinkDisturbance

Samples = NDArray[np.float64]
TIME_SLACK_S = 1e-9


def load_and_rates(terms: Sequence[LinkDisturbance], time: Samples) -> Samples:
    """Return the sum of `terms` and its first two derivatives (3, samples) [N m, N m/s, N m/s^2] at `time` (samples,) [s].

    Between start and end of a term; the jumps there are left out. Raises ValueError for a term that is not a constant, a
    sine or a multi-sine.
    """
    total = np.zeros((3, len(time)))
    for term in terms:
        end_s = math.inf if term.end_s is None else term.end_s
        active = (term.start_s <= time + TIME_SLACK_S) & (time + TIME_SLACK_S < end_s)
        if term.kind == "constant":
            total[0] += active * term.torque
        elif term.kind == "sine":
            total += active * _sine(term.amplitude, term.frequency_hz, term.phase, time)
        elif term.kind == "multisine":
            for part in term.components:
                total += active * _sine(part.amplitude, part.frequency_hz, part.phase, time)
        else:
            raise ValueError(f"a {term.kind} disturbance has no rates here; expected constant, sine or multisine")
    return total


def _sine(amplitude: float, frequency_hz: float, phase: float, time: Samples) -> Samples:
    frequency = 2.0 * math.pi * frequency_hz
    sine, cosine = np.sin(frequency * time + phase), np.cos(frequency * time + phase)
    return amplitude * np.array([sine, frequency * cosine, -(frequency**2) * sine])
