"""The compiled tick of a rig: from three measured positions to the torques of the next exchange, and one row of channels."""

import math

from numba.np.unsafe.ndarray import to_fixed_tuple

from vssea_core.actuator.drive import (
    END_STOP,
    LEAF_TORQUE,
    STIFFNESS_RATE,
    Drives,
    Heat,
    warmed,
)
from vssea_core.actuator.sensors import Measurement
from vssea_core.actuator.spring import leaf
from vssea_core.compiled import entry
from vssea_core.control.observer import Memory
from vssea_core.control.packing import MEMORY_SIZE, keep_memory, loaded_memory, loaded_prepared, take_row
from vssea_core.control.prediction import predicted
from vssea_core.signals.disturbances import load
from vssea_core.signals.references import TRANSITION_SIZE, reference_at, with_transition
from vssea_core.signals.stiffness import SLEW_SIZE, SLEWED_SIZE, Slew, Slewed, commanded
from vssea_core.simulation.state import DRIVES_SIZE
from vssea_core.tick.bounds import BLENDED, BOUNDS_SIZE, RIG_STIFFNESS, Bounds
from vssea_core.tick.decision import decide, gains_at, is_changing, targets
from vssea_core.tick.limits import Motion, limit_brake, limit_motor, limit_stiffness

READING, CLOSED, BRAKING, STIFFNESS_HOLDS = 0, 1, 2, 3
"""What the torques are: none, the law's, the brake's with a held stiffness, none with a held stiffness."""

TRANSITION_AT = MEMORY_SIZE
SLEWED_AT = TRANSITION_AT + TRANSITION_SIZE
HEAT_AT = SLEWED_AT + SLEWED_SIZE
PLACES_AT = HEAT_AT + 2  # last positions
SPEEDS_AT = PLACES_AT + 3  # filtered differences of the encoders
KNOWN_AT = SPEEDS_AT + 3  # torques over the last period as the observers are told
SENT_AT = KNOWN_AT + 2  # torques asked of the next exchange, and what was added on purpose in them
SEEN_AT = SENT_AT + 4  # for monitors: deflection, spring torque, stiffness, demand, three disturbance estimates
FINITE_AT = SEEN_AT + 7  # 0 after a tick in which something was no number
CLIPPED_AT = FINITE_AT + 1  # 1 where the commanded stiffness lies outside the rig's range
MOVED_AT = CLIPPED_AT + 1  # 1 once there are last positions
SAG_AT = MOVED_AT + 1  # slow part of the deflection
STATE_SIZE = SAG_AT + 1

WIDEST = 1.2  # the spring's law is evaluated up to this factor outside the end stops


@entry
def target_in_force(reference, transition, time):
    """Return the Target of a reference row with what is left of earlier ones, at `time` [s]."""
    return with_transition(reference_at(reference, time), transition)


@entry
def tick(
    bounds_row, drives_row, before, prepared, gains, reference, slew_row, motor_terms, stiffness_terms, tuning_id,
    state, sample, period, theta_l, theta_e, theta_ms, taken_e, taken_ms, missed, mode, blend, row,
):  # fmt: skip
    """Advance `state` (STATE_SIZE) by one cycle, fill `row`, return motor and stiffness torque [N m] of the next exchange.

    Positions [rad] are those latched as the torques `taken_e`, `taken_ms` [N m] took effect; of a `missed` cycle they are
    predicted, and the torques sent before are held. `gains` (2, ROW) is room for the gains of `before`, the tuning of the
    period that has ended, and of `prepared`.
    """
    bounds = Bounds(*to_fixed_tuple(bounds_row, BOUNDS_SIZE))
    drives = Drives(*to_fixed_tuple(drives_row, DRIVES_SIZE))
    slew = Slew(*to_fixed_tuple(slew_row, SLEW_SIZE))
    memory = loaded_memory(state[:MEMORY_SIZE])
    transition = state[TRANSITION_AT : TRANSITION_AT + TRANSITION_SIZE]
    slewed = Slewed(*to_fixed_tuple(state[SLEWED_AT : SLEWED_AT + SLEWED_SIZE], SLEWED_SIZE))
    heat = Heat(state[HEAT_AT], state[HEAT_AT + 1])
    sent_e, sent_ms = state[SENT_AT], state[SENT_AT + 1]
    added_e, added_ms = state[SENT_AT + 2], state[SENT_AT + 3]
    time = sample * period

    at = gains_at(memory, slewed.command)
    take_row(before, at, gains[0])
    observing = loaded_prepared(before, gains[0])
    take_row(prepared, at, gains[1])
    tuning = loaded_prepared(prepared, gains[1])

    if missed:
        taken_e, taken_ms = sent_e, sent_ms
        theta_l, theta_e, theta_ms = state[PLACES_AT], state[PLACES_AT + 1], state[PLACES_AT + 2]
        if memory.spring.started != 0.0:
            ahead = predicted(observing.law, memory, state[KNOWN_AT], slewed.acceleration)
            theta_l, theta_e, theta_ms = ahead.link.theta, ahead.motor.theta, ahead.stiffness.measured
    measured = math.isfinite(theta_l + theta_e + theta_ms)
    if not measured:
        theta_l, theta_e, theta_ms = state[PLACES_AT], state[PLACES_AT + 1], state[PLACES_AT + 2]
    keep, gain = bounds.difference_keep, bounds.difference_gain
    if state[MOVED_AT] == 0.0:
        state[SAG_AT] = theta_e - theta_l
    else:
        state[SAG_AT] += bounds.sag_gain * (theta_e - theta_l - state[SAG_AT])
        state[SPEEDS_AT] = keep * state[SPEEDS_AT] + gain * (theta_l - state[PLACES_AT])
        state[SPEEDS_AT + 1] = keep * state[SPEEDS_AT + 1] + gain * (theta_e - state[PLACES_AT + 1])
        state[SPEEDS_AT + 2] = keep * state[SPEEDS_AT + 2] + gain * (theta_ms - state[PLACES_AT + 2])
    state[PLACES_AT], state[PLACES_AT + 1], state[PLACES_AT + 2], state[MOVED_AT] = theta_l, theta_e, theta_ms, 1.0
    omega_l, omega_e, omega_ms = state[SPEEDS_AT], state[SPEEDS_AT + 1], state[SPEEDS_AT + 2]

    place = min(max(theta_ms, bounds.stop_stiff / WIDEST), bounds.stop_soft * WIDEST)  # not homed, it may be anything
    y = Measurement(theta_l, theta_e, place, omega_l, omega_e, omega_ms)
    predicts = tuning.law.predict != 0.0
    target, aim = targets(predicts, reference, transition, is_changing(transition), time, period)
    memory, stiffness_target, slewed, rate_limited, terms = decide(
        observing, tuning, predicts, memory, y, state[KNOWN_AT], state[KNOWN_AT + 1], taken_e + added_e,
        aim, slew, slewed, True, commanded(slew, time), period,
    )  # fmt: skip
    state[KNOWN_AT], state[KNOWN_AT + 1] = taken_e + added_e, taken_ms + added_ms

    deflection = theta_e - theta_l
    spring = leaf(deflection, place)
    tau_s, k = bounds.spring_constant * spring.torque, bounds.spring_constant * spring.stiffness
    motion = Motion(
        theta_l, theta_e, place, omega_l, omega_e, omega_ms,
        tau_s, bounds.spring_constant * spring.back, k, state[SAG_AT],
    )  # fmt: skip
    demanded, twisting, bits, stiffness_bits = 0.0, 0.0, 0, 0
    torque = stiffness_torque = 0.0
    available = min(bounds.motor_torque, drives.peak_torque)
    finite = measured
    load_e = load_ms = 0.0
    if mode == CLOSED:
        demanded = terms.motor_torque
        load_e = blend * load(motor_terms, time + period, time + period)
        load_ms = load(stiffness_terms, time + period, time + period)
        finite = finite and math.isfinite(demanded)
        if finite:
            torque, available, bits = limit_motor(bounds, drives, heat, motion, blend * demanded - load_e, sent_e)
            twisting = terms.twisting if bits == 0 else memory.twisting
            if blend < 1.0:
                bits |= BLENDED
    elif mode == BRAKING:
        demanded = -bounds.brake * omega_e
        if measured:
            torque, available, bits = limit_brake(bounds, drives, heat, demanded, sent_e)
    if mode != READING:
        whole = measured and math.isfinite(terms.stiffness_torque)
        finite = finite and whole
        if whole:
            stiffness_torque, stiffness_bits = limit_stiffness(
                bounds, drives, heat, motion, terms.stiffness_torque - load_ms
            )
    if missed and finite:
        torque = sent_e if mode in (CLOSED, BRAKING) else 0.0
        stiffness_torque = sent_ms if mode != READING else 0.0
        load_e, load_ms = added_e, added_ms
    heat = warmed(drives, heat, taken_e, taken_ms)
    memory = Memory(memory.link, memory.motor, memory.stiffness, memory.spring, twisting)

    bits |= stiffness_bits
    if abs(tau_s * tau_s * tau_s) > drives.leaf_cube * abs(k):
        bits |= LEAF_TORQUE
    if rate_limited:
        bits |= STIFFNESS_RATE
    if state[CLIPPED_AT] != 0.0 and mode != READING:
        bits |= RIG_STIFFNESS
    if theta_ms <= bounds.stop_stiff or theta_ms >= bounds.stop_soft:
        bits |= END_STOP
    if place != theta_ms:
        tau_s = k = math.nan
    row[0] = time
    row[1] = target.r
    row[2] = theta_l
    row[3] = theta_e
    row[4] = target.r - theta_l
    row[5] = memory.link.omega
    row[6] = memory.motor.omega
    row[7] = terms.e2
    row[8] = terms.e3
    row[9] = terms.e4
    row[10] = terms.sigma
    row[11] = terms.snap
    row[12] = demanded
    row[13] = taken_e
    row[14] = available
    row[15] = tau_s
    row[16] = math.nan
    row[17] = tuning.law.link_inertia * memory.link.d
    row[18] = added_e
    row[19] = tuning.law.motor_inertia * memory.motor.d
    row[20] = tuning.law.link_inertia * memory.link.d1
    row[21] = k
    row[22] = slew.spring_constant / (2.0 * stiffness_target.r**3)
    row[23] = deflection
    row[24] = theta_ms
    row[25] = memory.stiffness.omega
    row[26] = taken_ms
    row[27] = bits
    row[28] = tuning_id
    row[29] = added_ms
    row[30] = tuning.law.link_inertia * memory.link.d2
    row[31] = tuning.law.motor_inertia * memory.motor.d1

    state[SEEN_AT] = deflection
    state[SEEN_AT + 1] = tau_s
    state[SEEN_AT + 2] = k
    state[SEEN_AT + 3] = demanded
    state[SEEN_AT + 4] = tuning.law.link_inertia * memory.link.d
    state[SEEN_AT + 5] = tuning.law.motor_inertia * memory.motor.d
    state[SEEN_AT + 6] = tuning.law.stiffness_inertia * memory.stiffness.d
    keep_memory(state[:MEMORY_SIZE], memory)
    sound = True
    for i in range(MEMORY_SIZE):
        sound = sound and math.isfinite(state[i])
    if not sound:
        state[:MEMORY_SIZE] = 0.0  # the observers start again from the next measurement
        finite = False
    state[FINITE_AT] = 1.0 if finite else 0.0
    for i in range(SLEWED_SIZE):
        state[SLEWED_AT + i] = slewed[i]
    state[HEAT_AT], state[HEAT_AT + 1] = heat.motor, heat.stiffness_motor
    state[SENT_AT], state[SENT_AT + 1] = torque, stiffness_torque
    state[SENT_AT + 2], state[SENT_AT + 3] = load_e, load_ms
    return torque, stiffness_torque
