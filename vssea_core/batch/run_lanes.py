"""Runs side by side: packed into lanes, started, advanced block by block, and summed up."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vssea_core.batch import layout as at
from vssea_core.batch.course_book import CourseBook
from vssea_core.batch.lane_access import LANES, aligned_lanes
from vssea_core.batch.lanes import Variant, lanes_kernel
from vssea_core.batch.numbers import RunNumbers
from vssea_core.batch.sums import first_sums, metrics_of_sums
from vssea_core.channels import CHANNELS
from vssea_core.simulation.kernel import RUNNING, run

Numbers = NDArray[np.float64]
BLOCK, LONG_BLOCK = 500, 5000
"""Samples that are passed at once: few enough for courses of all lanes to stay in the processor's cache, more for one course."""


def run_side_by_side(
    variant: Variant, runs: Sequence[RunNumbers], courses: CourseBook
) -> tuple[Numbers, NDArray[np.bool_]]:
    """Return metrics and limit shares (n, 17) of up to LANES runs of one kind, and which of them ended early (n,).

    `courses` keeps what these runs have in common with others. What is returned of a run that ended early means nothing:
    run it alone.
    """
    first = runs[0]
    period, count = first.scenario.timing.sample_time_s, first.count
    lanes = aligned_lanes(at.LANE_SIZE)
    gone = np.zeros(len(runs), dtype=bool)
    for j, each in enumerate(runs):
        gone[j] = not _start(each, lanes[:, j])
    lanes[:, len(runs) :] = lanes[:, :1]  # lanes that nobody needs do what the first one does
    tunings = np.array([each.prepared for each in runs] + [first.prepared] * (LANES - len(runs)))
    courses.open(runs, variant.predicts)
    kernel, block = lanes_kernel(variant), lanes.ravel()
    longest = LONG_BLOCK if courses.are_kept else BLOCK
    for begin in range(1, count, longest):
        samples = min(longest, count - begin)
        pages = (
            courses.targets.pages(begin, samples, period), courses.targets.which,
            courses.commands.pages(begin, samples, period), courses.commands.which,
            courses.loads.pages(begin, samples, period), courses.loads.which,
        )  # fmt: skip
        kernel(
            block, tunings, *pages, courses.link_terms, courses.motor_terms,
            begin, samples, period, first.delayed, first.is_scheduled,
        )  # fmt: skip
        if lanes[at.GONE].all():
            break
    gone |= lanes[at.GONE, : len(runs)] != 0.0
    return metrics_of_sums(lanes[at.SUMS : at.TAKEN_AT, : len(runs)].T, count, period), gone


def _start(each: RunNumbers, lane: Numbers) -> bool:
    """Pass the first sample of a run, alone, and put all its numbers into a lane; return whether it goes on."""
    inputs, row = each.inputs, np.empty((1, len(CHANNELS)))
    _, end = run(
        inputs.rig, each.prepared, each.prepared, each.reference, each.slew,
        inputs.link_terms, inputs.motor_terms, inputs.stiffness_terms, True, 1.0, each.state, 0, 1, row,
    )  # fmt: skip
    lane[at.RIG : at.PREPARED] = inputs.rig[: at.PREPARED]
    lane[at.PREPARED : at.SLEW] = each.prepared[: at.SLEW - at.PREPARED]
    lane[at.SLEW : at.STATE] = each.slew
    lane[at.STATE : at.TARGET] = each.state
    lane[at.SUMS : at.TAKEN_AT], lane[at.TAKEN_AT] = first_sums(row[0]), np.nan
    return bool(end == RUNNING)
