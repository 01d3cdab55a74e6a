"""A sample period for everything that few runs need: a late torque, so that two act in it, and disturbances of any kind.

The period is split where the older torque gives way, and a step that ends in a wall is halved until the moment of contact
lies within a thousandth of a step.
"""

from typing import NamedTuple

from vssea_core.actuator.dynamics import (
    FINEST,
    PlantState,
    dormand_prince_step,
    lag_shares,
    steps_of_period,
    stopped,
)
from vssea_core.actuator.spring import leaf
from vssea_core.actuator.surroundings import contact_steps, met_load, touches
from vssea_core.compiled import called, inlined
from vssea_core.signals.disturbances import all_loads_of_step, load

DELAY_LINE = 24  # past torques that the state keeps
DEEPEST = 10  # halvings of a step that ends in a wall


class Delay(NamedTuple):
    """Transport delay of the drive: whole samples, and the share of a period over which the torque before still acts."""

    samples: float
    share: float


def delay_of(torque_delay_s: float, sample_time_s: float) -> Delay:
    """Return the Delay for a delay [s]. Raises ValueError if it is longer than the delay line."""
    samples = torque_delay_s / sample_time_s
    whole = round(samples)
    if abs(samples - whole) > 1e-9:
        whole = int(samples)
    share = max(0.0, samples - whole)
    if whole + (share > 1e-9) > DELAY_LINE - 1:
        raise ValueError(
            f"actuator.motor.torque_delay_s {torque_delay_s:g} s is {samples:.4g} samples of {sample_time_s:g} s; "
            f"expected at most {DELAY_LINE - 1} samples, so shorten the delay or lengthen timing.sample_time_s"
        )
    return Delay(float(whole), share if share > 1e-9 else 0.0)


@called
def steps_of_part(plant, state, tau_e, length, link_terms, tick_time, start):
    """Return the steps over a part of `length` [s]: from `start` [s]: as many as dry friction or walls ask for."""
    fineness = steps_of_period(plant, state, tau_e, length)
    steps = 1
    if fineness == 1:
        steps = int(plant.substeps)
    elif fineness == 2:
        steps = int(plant.substeps) * FINEST
    tau_s = plant.spring_constant * leaf(state.theta_e - state.theta_l, state.theta_ms).torque
    force = abs(tau_s) + abs(load(link_terms, tick_time, start))
    near = contact_steps(link_terms, tick_time, plant.per_link_inertia, state.theta_l, state.omega_l, force, length)
    return max(steps, near)


@called
def lags_of_parts(plant, lag_s, share, sample_time_s):
    """Return the LagShares of both parts of a period, each in one step."""
    older, newer = share * sample_time_s, (1.0 - share) * sample_time_s
    return (
        lag_shares(lag_s, plant.per_motor_inertia, plant.motor_damping, older),
        lag_shares(lag_s, plant.per_motor_inertia, plant.motor_damping, newer),
    )


@called
def advance_in_parts(
    plant,
    lag_s,
    lags,
    state,
    older,
    newer,
    share,
    tau_ms,
    link_terms,
    motor_terms,
    stiffness_terms,
    time,
    sample_time_s,
):
    """Return the state one sample period after `time` [s], and the loads [N m] of link, motor, stiffness motor at `time`.

    The torque `older` [N m] acts over the first `share` of the period, `newer` over the rest; `lags` are those of
    `lags_of_parts`.
    """
    now = state
    load_l = load_e = load_ms = 0.0
    for part in range(2):
        length = share * sample_time_s if part == 0 else (1.0 - share) * sample_time_s
        if length == 0.0:
            continue
        start = time if part == 0 else time + share * sample_time_s
        tau_e = older if part == 0 else newer
        gap = now.motor_torque - tau_e
        steps = steps_of_part(plant, now, tau_e, length, link_terms, time, start)
        y = (now.theta_l, now.theta_e, now.theta_ms, now.omega_l, now.omega_e, now.omega_ms)
        step = depth = 0
        h = length / steps
        lag = lags[part]
        if steps > 1:
            lag = lag_shares(lag_s, plant.per_motor_inertia, plant.motor_damping, h)
        while step < steps:
            at = start + step * h
            whole = h == sample_time_s
            loads_l = all_loads_of_step(link_terms, time, at, h, whole)
            loads_e = all_loads_of_step(motor_terms, time, at, h, whole)
            loads_ms = all_loads_of_step(stiffness_terms, time, at, h, whole)
            if at == time:
                load_l = loads_l[0] + met_load(link_terms, time, now.theta_l, now.omega_l)
                load_e, load_ms = loads_e[0], loads_ms[0]
            met = (link_terms, time)
            after = dormand_prince_step(plant, met, lag, y, gap, tau_e, tau_ms, loads_l, loads_e, loads_ms, h)
            if depth < DEEPEST and touches(link_terms, time, y[0], after[0]):
                depth, step, steps, h = depth + 1, 2 * step, 2 * steps, 0.5 * h
                lag = lag_shares(lag_s, plant.per_motor_inertia, plant.motor_damping, h)
                continue
            y = after
            gap *= lag.left
            step += 1
            if depth > 0 and step % 2 == 0:
                while depth > 0 and step % 2 == 0:
                    depth, step, steps, h = depth - 1, step // 2, steps // 2, 2.0 * h
                lag = lag_shares(lag_s, plant.per_motor_inertia, plant.motor_damping, h)
        theta_l, theta_e, theta_ms, omega_l, omega_e, omega_ms = y
        theta_ms, omega_ms = stopped(plant, theta_ms, omega_ms)
        now = PlantState(theta_l, omega_l, theta_e, omega_e, theta_ms, omega_ms, tau_e + gap)
    return now, (load_l, load_e, load_ms)


@inlined
def passed_on(delay, line, torque):
    """Return the torques [N m] of both parts of a period, older and newer; put `torque`, of this tick, into the `line`."""
    m = int(delay.samples)
    older, newer = line[m], torque if m == 0 else line[m - 1]
    for i in range(m, 0, -1):
        line[i] = line[i - 1]
    line[0] = torque
    return older, newer
