"""One measured number beside the expected one, and the two measures that most of them are."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

SETTLED_S = 4.0


class Line(NamedTuple):
    """What was measured, the expected value, ours, and by what code."""

    what: str
    expected: str
    measured: str
    how: str


Section = Callable[[], list[Line]]
PRODUCT = "product"


def settled(times: np.ndarray, values: np.ndarray, from_s: float = SETTLED_S) -> np.ndarray:
    """Return the part of `values` from `from_s` [s] on."""
    return values[times >= from_s - 1e-9]


def rms(values: np.ndarray) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def mrad(angle: float) -> str:
    """Return an angle [rad] in mrad, with two or three digits."""
    return f"{1e3 * angle:.3g} mrad"
