"""What the controller decides at a tick: observers, both references, prediction over the compute delay, law.

Simulation and hardware both run this one function; they differ in where the measurement comes from and in their limits.
"""

import numpy as np

from vssea_core.compiled import inlined
from vssea_core.control.law import StiffnessTarget, act
from vssea_core.control.observer import observe
from vssea_core.control.prediction import predicted
from vssea_core.signals.references import TRANSITION_SIZE, decay_transition, reference_at, with_transition
from vssea_core.signals.stiffness import advance_stiffness


@inlined
def gains_at(memory, command):
    """Return the stiffness motor position [rad] for which gains are taken: the last measured one, in steps of 1/1024 rad."""
    theta_ms = memory.stiffness.measured if memory.spring.started != 0.0 else command
    return np.rint(theta_ms * 1024.0) / 1024.0


@inlined
def is_changing(transition):
    """Return whether anything is left of earlier references."""
    changing = False
    for i in range(TRANSITION_SIZE):
        changing = changing or transition[i] != 0.0
    return changing


@inlined
def targets(predicts, reference, transition, changing, time, period):
    """Return the Target at `time` [s] and the one that the law aims at; advance `transition` in place by one `period` [s]."""
    target = reference_at(reference, time)
    if changing:
        target = with_transition(target, transition)
        decay_transition(transition, period)
    if not predicts:
        return target, target
    aim = reference_at(reference, time + period)  # the torque of this tick meets the plant one sample later
    if changing:
        aim = with_transition(aim, transition)
    return target, aim


@inlined
def decide(
    observing, tuning, predicts, memory, y, applied_e, applied_ms, coming_e, aim, slew, slewed, moves, command, period
):  # fmt: skip
    """Return the Memory at the Measurement `y`, the StiffnessTarget, the next Slewed, whether it was limited, and the Terms.

    `applied_e`, `applied_ms` [N m] acted over the period that ended, which belongs to the Prepared `observing`; `coming_e`
    acts over the next one, where the law `predicts`. `aim` is the Target to meet; `command` the stiffness motor's [rad], if
    it `moves` at all.
    """
    memory = observe(observing, memory, y, applied_e, applied_ms)
    known_torque = tuning.law.spring_constant * memory.spring.torque
    stiffness_target, slewed, rate_limited = advance_stiffness(slew, slewed, moves, command, known_torque, period)
    if predicts:
        ahead = predicted(tuning.law, memory, coming_e, stiffness_target.r2)
        terms = act(tuning.law, ahead, aim, StiffnessTarget(slewed.theta, slewed.rate, slewed.acceleration))
    else:
        terms = act(tuning.law, memory, aim, stiffness_target)
    return memory, stiffness_target, slewed, rate_limited, terms
