"""Binary telemetry frames, as docs/protocol.md has them: a header, then float32 samples channel by channel."""

import struct
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from backend.telemetry.ring import EPOCH, PERIOD_S, WIDTH, Piece
from vssea_core.channels import INDEX

MAGIC, VERSION = b"VSSE", 1
HISTORY = 1
HEADER = struct.Struct("<4sHHIIIIQdd")
LONGEST = 1000
"""Samples a frame at most, so that no single send is long."""


def frames(piece: Piece, history: bool = False) -> Iterator[bytes]:
    """Yield the samples of `piece` as frames of at most LONGEST samples, none across two epochs."""
    epochs = piece.samples[:, EPOCH]
    borders = [0, *(np.flatnonzero(np.diff(epochs)) + 1).tolist(), len(epochs)]
    for begin, end in pairwise(borders):
        for start in range(begin, end, LONGEST):
            samples = piece.samples[start : min(start + LONGEST, end)]
            if len(samples):
                yield _frame(samples, piece.first + start, history)


def _frame(samples: np.ndarray, first: int, history: bool) -> bytes:
    header = HEADER.pack(
        MAGIC, VERSION, HISTORY if history else 0, WIDTH, len(samples), int(samples[0, EPOCH]), 0, first,
        float(samples[0, INDEX["time"]]), float(samples[0, PERIOD_S]),
    )  # fmt: skip
    return header + np.ascontiguousarray(samples[:, :WIDTH].T, np.float32).tobytes()
