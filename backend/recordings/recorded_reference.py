"""A recorded course as a reference: what one run did, or a rig was moved by hand, is followed by another run."""

import math
from typing import Any

import numpy as np

from backend.recordings.layout import FIELD_INDEX, FIELDS
from backend.recordings.reader import Recording
from vssea_core.signals.documents import MAX_RECORDED, SHORTEST_RECORDED_S, RecordedReference

FARTHEST = 100.0
LONGEST_S = 1e4


def recorded_reference(recording: Recording, channel: str, from_s: float, to_s: float) -> dict[str, Any]:
    """Return a `recorded` reference document of a position channel, from its first sample at 0 s on.

    It keeps every n-th sample, as many as such a document takes, and the last. Raises ValueError if the channel is no
    position, has fewer than two samples there, or leaves the range of a reference.
    """
    if channel not in FIELD_INDEX or FIELDS[FIELD_INDEX[channel]].unit != "rad":
        positions = ", ".join(field.name for field in FIELDS if field.unit == "rad")
        raise ValueError(f"{channel!r} cannot be a reference; expected a position, one of {positions}")
    rows = recording.read(["time", channel], from_s, to_s).rows
    rows = rows[np.isfinite(rows).all(axis=1)]
    if len(rows) < 2:
        raise ValueError(f"{channel} has {len(rows)} samples from {from_s:g} to {to_s:g} s; expected at least 2")
    times, positions_rad = rows[:, 0] - rows[0, 0], rows[:, 1]
    if times[-1] > LONGEST_S:
        raise ValueError(f"the span lasts {times[-1]:g} s; expected at most {LONGEST_S:g} s, so choose a shorter one")
    if np.abs(positions_rad).max() > FARTHEST:
        raise ValueError(
            f"{channel} reaches {np.abs(positions_rad).max():.4g} rad; a reference stays within ±{FARTHEST:g} rad"
        )
    kept = _kept(times)
    if len(kept) < 2:
        raise ValueError(
            f"the span lasts {times[-1]:g} s; expected at least {SHORTEST_RECORDED_S:g} s, so choose a longer one"
        )
    return RecordedReference(
        times_s=tuple(np.round(times[kept], 9).tolist()), positions=tuple(positions_rad[kept].tolist())
    ).model_dump(mode="json")


def _kept(times: np.ndarray) -> list[int]:
    """Return the places of every n-th sample and the last, MAX_RECORDED at most and 1 ms apart at least."""
    last, shortest = len(times) - 1, SHORTEST_RECORDED_S * (1.0 - 1e-6)
    apart = float(np.median(np.diff(times)))
    stride = max(1, math.ceil(last / (MAX_RECORDED - 1)), math.ceil(shortest / apart))
    kept = [0]
    for place in [*range(stride, last, stride), last]:
        if times[place] - times[kept[-1]] >= shortest:  # uneven times may come close
            kept.append(place)
        elif place == last and len(kept) > 1:
            kept[-1] = last
    return kept
