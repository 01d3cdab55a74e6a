"""What comes from outside at every sample of a run, as functions of time: reference, stiffness command, disturbance torques.

Runs that differ in plant or tuning alone share all three, those that differ in one of them the two others.
"""

from numba.np.unsafe.ndarray import to_fixed_tuple

from vssea_core.compiled import entry
from vssea_core.signals.disturbances import loads_of_step
from vssea_core.signals.references import reference_at
from vssea_core.signals.stiffness import SLEW_SIZE, Slew, commanded


@entry
def fill_targets(reference, predicts, first, count, period, out):
    """Write target and aim of `count` samples of `period` [s] from sample `first` on into `out` (count, 10)."""
    for i in range(count):
        time = (first + i) * period
        target = reference_at(reference, time)
        out[i, 0:5] = target
        out[i, 5:10] = reference_at(reference, time + period) if predicts else target


@entry
def fill_commands(slew_row, first, count, period, out):
    """Write the commands of the stiffness motor [rad] into `out` (count, 1)."""
    slew = Slew(*to_fixed_tuple(slew_row, SLEW_SIZE))
    for i in range(count):
        out[i, 0] = commanded(slew, (first + i) * period)


@entry
def fill_loads(link_terms, motor_terms, first, count, period, out):
    """Write the torques [N m] of link and motor at the six instants of each sample into `out` (count, 12)."""
    for i in range(count):
        time = (first + i) * period
        out[i, 0:6] = loads_of_step(link_terms, time, time, period, True)
        out[i, 6:12] = loads_of_step(motor_terms, time, time, period, True)
