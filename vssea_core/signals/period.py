"""How long a reference takes until it repeats itself."""

from fractions import Fraction
from math import gcd

from vssea_core.signals.documents import Reference

LONGEST_S = 60.0
"""A period beyond this is of no use for laying runs over each other."""
FINEST_HZ = Fraction(1, 1000)


def period_s(reference: Reference) -> float | None:
    """Return the period [s] of a reference once it is faded in or begun, None if it has none of at most LONGEST_S."""
    match reference.kind:
        case "sine":
            found = 1.0 / reference.frequency_hz if reference.frequency_hz > 0.0 else None
        case "multisine":
            found = _common([component.frequency_hz for component in reference.components])
        case "move":
            found = 2.0 * (reference.duration_s + reference.dwell_s) if reference.repeat else None
        case "step" | "filtered_step":
            found = 2.0 * reference.dwell_s if reference.repeat else None
        case _:
            found = None
    return found if found is not None and 0.0 < found <= LONGEST_S else None


def _common(frequencies_hz: list[float]) -> float | None:
    """Return the period of a sum of sines whose frequencies are whole multiples of a millihertz."""
    counts = [round(Fraction(frequency) / FINEST_HZ) for frequency in frequencies_hz]
    whole = gcd(*counts) if counts else 0
    exact = all(abs(count * float(FINEST_HZ) - f) < 1e-9 for count, f in zip(counts, frequencies_hz, strict=True))
    return float(1 / (whole * FINEST_HZ)) if whole and exact else None
