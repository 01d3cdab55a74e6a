"""Compiled loops over many closed loops: assembling them, and their margins."""

import numpy as np

from vssea_core.analysis.assembly import OUTPUTS, assembled, joined_plant, single_step_plant
from vssea_core.analysis.margin_kernel import margins_of
from vssea_core.analysis.probe import (
    LINK_ESTIMATE,
    MEASURED,
    MOTOR_ESTIMATE,
    OBSERVED,
    PLANT_COLUMNS,
    PLANT_STATES,
    probe_plant,
)
from vssea_core.compiled import entry


@entry
def systems_of(
    observers, laws, theta_ms, rows, first, second, whole, fraction, states, pairs, period_s, compute_delay, inputs
):
    """Return stacked A, B, C, D of the loops of `pairs` (n, 2) of controllers and plants (batch.Batch)."""
    measured = np.array(MEASURED)
    estimates = np.array((LINK_ESTIMATE, MOTOR_ESTIMATE))
    count = len(pairs)
    most = PLANT_STATES + OBSERVED + int(whole.max()) + 2
    A = np.zeros((count, most, most))
    B, C, D = np.zeros((count, most, inputs)), np.zeros((count, OUTPUTS, most)), np.zeros((count, OUTPUTS, inputs))
    one, two = np.zeros((PLANT_STATES, PLANT_COLUMNS)), np.zeros((PLANT_STATES, PLANT_COLUMNS))
    largest = 0
    for i in range(count):
        k, j = pairs[i, 0], pairs[i, 1]
        split = fraction[j] > 0.0
        probe_plant(rows[j], second[j], theta_ms[k], (1.0 - fraction[j]) * period_s, two)
        if split:
            probe_plant(rows[j], first[j], theta_ms[k], fraction[j] * period_s, one)
            plant = joined_plant(one, two, states)
        else:
            plant = single_step_plant(two, states)
        a, b, c, d = assembled(
            plant, measured, observers[k], laws[k], estimates, whole[j], split, compute_delay, inputs
        )
        n = a.shape[0]
        largest = max(largest, n)
        A[i, :n, :n], B[i, :n], C[i, :, :n], D[i] = a, b, c, d
    return A[:, :largest, :largest].copy(), B[:, :largest].copy(), C[:, :, :largest].copy(), D


@entry
def margins_of_all(A, B, C, D, multipliers, stable, period_s, compute_delay, per_decade, found):
    """Write the margins of every stable loop of a stack to `found` (n, 2, FIELDS)."""
    crossovers = np.empty((2, 1))
    for i in range(A.shape[0]):
        if stable[i]:
            found[i] = margins_of(
                A[i], B[i], C[i], D[i], multipliers[i], period_s, compute_delay, per_decade, crossovers
            )
