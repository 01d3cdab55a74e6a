"""The closed loop of LANES runs at once: the tick and the plant of a single run, side by side in the lanes of vectors.

Nothing is computed here that simulation.kernel does not compute, by the same functions and in the same order, so that each
lane equals its single run to the bit. What few runs need is left out, and such runs are run alone: see batch.choice.
"""

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np

from vssea_core.actuator.drive import (
    CONTINUOUS,
    END_STOP,
    LEAF_TORQUE,
    PEAK,
    SPEED,
    STIFFNESS_RATE,
    Drives,
    Heat,
    limit_motor_torque,
    limit_stiffness_torque,
    warmed,
)  # fmt: skip
from vssea_core.actuator.dynamics import (
    FINEST,
    UNLOADED,
    LagShares,
    Plant,
    PlantState,
    dormand_prince_step,
    dry_friction,
    steps_of_period,
    stopped,
)  # fmt: skip
from vssea_core.actuator.sensors import Encoders, Noise, measure
from vssea_core.actuator.spring import leaf
from vssea_core.batch import layout as at
from vssea_core.batch.lane_access import LANES, align_stack, lane, put_lane
from vssea_core.compiled import called, entry, inlined, written_out
from vssea_core.control.law import (
    BASELINE,
    GAINS,
    LAYER,
    POSITION_FORM,
    SGN,
    SLIDING_MODE,
    STATE_FEEDBACK,
    SUPER_TWISTING,
    VELOCITY_FORM,
    Law,
    Target,
)  # fmt: skip
from vssea_core.control.observer import Channel, Memory, ObserverGains, Spring
from vssea_core.control.packing import FIXED, MEMORY_SIZE, OBSERVER, ROW, Prepared, take_row
from vssea_core.signals.disturbances import loads_of_step
from vssea_core.signals.stiffness import SLEW_SIZE, SLEWED_SIZE, Slew, Slewed
from vssea_core.simulation.kernel import RUNNING, health
from vssea_core.simulation.state import DRIVES_SIZE, ENCODERS_SIZE, LAG_SIZE, PLANT, PLANT_SIZE
from vssea_core.tick.decision import decide

RIG_AT, LAW_AT, GAINS_AT, SLEW_AT = at.RIG * LANES, at.PREPARED * LANES, at.GAINS_ROW * LANES, at.SLEW * LANES
LAGS_AT, DRIVES_AT, ENCODERS_AT = at.LAGS * LANES, at.DRIVES * LANES, at.ENCODERS * LANES
LINK_AT, MOTOR_AT, STIFFNESS_AT = at.LINK_OBSERVER * LANES, at.MOTOR_OBSERVER * LANES, at.STIFFNESS_OBSERVER * LANES
STATE_AT, HEAT_AT, APPLIED_AT, MEMORY_AT = at.STATE * LANES, at.HEAT * LANES, at.APPLIED * LANES, at.MEMORY * LANES
SLEWED_AT, TARGET_AT, AIM_AT, COMMAND_AT = at.SLEWED * LANES, at.TARGET * LANES, at.AIM * LANES, at.COMMAND * LANES
LINK_LOADS_AT, MOTOR_LOADS_AT, STEPS_AT = at.LINK_LOADS * LANES, at.MOTOR_LOADS * LANES, at.STEPS * LANES
SUMS_AT, GONE_AT, SUMS = at.SUMS * LANES, at.GONE * LANES, at.TAKEN_AT - at.SUMS
TARGETS, COMMANDS, LOADS = at.COMMAND - at.TARGET, at.LINK_LOADS - at.COMMAND, at.STEPS - at.LINK_LOADS
TAKEN_FOR, MEASURED_AT = at.TAKEN_AT * LANES, (at.MEMORY + 17) * LANES
TORQUE_LIMITS = PEAK | CONTINUOUS | SPEED


class Variant(NamedTuple):
    """What all runs of one kernel share, so that it is compiled for just that."""

    position_form: bool
    predicts: bool
    sliding: bool
    encoders: bool
    friction: bool
    stiffness_moves: bool


@inlined
def switch_without_library(switch):
    """Return the switch of the sliding law, which is not tanh here."""
    return LAYER if switch == LAYER else (SUPER_TWISTING if switch == SUPER_TWISTING else SGN)


@inlined
def counted(bits, bit):
    """Return 1 where a bit is set."""
    return 1.0 if bits & bit != 0 else 0.0


@inlined
def added_up(sums, error, torque, bits, link_error, motor_error):
    """Return the sums of a run with one more sample."""
    change = torque - sums[4]
    return (
        max(sums[0], abs(error)), sums[1] + error * error,
        max(sums[2], abs(torque)), sums[3] + torque * torque, torque, sums[5] + change * change,
        sums[6] + counted(bits, TORQUE_LIMITS), sums[7] + link_error * link_error, sums[8] + motor_error * motor_error,
        sums[9] + counted(bits, 1), sums[10] + counted(bits, 2), sums[11] + counted(bits, 4), sums[12] + counted(bits, 8),
        sums[13] + counted(bits, 16), sums[14] + counted(bits, 32), sums[15] + counted(bits, 64),
        sums[16] + counted(bits, 128),
    )  # fmt: skip


@inlined
def tuning_of(w, j, sliding, form, predict):
    """Return the Prepared of lane `j`, with its controller, the form of its observers and whether it predicts."""
    gains, fixed = lane(w, GAINS_AT + j, GAINS), lane(w, LAW_AT + j, FIXED)
    controller = SLIDING_MODE if sliding else (BASELINE if fixed[0] == BASELINE else STATE_FEEDBACK)
    known = (controller, switch_without_library(fixed[1]), fixed[2], fixed[3], fixed[4], form, predict)
    return Prepared(
        Law(*(gains + known + fixed[7:])),
        ObserverGains(*lane(w, LINK_AT + j, OBSERVER)),
        ObserverGains(*lane(w, MOTOR_AT + j, OBSERVER)),
        ObserverGains(*lane(w, STIFFNESS_AT + j, OBSERVER)),
    )


@inlined
def plant_of(w, j, friction):
    """Return the Plant of lane `j`, without dry friction unless there is any."""
    p = lane(w, RIG_AT + j, PLANT_SIZE)
    if friction:
        return Plant(*p)
    return Plant(*(p[:4] + (0.0, 1.0) + p[6:]))  # noqa: RUF005 - the compiler knows no other form


@inlined
def memory_of(w, j):
    """Return the Memory of lane `j`, which has started."""
    m = lane(w, MEMORY_AT + j, MEMORY_SIZE)
    return Memory(Channel(*m[0:6]), Channel(*m[6:12]), Channel(*m[12:18]), Spring(m[18], m[19], 1.0), m[21])


@inlined
def keep_lane_memory(w, j, memory):
    """Write the Memory of lane `j`."""
    put_lane(w, MEMORY_AT + j, memory.link)
    put_lane(w, MEMORY_AT + 6 * LANES + j, memory.motor)
    put_lane(w, MEMORY_AT + 12 * LANES + j, memory.stiffness)
    put_lane(w, MEMORY_AT + 18 * LANES + j, (memory.spring.torque, memory.spring.back, 1.0, memory.twisting))


@inlined
def settle(w, j, plant, y, motor_torque):
    """Write the plant's state of lane `j` at the end of a period; mark it as gone if it cannot go on."""
    theta_l, theta_e, theta_ms, omega_l, omega_e, omega_ms = y
    theta_ms, omega_ms = stopped(plant, theta_ms, omega_ms)
    following = PlantState(theta_l, omega_l, theta_e, omega_e, theta_ms, omega_ms, motor_torque)
    put_lane(w, STATE_AT + j, following)
    (gone,) = lane(w, GONE_AT + j, 1)
    put_lane(w, GONE_AT + j, (gone if health(following) == RUNNING else 1.0,))


@cache
def lanes_kernel(variant: Variant) -> Callable[..., None]:
    """Return the compiled `advance` of a variant.

    `w` (LANE_SIZE LANES) holds all numbers of the lanes, see batch.layout; `tunings` (LANES, n) the prepared tunings, whose
    gains follow the stiffness if `scheduled`. `targets`, `commands`, `loads` (m, count, size) are what comes from outside,
    each with the course (LANES) of each lane; `link_terms`, `motor_terms` (LANES, n, 16) the disturbances that make the
    loads. `count` samples of `period` [s] are passed from sample `first` on; with `delayed` each torque acts a sample later.
    """
    form = POSITION_FORM if variant.position_form else VELOCITY_FORM
    predicts, sliding, encoders = variant.predicts, variant.sliding, variant.encoders
    friction, moves = variant.friction, variant.stiffness_moves
    predict = 1.0 if predicts else 0.0

    @written_out
    def begin_period(w, j, period, delayed):
        """Measure, decide, limit, and add up the sample of lane `j`; return plant, state and the torques of the period."""
        plant, tuning = plant_of(w, j, friction), tuning_of(w, j, sliding, form, predict)
        drives, heat = Drives(*lane(w, DRIVES_AT + j, DRIVES_SIZE)), Heat(*lane(w, HEAT_AT + j, 2))
        slew, slewed = Slew(*lane(w, SLEW_AT + j, SLEW_SIZE)), Slewed(*lane(w, SLEWED_AT + j, SLEWED_SIZE))
        now, memory = PlantState(*lane(w, STATE_AT + j, PLANT)), memory_of(w, j)
        applied_e, applied_ms, pending_e, pending_ms = lane(w, APPLIED_AT + j, 4)
        target, aim = Target(*lane(w, TARGET_AT + j, 5)), Target(*lane(w, AIM_AT + j, 5))

        resolution = Encoders(*lane(w, ENCODERS_AT + j, ENCODERS_SIZE)) if encoders else Encoders(0.0, 0.0, 0.0)
        y = measure(resolution, Noise(0.0, 0.0, 0.0, 0.0, 0.0, 0.0), now, 0)
        memory, _, slewed, rate_limited, terms = decide(
            tuning, tuning, predicts, memory, y, applied_e, applied_ms, pending_e,
            aim, slew, slewed, moves, lane(w, COMMAND_AT + j, 1)[0], period,
        )  # fmt: skip
        torque, _, bits = limit_motor_torque(drives, heat, terms.motor_torque, now.omega_e)
        twisting = terms.twisting if bits & TORQUE_LIMITS == 0 else memory.twisting
        memory = Memory(memory.link, memory.motor, memory.stiffness, memory.spring, twisting)
        stiffness_torque, stiffness_bits = limit_stiffness_torque(drives, heat, terms.stiffness_torque, now.omega_ms)
        applied_e = pending_e if delayed else torque
        applied_ms = pending_ms if delayed else stiffness_torque
        pending_e = torque if delayed else pending_e
        pending_ms = stiffness_torque if delayed else pending_ms

        spring = leaf(now.theta_e - now.theta_l, now.theta_ms)
        tau_s, k = plant.spring_constant * spring.torque, plant.spring_constant * spring.stiffness
        bits |= stiffness_bits
        bits |= LEAF_TORQUE if abs(tau_s * tau_s * tau_s) > drives.leaf_cube * abs(k) else 0
        bits |= STIFFNESS_RATE if rate_limited else 0
        bits |= END_STOP if now.theta_ms <= plant.theta_ms_stiff or now.theta_ms >= plant.theta_ms_soft else 0
        link_error = lane(w, LINK_LOADS_AT + j, 1)[0] - tuning.law.link_inertia * memory.link.d
        motor_load = lane(w, MOTOR_LOADS_AT + j, 1)[0] + dry_friction(plant, now.omega_e)
        motor_error = motor_load - tuning.law.motor_inertia * memory.motor.d
        sums = added_up(lane(w, SUMS_AT + j, SUMS), target.r - now.theta_l, applied_e, bits, link_error, motor_error)
        put_lane(w, SUMS_AT + j, sums)
        put_lane(w, HEAT_AT + j, warmed(drives, heat, applied_e, applied_ms))
        put_lane(w, APPLIED_AT + j, (applied_e, applied_ms, pending_e, pending_ms))
        put_lane(w, SLEWED_AT + j, slewed)
        keep_lane_memory(w, j, memory)
        return plant, now, applied_e, applied_ms

    @written_out
    def whole_period(w, j, period, delayed):
        """Advance lane `j` by a period in one step."""
        plant, now, tau_e, tau_ms = begin_period(w, j, period, delayed)
        lag, gap = LagShares(*lane(w, LAGS_AT + j, LAG_SIZE)), now.motor_torque - tau_e
        y = (now.theta_l, now.theta_e, now.theta_ms, now.omega_l, now.omega_e, now.omega_ms)
        loads_l, loads_e = lane(w, LINK_LOADS_AT + j, 6), lane(w, MOTOR_LOADS_AT + j, 6)
        y = dormand_prince_step(plant, None, lag, y, gap, tau_e, tau_ms, loads_l, loads_e, UNLOADED, period)
        settle(w, j, plant, y, tau_e + gap * lag.left)

    @written_out
    def begin_steps(w, j, period, delayed):
        """Begin a period of lane `j` whose dry friction may ask for more than one step."""
        plant, now, tau_e, _ = begin_period(w, j, period, delayed)
        fineness = steps_of_period(plant, now, tau_e, period)
        steps = 1.0 if fineness == 0 else (plant.substeps if fineness == 1 else plant.substeps * FINEST)
        put_lane(w, STEPS_AT + j, (steps, float(fineness), now.motor_torque - tau_e))

    @written_out
    def next_step(w, j, step, period):
        """Go one step on with lane `j`, unless its period is over."""
        plant, now = plant_of(w, j, friction), PlantState(*lane(w, STATE_AT + j, PLANT))
        steps, fineness, gap = lane(w, STEPS_AT + j, 3)
        tau_e, tau_ms = lane(w, APPLIED_AT + j, 2)
        whole, fine, finest = (
            lane(w, LAGS_AT + j, LAG_SIZE), lane(w, LAGS_AT + LAG_SIZE * LANES + j, LAG_SIZE),
            lane(w, LAGS_AT + 2 * LAG_SIZE * LANES + j, LAG_SIZE),
        )  # fmt: skip
        lag = LagShares(*one_of_three(fineness, whole, fine, finest))
        y = (now.theta_l, now.theta_e, now.theta_ms, now.omega_l, now.omega_e, now.omega_ms)
        loads_l, loads_e = lane(w, LINK_LOADS_AT + j, 6), lane(w, MOTOR_LOADS_AT + j, 6)
        z = dormand_prince_step(plant, None, lag, y, gap, tau_e, tau_ms, loads_l, loads_e, UNLOADED, period / steps)
        y = z if step < steps else y
        put_lane(w, STATE_AT + j, (y[0], y[3], y[1], y[4], y[2], y[5]))
        put_lane(w, STEPS_AT + 2 * LANES + j, (gap * lag.left if step < steps else gap,))

    @written_out
    def end_steps(w, j):
        """End the period of lane `j`."""
        now = PlantState(*lane(w, STATE_AT + j, PLANT))
        y = (now.theta_l, now.theta_e, now.theta_ms, now.omega_l, now.omega_e, now.omega_ms)
        tau_e, gap = lane(w, APPLIED_AT + j, 1)[0], lane(w, STEPS_AT + 2 * LANES + j, 1)[0]
        settle(w, j, plant_of(w, j, friction), y, tau_e + gap)

    def advance(
        w, tunings, targets, target_of, commands, command_of, loads, load_of, link_terms, motor_terms,
        first, count, period, delayed, scheduled,
    ):  # fmt: skip
        align_stack()
        one_target, one_command, one_load = is_one(target_of), is_one(command_of), is_one(load_of)
        for i in range(count):
            take_course(w, TARGET_AT, TARGETS, targets, target_of, one_target, i)
            take_course(w, COMMAND_AT, COMMANDS, commands, command_of, one_command, i)
            take_course(w, LINK_LOADS_AT, LOADS, loads, load_of, one_load, i)
            if scheduled:
                take_gains(w, tunings)
            if not friction:
                for j in range(LANES):
                    whole_period(w, j, period, delayed)
                continue
            for j in range(LANES):
                begin_steps(w, j, period, delayed)
            most = 1.0
            for j in range(LANES):
                most = max(most, w[STEPS_AT + j])
            for step in range(int(most)):
                if most > 1.0:
                    take_loads(w, link_terms, motor_terms, load_of, (first + i) * period, step, period)
                for j in range(LANES):
                    next_step(w, j, step, period)
            for j in range(LANES):
                end_steps(w, j)

    return entry(advance)


@inlined
def one_of_three(number, a, b, c):
    """Return tuple `a`, `b` or `c`, as `number` is 0, 1 or 2."""
    if number == 0.0:
        return a
    return b if number == 1.0 else c


@inlined
def is_one(which):
    """Return whether all lanes have the same course."""
    one = True
    for j in range(LANES):
        one = one and which[j] == which[0]
    return one


@inlined
def take_course(w, place, size, courses, which, is_one, i):
    """Bring into the lanes, from `place` on, the `size` numbers that come from outside at sample `i`."""
    if is_one:
        for c in range(size):
            x = courses[which[0], i, c]
            for j in range(LANES):
                w[place + c * LANES + j] = x
    else:
        for j in range(LANES):
            for c in range(size):
                w[place + c * LANES + j] = courses[which[j], i, c]


@called
def take_gains(w, tunings):
    """Bring into the lanes the gains of tunings that follow the stiffness, where it has changed; see simulation.kernel."""
    row = np.empty(ROW)
    for j in range(LANES):
        theta_ms = np.rint(w[MEASURED_AT + j] * 1024.0) / 1024.0
        if theta_ms != w[TAKEN_FOR + j]:
            w[TAKEN_FOR + j] = theta_ms
            take_row(tunings[j], theta_ms, row)
            for i in range(ROW):
                w[GAINS_AT + i * LANES + j] = row[i]


@called
def take_loads(w, link_terms, motor_terms, which, time, step, period):
    """Bring into the lanes the loads of a step where a period has several; a lane like the one before takes its loads."""
    for j in range(LANES):
        steps = w[STEPS_AT + j]
        if steps == 1.0 or step >= steps:
            continue
        if j > 0 and which[j] == which[j - 1] and steps == w[STEPS_AT + j - 1]:
            for c in range(12):
                w[LINK_LOADS_AT + c * LANES + j] = w[LINK_LOADS_AT + c * LANES + j - 1]
            continue
        h = period / steps
        put_lane(w, LINK_LOADS_AT + j, loads_of_step(link_terms[j], time, time + step * h, h, False))
        put_lane(w, MOTOR_LOADS_AT + j, loads_of_step(motor_terms[j], time, time + step * h, h, False))
