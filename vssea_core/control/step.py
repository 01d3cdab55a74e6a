"""The tick: one compiled function for simulation, batch and the live loop."""

from vssea_core.compiled import inlined
from vssea_core.control.law import act
from vssea_core.control.observer import observe


@inlined
def step(before, prepared, memory, measurement, applied_e, applied_ms, target, stiffness_target):
    """Return the controller's next memory and the Terms of this tick.

    `before` is the tuning that was in force over the period that has just ended (its observer belongs to that period),
    `prepared` the one from now on; they differ in the tick of a change only, which makes a change of bandwidth bumpless.
    `applied_e`, `applied_ms` [N m] are the torques that were really applied over that period, after all limits.
    """
    memory = observe(before, memory, measurement, applied_e, applied_ms)
    return memory, act(prepared.law, memory, target, stiffness_target)
