"""The closed loop as one system of matrices, put together from the probed pieces.

The state is taken just after the observers ran: xi = [x, what the observers keep, torques on their way, delayed command].
Numbers the controller remembers that follow from the present measurement alone (in the velocity form: velocities, the
spring) are not states of it. So the loop has 10 states with the velocity observer and 14 with the position observer,
without lag and delay; nothing is approximated.
"""

import numpy as np

from vssea_core.compiled import entry

PLANT_TORQUE, LIMITER, LINK_LOAD, MOTOR_LOAD, REFERENCE, NOISE, INPUTS = 0, 1, 2, 3, 4, 9, 13
"""Columns of B: torque at the plant alone, torque at the limiter (plant and observer), loads, r and derivatives, noise."""
NO_INPUTS, BREAKS = 0, 2
"""How many inputs a caller may ask for: none (poles), those of the two breaks (margins), or INPUTS."""
TORQUE, LINK, LINK_DISTURBANCE, MOTOR_DISTURBANCE, OUTPUTS = 0, 1, 2, 3, 4
"""Rows of C: demanded torque, link position, and the estimates [rad/s^2] of both disturbances."""


@entry
def joined_plant(first, second, states):
    """Return (states, states + 4) of a period in two steps: x, torque of the second, of the first step, both loads.

    `first` and `second` are (>= states, columns) of probe_plant, for the steps before and after the torque changes.
    """
    total = first.shape[0]
    whole = np.zeros((states, states + 4))
    for i in range(states):
        for j in range(states):
            for m in range(states):
                whole[i, j] += second[i, m] * first[m, j]
        whole[i, states] = second[i, total]
        for m in range(states):
            whole[i, states + 1] += second[i, m] * first[m, total]
            for load in range(2):
                whole[i, states + 2 + load] += second[i, m] * first[m, total + 1 + load]
        for load in range(2):
            whole[i, states + 2 + load] += second[i, total + 1 + load]
    return whole


@entry
def single_step_plant(columns, states):
    """Return what joined_plant returns, for a torque that changes at the sample only."""
    total = columns.shape[0]
    whole = np.zeros((states, states + 4))
    for i in range(states):
        for j in range(states):
            whole[i, j] = columns[i, j]
        whole[i, states] = columns[i, total]
        if columns.shape[1] > total + 1:
            whole[i, states + 2], whole[i, states + 3] = columns[i, total + 1], columns[i, total + 2]
    return whole


@entry
def kept_entries(observer, outputs):
    """Return which rows of an observer (m, m + outputs + 1) are states: those that hold more than the measurement."""
    m = observer.shape[0]
    kept = np.zeros(m, np.bool_)
    for i in range(m):
        for j in range(m + outputs + 1):
            if (j < m or j == m + outputs) and observer[i, j] != 0.0:
                kept[i] = True
    return kept


@entry
def assembled(plant, measured, observer, law, estimates, whole_delay, split, compute_delay, inputs):
    """Return A, B, C, D of the closed loop.

    plant (nx, nx + 4) of joined_plant; measured (ny,) places of the measured states in x; observer (m, m + ny + 1) and
    law (m + 1 + nr,) of the probes; estimates (2,) places of the two estimates in the memory. The torque reaches the plant
    `whole_delay` samples late, and with `split` one more for the first part of each period. `inputs` is NO_INPUTS, BREAKS
    or INPUTS.
    """
    nx, m, ny = plant.shape[0], observer.shape[0], len(measured)
    kept = kept_entries(observer, ny)
    retained = 0
    for i in range(m):
        retained += kept[i]
    line = whole_delay + (1 if split else 0)
    line_at = nx + retained
    pending_at = line_at + line
    n = pending_at + (1 if compute_delay else 0)
    # Signals are rows over [xi, inputs, measurement noise one sample later].
    width = n + inputs + (ny if inputs > NOISE else 0)
    later = n + inputs

    memory = np.zeros((m, width))
    place = nx
    for i in range(m):
        if kept[i]:
            memory[i, place] = 1.0
            place += 1
        else:
            for j in range(ny):
                gain = observer[i, m + j]
                memory[i, measured[j]] = gain
                if inputs > NOISE:
                    memory[i, n + NOISE + j] = gain

    torque = np.zeros(width)
    for i in range(m):
        if law[i] != 0.0:
            for j in range(width):
                torque[j] += law[i] * memory[i, j]
    if compute_delay:
        torque[pending_at] += law[m]
    if inputs > REFERENCE:
        for j in range(NOISE - REFERENCE):
            torque[n + REFERENCE + j] += law[m + 1 + j]

    limited = torque.copy()
    if inputs >= BREAKS:
        limited[n + LIMITER] += 1.0
    applied = np.zeros(width)
    if compute_delay:
        applied[pending_at] = 1.0
    else:
        applied[:] = limited
    sent = applied.copy()
    if inputs >= BREAKS:
        sent[n + PLANT_TORQUE] += 1.0

    after = np.zeros((n, width))
    for i in range(nx):
        for j in range(nx):
            after[i, j] = plant[i, j]
        if whole_delay == 0:
            for j in range(width):
                after[i, j] += plant[i, nx] * sent[j]
        else:
            after[i, line_at + whole_delay - 1] += plant[i, nx]
        if split:
            after[i, line_at + whole_delay] += plant[i, nx + 1]
        if inputs > LINK_LOAD:
            after[i, n + LINK_LOAD] += plant[i, nx + 2]
            after[i, n + MOTOR_LOAD] += plant[i, nx + 3]
    row = nx
    for i in range(m):
        if kept[i]:
            for s in range(m):
                gain = observer[i, s]
                if gain != 0.0:
                    for j in range(width):
                        after[row, j] += gain * memory[s, j]
            for s in range(ny):
                gain = observer[i, m + s]
                if gain != 0.0:
                    for j in range(width):
                        after[row, j] += gain * after[measured[s], j]
                    if inputs > NOISE:
                        after[row, later + s] += gain
            gain = observer[i, m + ny]
            for j in range(width):
                after[row, j] += gain * applied[j]
            row += 1
    for i in range(line):
        if i == 0:
            after[line_at, :] = sent
        else:
            after[line_at + i, line_at + i - 1] = 1.0
    if compute_delay:
        after[pending_at, :] = limited

    A, B = after[:, :n].copy(), after[:, n : n + inputs].copy()
    C, D = np.zeros((OUTPUTS, n)), np.zeros((OUTPUTS, inputs))
    C[TORQUE], D[TORQUE] = torque[:n], torque[n : n + inputs]
    C[LINK, 0] = 1.0
    for i in range(2):
        C[LINK_DISTURBANCE + i] = memory[estimates[i], :n]
        D[LINK_DISTURBANCE + i] = memory[estimates[i], n : n + inputs]
    if inputs > NOISE:  # with xi' = xi - (what the noise of now put into xi), noise enters once, as usual
        into = after[:, later:]
        for j in range(ny):
            for i in range(n):
                for s in range(n):
                    B[i, NOISE + j] += A[i, s] * into[s, j]
            for i in range(OUTPUTS):
                for s in range(n):
                    D[i, NOISE + j] += C[i, s] * into[s, j]
    return A, B, C, D
