"""Encoders: angles rounded to whole counts."""

from __future__ import annotations

import numpy as np


def quantise(angle: float, resolution: float) -> float:
    """Angle [rad] rounded half to even to multiples of `resolution` [rad]; 0 returns the angle itself."""
    return float(np.rint(angle / resolution) * resolution) if resolution > 0.0 else angle
