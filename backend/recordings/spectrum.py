"""Power spectral density of recorded channels by averaged periodograms: P. D. Welch, IEEE Trans. Audio Electroacoust. 15, 1967."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from backend.recordings.layout import FIELD_INDEX, FIELDS
from backend.recordings.reader import Recording

LONGEST_SEGMENT = 2**16
FEWEST = 16
MOST_CHANNELS = 8
MOST_SAMPLES = 4_000_000
EVEN = 1e-3
"""Times are even if no distance is off the usual one by more than this share; clocks of floating point are."""


def spectrum(recording: Recording, channels: list[str], from_s: float, to_s: float) -> dict[str, Any]:
    """Return one-sided densities [unit²/Hz] of channels without their mean, Hann window, segments of at most 2^16 samples.

    Needs samples at even times: with gaps it takes the longest piece without, and says so in `note`. Raises ValueError if
    that is too short.
    """
    from scipy.signal import welch  # slow to import, and nothing else needs it

    _check(recording, channels, from_s, to_s)
    block = recording.read(["time", *channels], from_s, to_s)
    time, gaps = block.rows[:, 0], block.gaps()
    begin, end = _longest_even(time, gaps)
    if end - begin < FEWEST:
        raise ValueError(
            f"the span has {end - begin} samples at even times; expected at least {FEWEST}, so choose a longer one"
        )
    period_s = float(time[end - 1] - time[begin]) / (end - begin - 1)
    length = min(LONGEST_SEGMENT, max(FEWEST, 2 ** int(np.log2((end - begin) / 2))))
    density, rms, unit = {}, {}, {}
    for place, name in enumerate(channels):
        values = block.rows[begin:end, place + 1]
        if not np.isfinite(values).all():
            raise ValueError(f"{name} has values that are no numbers in this span; choose another span or channel")
        frequencies, found = welch(
            values, fs=1.0 / period_s, window="hann", nperseg=length, detrend="constant", scaling="density"
        )
        density[name] = found.tolist()
        rms[name] = float(np.std(values))
        own = FIELDS[FIELD_INDEX[name]].unit
        unit[name] = f"({own})²/Hz" if "/" in own or "·" in own else f"{own or '1'}²/Hz"
    return {
        "frequencies_hz": frequencies.tolist(), "density": density, "unit": unit, "rms": rms,
        "from_s": float(time[begin]), "to_s": float(time[end - 1]), "segment_samples": length,
        "resolution_hz": 1.0 / (length * period_s), "note": _note(time, begin, end),
    }  # fmt: skip


def _check(recording: Recording, channels: list[str], from_s: float, to_s: float) -> None:
    if not 1 <= len(channels) <= MOST_CHANNELS:
        raise ValueError(f"{len(channels)} channels are asked for; expected 1 to {MOST_CHANNELS}")
    asked = recording.count(from_s, to_s)
    if asked > MOST_SAMPLES:
        raise ValueError(f"the span has {asked} samples; expected at most {MOST_SAMPLES}, so choose a shorter one")


def _longest_even(time: NDArray[np.float64], gaps: NDArray[np.intp]) -> tuple[int, int]:
    """Return begin and end of the longest run of rows without a gap, at even times."""
    if len(time) < 2:
        return 0, len(time)
    steps = np.diff(time)
    usual = np.median(steps)
    uneven = np.flatnonzero(np.abs(steps - usual) > EVEN * usual + 1e-9) + 1
    borders = np.unique(np.concatenate([[0], gaps, uneven, [len(time)]]))
    longest = int(np.argmax(np.diff(borders)))
    return int(borders[longest]), int(borders[longest + 1])


def _note(time: NDArray[np.float64], begin: int, end: int) -> str | None:
    if end - begin == len(time):
        return None
    return (
        f"Samples are missing or uneven in time: this is of the longest piece without a gap, {time[begin]:g} to "
        f"{time[end - 1]:g} s."
    )
