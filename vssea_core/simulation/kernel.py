"""The compiled closed loop: the tick and the simulated rig, for 10,000 samples of a simulation or one of a live session.

Order of a sample k: measure; observers up to k with the torque applied over [k-1, k); law; limits last; record; then the
plant over [k, k+1) with the torque of k, or of k-1 where the computer has a delay of one sample.
"""

import math

import numpy as np
from numba.np.unsafe.ndarray import to_fixed_tuple

from vssea_core.actuator.drive import (
    CONTINUOUS,
    END_STOP,
    LEAF_TORQUE,
    PEAK,
    SPEED,
    STIFFNESS_RATE,
    Heat,
    limit_motor_torque,
    limit_stiffness_torque,
    warmed,
)  # fmt: skip
from vssea_core.actuator.dynamics import PlantState, advance_plant, dry_friction
from vssea_core.actuator.parts import DELAY_LINE, advance_in_parts, lags_of_parts, passed_on
from vssea_core.actuator.sensors import measure
from vssea_core.actuator.spring import leaf
from vssea_core.compiled import entry, inlined
from vssea_core.control.observer import Memory
from vssea_core.control.packing import (
    MEMORY_SIZE,
    ROW,
    is_scheduled,
    keep_memory,
    loaded_memory,
    loaded_prepared,
    take_row,
)  # fmt: skip
from vssea_core.signals.references import TRANSITION_SIZE
from vssea_core.signals.stiffness import SLEW_SIZE, SLEWED_SIZE, Slew, Slewed, commanded
from vssea_core.simulation.rig_period import needs_parts
from vssea_core.simulation.state import APPLIED, DELAYED, HEAT, MEMORY, PENDING, PLANT, SLEWED, TRANSITION, loaded_rig
from vssea_core.tick.decision import decide, gains_at, is_changing, targets

RUNNING, NOT_FINITE, SPRING_LEFT, RAN_AWAY = 0, 1, 2, 3
ENDINGS = {
    NOT_FINITE: "a state became infinite or not a number",
    SPRING_LEFT: "the deflection left ±π rad, where the spring's law ends",
    RAN_AWAY: "the link is more than 1000 rad away",
}
"""Why a run cannot go on, in words."""
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
    stiffness_terms,
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
    row = np.empty(ROW)
    scheduled = is_scheduled(prepared)
    slew = Slew(*to_fixed_tuple(slew_row, SLEW_SIZE))
    now = PlantState(*to_fixed_tuple(state[:PLANT], PLANT))
    heat = Heat(state[PLANT], state[PLANT + 1])
    memory = loaded_memory(state[MEMORY : MEMORY + MEMORY_SIZE])
    transition = state[TRANSITION : TRANSITION + TRANSITION_SIZE]
    slewed = Slewed(*to_fixed_tuple(state[SLEWED : SLEWED + SLEWED_SIZE], SLEWED_SIZE))
    on_its_way = state[DELAYED : DELAYED + DELAY_LINE]
    in_parts = needs_parts(rig, link_terms, motor_terms, stiffness_terms)
    part_lags = (rig.lags[0], rig.lags[0])
    if in_parts:
        part_lags = lags_of_parts(plant, rig.torque_lag_s, rig.delay.share, period)
    applied_e, applied_ms = state[APPLIED], state[APPLIED + 1]
    pending_e, pending_ms = state[PENDING], state[PENDING + 1]
    changing = is_changing(transition)

    done, end = 0, RUNNING
    while done < count and end == RUNNING:
        # The gains of the next samples: of all that are left, or until those that follow the stiffness have to change. The
        # observer of the period that has just ended belongs to the tuning that was in force.
        samples = 1 if done == 0 else count - done
        at = gains_at(memory, slewed.command)
        observing_values = before if done == 0 else prepared
        take_row(observing_values, at, row)
        observing = loaded_prepared(observing_values, row)
        take_row(prepared, at, row)
        tuning = loaded_prepared(prepared, row)
        predicts = tuning.law.predict != 0.0 and rig.compute_delay != 0.0
        for i in range(done, done + samples):
            if scheduled and gains_at(memory, slewed.command) != at:
                break
            time = (first + i) * period
            y = measure(rig.encoders, rig.noise, now, first + i)
            target, aim = targets(predicts, reference, transition, changing, time, period)
            memory, stiffness_target, slewed, rate_limited, terms = decide(
                observing, tuning, predicts, memory, y, applied_e, applied_ms, pending_e,
                aim, slew, slewed, True, commanded(slew, time), period,
            )  # fmt: skip
            demanded = terms.motor_torque if enabled else 0.0
            torque, available, bits = limit_motor_torque(drives, heat, demanded, now.omega_e)
            if bits & (PEAK | CONTINUOUS | SPEED) == 0:
                twisting = terms.twisting if enabled else 0.0
                memory = Memory(memory.link, memory.motor, memory.stiffness, memory.spring, twisting)
            stiffness_torque, stiffness_bits = limit_stiffness_torque(
                drives, heat, terms.stiffness_torque, now.omega_ms
            )
            if rig.compute_delay != 0.0:
                applied_e, pending_e = pending_e, torque
                applied_ms, pending_ms = pending_ms, stiffness_torque
                if not enabled:
                    applied_e = pending_e = 0.0
            else:
                applied_e, applied_ms = torque, stiffness_torque

            heat = warmed(drives, heat, applied_e, applied_ms)
            if in_parts:
                older, newer = passed_on(rig.delay, on_its_way, applied_e)
                following, (load_l, load_e, load_ms) = advance_in_parts(
                    plant, rig.torque_lag_s, part_lags, now, older, newer, rig.delay.share, applied_ms,
                    link_terms, motor_terms, stiffness_terms, time, period,
                )  # fmt: skip
            else:
                following, (load_l, load_e, load_ms) = advance_plant(
                    plant, rig.lags, now, applied_e, applied_ms, link_terms, motor_terms, time, period
                )
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
            rows[i, 0] = time
            rows[i, 1] = target.r
            rows[i, 2] = now.theta_l
            rows[i, 3] = now.theta_e
            rows[i, 4] = target.r - now.theta_l
            rows[i, 5] = now.omega_l
            rows[i, 6] = now.omega_e
            rows[i, 7] = terms.e2
            rows[i, 8] = terms.e3
            rows[i, 9] = terms.e4
            rows[i, 10] = terms.sigma
            rows[i, 11] = terms.snap
            rows[i, 12] = demanded
            rows[i, 13] = applied_e
            rows[i, 14] = available
            rows[i, 15] = tau_s
            rows[i, 16] = load_l
            rows[i, 17] = tuning.law.link_inertia * memory.link.d
            rows[i, 18] = load_e + dry_friction(plant, now.omega_e)
            rows[i, 19] = tuning.law.motor_inertia * memory.motor.d
            rows[i, 20] = tuning.law.link_inertia * memory.link.d1
            rows[i, 21] = k
            rows[i, 22] = slew.spring_constant / (2.0 * stiffness_target.r**3)
            rows[i, 23] = deflection
            rows[i, 24] = now.theta_ms
            rows[i, 25] = now.omega_ms
            rows[i, 26] = applied_ms
            rows[i, 27] = bits
            rows[i, 28] = tuning_id
            rows[i, 29] = load_ms
            rows[i, 30] = tuning.law.link_inertia * memory.link.d2
            rows[i, 31] = tuning.law.motor_inertia * memory.motor.d1

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
    for i in range(SLEWED_SIZE):
        state[SLEWED + i] = slewed[i]
    keep_memory(state[MEMORY : MEMORY + MEMORY_SIZE], memory)
    return done, end
