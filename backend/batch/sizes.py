"""How long the runs of a batch take, how large their results are, and how many of them make a part."""

import math

from vssea_core.batch.document import Keep

LANE_SAMPLES_PER_S, ALONE_SAMPLES_PER_S = 4e7, 3.5e6
"""Samples computed in a second by one core, in lanes and alone."""
RUN_S = 9e-5
"""What a run takes besides its samples: its scenario, its row."""
PART_S = 1.5
"""A part takes about so long: little to lose, little to wait for, and little spent on giving it out."""
PART_BYTES = 8_000_000
COLUMN_BYTES = 310.0
"""What a column of a part's file takes besides its values."""
HELD_BYTES = 64_000_000
"""Samples that a worker holds while it computes a part take no more, even if every run ends early."""
MOST_RUNS, STEP = 16_384, 16
PARTS_A_WORKER = 8
"""A short batch still has so many parts for each worker, so that all end at about the same time."""
ENDED_SHARE = 0.1
"""Runs that are taken to end early where only the samples of those are kept."""


def seconds_of(samples: int, in_lanes: bool, keep: Keep) -> float:
    """Return how long a run takes one core [s]; one whose samples are kept is run twice."""
    again = {"none": 0.0, "ended": ENDED_SHARE, "all": 1.0}[keep.trajectories] * samples / ALONE_SAMPLES_PER_S
    return RUN_S + samples / (LANE_SAMPLES_PER_S if in_lanes else ALONE_SAMPLES_PER_S) + again


def bytes_of(columns: int, samples: int, keep: Keep) -> float:
    """Return how large the results of a run are, at most about: numbers that vary are hardly compressed."""
    share = {"none": 0.0, "ended": ENDED_SHARE, "all": 1.0}[keep.trajectories]
    return 8.0 * columns + share * _kept(samples, keep)


def held_of(samples: int, keep: Keep) -> float:
    """Return how large the samples of a run are while its part is computed, if they are kept."""
    return 0.0 if keep.trajectories == "none" else _kept(samples, keep)


def part_size(runs: int, seconds: float, size: float, workers: int, held: float = 0.0) -> int:
    """Return how many runs make a part, from what one of them takes [s] and [bytes], and holds meanwhile [bytes]."""
    most = min(PART_S / seconds, PART_BYTES / size, MOST_RUNS, math.ceil(runs / (PARTS_A_WORKER * workers)))
    in_steps = STEP * max(1, math.ceil(most / STEP))
    return min(in_steps, max(1, int(HELD_BYTES / held))) if held else in_steps


def _kept(samples: int, keep: Keep) -> float:
    width = 8 if keep.precision == "float64" else 4
    return math.ceil(samples / keep.every) * (8.0 + width * len(keep.channels))
