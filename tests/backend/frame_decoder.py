"""Telemetry frames taken apart by the table of docs/protocol.md, and by nothing else."""

import struct
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Decoded(NamedTuple):
    magic: bytes
    version: int
    flags: int
    channels: int
    samples: int
    epoch: int
    reserved: int
    sequence: int
    t0: float
    dt: float
    values: NDArray[np.float32]


def decoded(frame: bytes) -> Decoded:
    """The first frame in some bytes."""
    magic = frame[0:4]
    version, flags = struct.unpack_from("<HH", frame, 4)
    channels, samples, epoch, reserved = struct.unpack_from("<IIII", frame, 8)
    (sequence,) = struct.unpack_from("<Q", frame, 24)
    t0, dt = struct.unpack_from("<dd", frame, 32)
    values = np.frombuffer(frame, "<f4", channels * samples, offset=48).reshape(channels, samples)
    return Decoded(magic, version, flags, channels, samples, epoch, reserved, sequence, t0, dt, values)


def decoded_all(content: bytes) -> list[Decoded]:
    """All frames in some bytes, which nothing follows."""
    found = []
    while content:
        found.append(decoded(content))
        content = content[48 + found[-1].values.nbytes :]
    return found
