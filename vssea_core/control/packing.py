"""The tick's parameters and memory as flat arrays: what is swapped, kept and shared are plain numbers."""

from typing import NamedTuple

from numba.np.unsafe.ndarray import to_fixed_tuple

from vssea_core.compiled import inlined
from vssea_core.control.law import Law
from vssea_core.control.observer import Channel, Memory, ObserverGains, Spring

LAW, GAINS, CHANNEL, SPRING = len(Law._fields), len(ObserverGains._fields), len(Channel._fields), len(Spring._fields)
MEMORY_SIZE = 3 * CHANNEL + SPRING


class Prepared(NamedTuple):
    """A tuning as the tick takes it."""

    law: Law
    link: ObserverGains
    motor: ObserverGains
    stiffness: ObserverGains


@inlined
def loaded_prepared(values):
    """Return the Prepared of an array made by `prepare`."""
    return Prepared(
        Law(*to_fixed_tuple(values[:LAW], LAW)),
        ObserverGains(*to_fixed_tuple(values[LAW : LAW + GAINS], GAINS)),
        ObserverGains(*to_fixed_tuple(values[LAW + GAINS : LAW + 2 * GAINS], GAINS)),
        ObserverGains(*to_fixed_tuple(values[LAW + 2 * GAINS : LAW + 3 * GAINS], GAINS)),
    )


@inlined
def loaded_memory(values):
    """Return the Memory kept in an array of MEMORY_SIZE numbers; all zeros is a controller that has not started."""
    return Memory(
        Channel(*to_fixed_tuple(values[:CHANNEL], CHANNEL)),
        Channel(*to_fixed_tuple(values[CHANNEL : 2 * CHANNEL], CHANNEL)),
        Channel(*to_fixed_tuple(values[2 * CHANNEL : 3 * CHANNEL], CHANNEL)),
        Spring(*to_fixed_tuple(values[3 * CHANNEL : 3 * CHANNEL + SPRING], SPRING)),
    )


@inlined
def keep_memory(values, memory):
    """Write `memory` into an array of MEMORY_SIZE numbers."""
    for i in range(CHANNEL):
        values[i] = memory.link[i]
        values[CHANNEL + i] = memory.motor[i]
        values[2 * CHANNEL + i] = memory.stiffness[i]
    for i in range(SPRING):
        values[3 * CHANNEL + i] = memory.spring[i]
