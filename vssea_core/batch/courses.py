"""What comes from outside at every sample of a run: reference, stiffness command and disturbance torques, as functions of time.

Runs that differ in plant or tuning alone share one course, which is then computed once.
"""

from numba.np.unsafe.ndarray import to_fixed_tuple

from vssea_core.compiled import entry
from vssea_core.signals.disturbances import loads_of_step
from vssea_core.signals.references import reference_at
from vssea_core.signals.stiffness import SLEW_SIZE, Slew, commanded


@entry
def fill_course(reference, slew_row, link_terms, motor_terms, predicts, first, count, period, out):
    """Write the course of `count` samples of `period` [s] from sample `first` on into `out` (count, layout.COURSE_SIZE)."""
    slew = Slew(*to_fixed_tuple(slew_row, SLEW_SIZE))
    for i in range(count):
        time = (first + i) * period
        target = reference_at(reference, time)
        aim = reference_at(reference, time + period) if predicts else target
        out[i, 0:5] = target
        out[i, 5:10] = aim
        out[i, 10] = commanded(slew, time)
        out[i, 11:17] = loads_of_step(link_terms, time, time, period, True)
        out[i, 17:23] = loads_of_step(motor_terms, time, time, period, True)
