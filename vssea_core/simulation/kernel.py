"""The compiled closed loop: the tick and the simulated rig, for 10,000 samples of a simulation or one of a live session.

Order of a sample k: measure; observers up to k with the torque applied over [k-1, k); law; limits last; record; then the
plant over [k, k+1) with the torque of k, or of k-1 where the computer has a delay of one sample.
"""

import math

from numba.np.unsafe.ndarray import to_fixed_tuple

from vssea_core.actuator.drive import (
    END_STOP,
    LEAF_TORQUE,
    STIFFNESS_RATE,
    Heat,
    limit_motor_torque,
    limit_stiffness_torque,
    warmed,
)  # fmt: skip
from vssea_core.actuator.dynamics import PlantState, advance_plant, dry_friction
from vssea_core.actuator.sensors import measure
from vssea_core.actuator.spring import leaf
from vssea_core.compiled import entry, inlined
from vssea_core.control.packing import MEMORY_SIZE, keep_memory, loaded_memory, loaded_prepared
from vssea_core.control.step import step
from vssea_core.signals.disturbances import load
from vssea_core.signals.references import TRANSITION_SIZE, decay_transition, reference_at, with_transition
from vssea_core.signals.stiffness import SLEW_SIZE, SLEWED_SIZE, Slew, advance_stiffness
from vssea_core.simulation.state import APPLIED, HEAT, MEMORY, PENDING, PLANT, SLEWED, TRANSITION, loaded_rig

RUNNING, NOT_FINITE, SPRING_LEFT, RAN_AWAY = 0, 1, 2, 3
FARTHEST = 1000.0  # rad; nothing that runs on purpose gets there


@inlined
def health(state):
    """Return RUNNING, or why a PlantState cannot go on."""
    total = (
        state.theta_l + state.omega_l + state.theta_e + state.omega_e + state.theta_ms + state.omega_ms
        + state.motor_torque
    )  # fmt: skip
    if not math.isfinite(total):
        return NOT_FINITE
    if abs(state.theta_e - state.theta_l) >= math.pi:
        return SPRING_LEFT
    if abs(state.theta_l) > FARTHEST:
        return RAN_AWAY
    return RUNNING


@entry
def run(
    rig_row,
    before,
    prepared,
    reference,
    slew_row,
    link_terms,
    motor_terms,
    enabled,
    tuning_id,
    state,
    first,
    count,
    rows,
):
    """Advance `state` in place by `count` samples from sample `first`; return how many went well, and why it ended.

    Each sample is written to a row of `rows` (columns of channels.CHANNELS). `before` is the tuning in force until `first`,
    `prepared` from then on. With `enabled` 0 the motor's torque is zero and the stiffness axis still holds.
    """
    rig = loaded_rig(rig_row)
    plant, drives = rig.plant, rig.drives
    period = rig.sample_time_s
    tuning_before, tuning = loaded_prepared(before), loaded_prepared(prepared)
    slew = Slew(*to_fixed_tuple(slew_row, SLEW_SIZE))
    now = PlantState(*to_fixed_tuple(state[:PLANT], PLANT))
    heat = Heat(state[PLANT], state[PLANT + 1])
    memory = loaded_memory(state[MEMORY : MEMORY + MEMORY_SIZE])
    transition = state[TRANSITION : TRANSITION + TRANSITION_SIZE]
    slewed = state[SLEWED : SLEWED + SLEWED_SIZE]
    applied_e, applied_ms = state[APPLIED], state[APPLIED + 1]
    pending_e, pending_ms = state[PENDING], state[PENDING + 1]
    changing = False
    for i in range(TRANSITION_SIZE):
        changing = changing or transition[i] != 0.0

    done, end = 0, RUNNING
    for i in range(count):
        time = (first + i) * period
        y = measure(rig.encoders, now)
        target = reference_at(reference, time)
        if changing:
            target = with_transition(target, transition)
            decay_transition(transition, period)
        known_torque = tuning.law.spring_constant * memory.spring.torque
        stiffness_target, rate_limited = advance_stiffness(slew, slewed, time, known_torque, period)
        memory, terms = step(tuning_before, tuning, memory, y, applied_e, applied_ms, target, stiffness_target)
        tuning_before = tuning

        demanded = terms.motor_torque if enabled else 0.0
        torque, available, bits = limit_motor_torque(drives, heat, demanded, now.omega_e)
        stiffness_torque, stiffness_bits = limit_stiffness_torque(drives, heat, terms.stiffness_torque, now.omega_ms)
        if rig.compute_delay != 0.0:
            applied_e, pending_e = pending_e, torque
            applied_ms, pending_ms = pending_ms, stiffness_torque
            if not enabled:
                applied_e = pending_e = 0.0
        else:
            applied_e, applied_ms = torque, stiffness_torque

        deflection = now.theta_e - now.theta_l
        spring = leaf(deflection, now.theta_ms)
        tau_s = plant.spring_constant * spring.torque
        k = plant.spring_constant * spring.stiffness
        bits |= stiffness_bits
        if abs(tau_s * tau_s * tau_s) > drives.leaf_cube * abs(k):
            bits |= LEAF_TORQUE
        if rate_limited:
            bits |= STIFFNESS_RATE
        if now.theta_ms <= plant.theta_ms_stiff or now.theta_ms >= plant.theta_ms_soft:
            bits |= END_STOP
        row = rows[i]
        row[0] = time
        row[1] = target.r
        row[2] = now.theta_l
        row[3] = now.theta_e
        row[4] = target.r - now.theta_l
        row[5] = now.omega_l
        row[6] = now.omega_e
        row[7] = terms.e2
        row[8] = terms.e3
        row[9] = terms.e4
        row[10] = terms.sigma
        row[11] = terms.snap
        row[12] = demanded
        row[13] = applied_e
        row[14] = available
        row[15] = tau_s
        row[16] = load(link_terms, time, time)
        row[17] = tuning.law.link_inertia * memory.link.d
        row[18] = load(motor_terms, time, time) + dry_friction(plant, now.omega_e)
        row[19] = tuning.law.motor_inertia * memory.motor.d
        row[20] = tuning.law.link_inertia * memory.link.d1
        row[21] = k
        row[22] = slew.spring_constant / (2.0 * stiffness_target.r**3)
        row[23] = deflection
        row[24] = now.theta_ms
        row[25] = now.omega_ms
        row[26] = applied_ms
        row[27] = bits
        row[28] = tuning_id

        heat = warmed(drives, heat, applied_e, applied_ms)
        following = advance_plant(
            plant, rig.whole_lag, rig.fine_lag, now, applied_e, applied_ms, link_terms, motor_terms, time, period
        )
        end = health(following)
        if end != RUNNING:
            break
        now = following
        done += 1

    for i in range(PLANT):
        state[i] = now[i]
    for i in range(HEAT):
        state[PLANT + i] = heat[i]
    state[APPLIED], state[APPLIED + 1] = applied_e, applied_ms
    state[PENDING], state[PENDING + 1] = pending_e, pending_ms
    keep_memory(state[MEMORY : MEMORY + MEMORY_SIZE], memory)
    return done, end
