"""The linearised loop, taken from the compiled tick and plant themselves.

At rest with zero deflection every state of the position loop is exactly zero. One tick from a single tiny entry therefore
*is* a column of its matrix, to rounding: no difference is taken, and the spring's curvature is far below the last digit.
So whatever runs is analysed: any controller, observer, gain schedule or mismatch. All functions that a tick calls are
called here and nowhere else in the analysis.
"""

import numpy as np
from numba.np.unsafe.ndarray import to_fixed_tuple

from vssea_core.actuator.dynamics import LagShares, Plant, PlantState, advance_plant
from vssea_core.actuator.sensors import Measurement
from vssea_core.compiled import entry
from vssea_core.control.law import StiffnessTarget, Target, act
from vssea_core.control.observer import Channel, Spring, observe
from vssea_core.control.packing import MEMORY_SIZE, ROW, keep_memory, loaded_memory, loaded_prepared, take_row
from vssea_core.control.prediction import predicted
from vssea_core.signals.disturbances import CONSTANT

TINY = 2.0**-100  # a power of two, so dividing by it is exact; squares of it neither matter nor underflow
PLANT_SIZE, LAG_SIZE = len(Plant._fields), len(LagShares._fields)


def _named_entries() -> dict[str, int]:
    """Return place by name of every number in a packed Memory."""
    parts = {"link": Channel._fields, "motor": Channel._fields, "stiffness": Channel._fields, "spring": Spring._fields}
    names = [f"{part}.{field}" for part in parts for field in parts[part]]
    return {name: place for place, name in enumerate(names)}


ENTRIES = _named_entries()
POSITION_NAMES = tuple(
    name for name in ENTRIES if not name.startswith("stiffness.") and name not in ("spring.back", "spring.started")
)
POSITION_ENTRIES = np.array([ENTRIES[name] for name in POSITION_NAMES])
STIFFNESS_NAMES = tuple(name for name in ENTRIES if name.startswith("stiffness."))
STIFFNESS_ENTRIES = np.array([ENTRIES[name] for name in STIFFNESS_NAMES])
LINK_ESTIMATE, MOTOR_ESTIMATE = POSITION_NAMES.index("link.d"), POSITION_NAMES.index("motor.d")

PLANT_NAMES = ("link_position", "link_velocity", "motor_position", "motor_velocity", "motor_torque")
PLANT_STATES, PLANT_COLUMNS = 5, 8
"""x and the columns of the plant: x, torque, link disturbance, motor disturbance."""
POSITION_STATES = (0, 1, 2, 3, 6)
"""Places of these states in a PlantState."""
MEASURED = (0, 2, 1, 3)
"""Plant states that are measured: both positions, both velocities."""
READINGS = (0, 1, 3, 4)
"""Places of these in a Measurement."""
OUTPUTS_OF_PLANT = 4
REFERENCES = 5  # r and four derivatives
OBSERVED = len(POSITION_NAMES)
OBSERVER_COLUMNS = OBSERVED + OUTPUTS_OF_PLANT + 1
LAW_COLUMNS = OBSERVED + 1 + REFERENCES


@entry
def one_tick(
    prepared_row, memory_row, y, applied, waiting, delayed, reference, stiffness_reference, following, torques
):
    """Write the memory (n,) after the observers to `following`, and the torques (2,) of the law on `memory_row` as it is.

    `y` (6,) is a Measurement, `applied` (2,) are both torques [N m] of the period that ended, `waiting` the motor torque [N m]
    of the coming one if the loop is `delayed`, `reference` (5,) and `stiffness_reference` (3,) what the law is asked for, the
    first rad being where gains are taken. A memory of zeros has not started: `following` is then at rest.
    """
    row = np.empty(ROW)
    take_row(prepared_row, stiffness_reference[0], row)
    prepared = loaded_prepared(prepared_row, row)
    memory = loaded_memory(memory_row)
    measured = Measurement(y[0], y[1], y[2], y[3], y[4], y[5])
    keep_memory(following, observe(prepared, memory, measured, applied[0], applied[1]))
    target = Target(reference[0], reference[1], reference[2], reference[3], reference[4])
    hold = StiffnessTarget(stiffness_reference[0], stiffness_reference[1], stiffness_reference[2])
    if delayed and prepared.law.predict != 0.0:
        memory = predicted(prepared.law, memory, waiting, stiffness_reference[2])
    terms = act(prepared.law, memory, target, hold)
    torques[0], torques[1] = terms.motor_torque, terms.stiffness_torque


@entry
def one_step(plant_row, lag_row, state, torques, loads, step_s, following):
    """Write the PlantState (7,) after a step of `step_s` [s] to `following`.

    `torques` (2,) [N m] are held, `loads` (2,) [N m] on link and motor are constant; `lag_row` is the LagShares of the step.
    """
    plant = Plant(*to_fixed_tuple(plant_row[:PLANT_SIZE], PLANT_SIZE))
    lag = LagShares(*to_fixed_tuple(lag_row[:LAG_SIZE], LAG_SIZE))
    terms = np.zeros((2, 1, 16))
    terms[:, 0, 0] = CONSTANT
    terms[0, 0, 1], terms[1, 0, 1] = loads[0], loads[1]
    terms[:, 0, 4], terms[:, 0, 5] = -np.inf, np.inf
    now = PlantState(state[0], state[1], state[2], state[3], state[4], state[5], state[6])
    after = advance_plant(plant, (lag, lag, lag), now, torques[0], torques[1], terms[0], terms[1], 0.0, step_s)[0]
    for i in range(len(following)):
        following[i] = after[i]


@entry
def probe_plant(plant_row, lag_row, theta_ms, step_s, columns):
    """Write the plant over `step_s` [s] to `columns` (5, 8): x+ from x, held torque, link and motor disturbance [N m].

    `lag_row` is the LagShares of that step. The disturbances are constant over the step.
    """
    state, following, torques, loads = np.zeros(7), np.zeros(7), np.zeros(2), np.zeros(2)
    for column in range(PLANT_COLUMNS):
        state[:], torques[:], loads[:] = 0.0, 0.0, 0.0
        state[4] = theta_ms
        if column < PLANT_STATES:
            state[POSITION_STATES[column]] = TINY
        elif column == PLANT_STATES:
            torques[0] = TINY
        else:
            loads[column - PLANT_STATES - 1] = TINY
        one_step(plant_row, lag_row, state, torques, loads, step_s, following)
        for i in range(PLANT_STATES):
            columns[i, column] = following[POSITION_STATES[i]] / TINY


@entry
def probe_controller(prepared_row, theta_ms, delayed, observer, law):
    """Write the observers to `observer` (13, 18) and the law to `law` (19,), at rest at `theta_ms` [rad].

    Columns of `observer`: memory, measurement (MEASURED), torque applied over the period that ended; rows: memory after it.
    Columns of `law`: memory after the observers, torque that waits for a compute delay, r and its four derivatives (those of
    a sample later where the delay is compensated). `delayed` says whether there is a compute delay.
    """
    rest, memory, following = np.zeros(MEMORY_SIZE), np.zeros(MEMORY_SIZE), np.zeros(MEMORY_SIZE)
    y, applied, torques = np.zeros(6), np.zeros(2), np.zeros(2)
    reference, hold = np.zeros(REFERENCES), np.zeros(3)
    y[2] = hold[0] = theta_ms
    one_tick(prepared_row, memory, y, applied, 0.0, delayed, reference, hold, rest, torques)
    for column in range(OBSERVED + 11):
        memory[:] = rest
        y[0] = y[1] = y[3] = y[4] = 0.0
        applied[0] = 0.0
        reference[:] = 0.0
        if column < OBSERVED:
            memory[POSITION_ENTRIES[column]] += TINY
        elif column < OBSERVED + 4:
            y[READINGS[column - OBSERVED]] = TINY
        elif column == OBSERVED + 4:
            applied[0] = TINY
        elif column > OBSERVED + 5:
            reference[column - OBSERVED - 6] = TINY
        waiting = TINY if column == OBSERVED + 5 else 0.0
        one_tick(prepared_row, memory, y, applied, waiting, delayed, reference, hold, following, torques)
        if column < OBSERVED + 5:
            for i in range(OBSERVED):
                observer[i, column] = following[POSITION_ENTRIES[i]] / TINY
        if column < OBSERVED:
            law[column] = torques[0] / TINY
        elif column >= OBSERVED + 5:
            law[column - 5] = torques[0] / TINY


STEP_OF_STIFFNESS_MOTOR = 2.0**-10
"""Difference [rad, rad/s, N m ...] for the stiffness axis: with an unloaded spring it is linear, so any size would do."""
STIFFNESS_STATES, STIFFNESS_OBSERVED = 2, len(STIFFNESS_NAMES)


@entry
def probe_stiffness_axis(plant_row, prepared_row, theta_ms, period_s, delayed, plant_columns, observer, law):
    """Write the stiffness axis, the spring unloaded: plant (2, 3), observer (6, 9) and law (7,), as the two above.

    Its state is [theta_ms, theta_ms'] and is measured whole; about a position that is not zero, so by central differences.
    """
    rest, memory, following = np.zeros(MEMORY_SIZE), np.zeros(MEMORY_SIZE), np.zeros(MEMORY_SIZE)
    y, applied, torques, lag = np.zeros(6), np.zeros(2), np.zeros(2), np.zeros(LAG_SIZE)
    reference, hold, loads = np.zeros(REFERENCES), np.zeros(3), np.zeros(2)
    state, moved = np.zeros(7), np.zeros(7)
    y[2] = hold[0] = theta_ms
    one_tick(prepared_row, memory, y, applied, 0.0, delayed, reference, hold, rest, torques)
    plant_columns[:], observer[:], law[:] = 0.0, 0.0, 0.0
    for side in range(2):
        h = STEP_OF_STIFFNESS_MOTOR if side == 0 else -STEP_OF_STIFFNESS_MOTOR
        for column in range(3):
            state[4], state[5] = theta_ms + (h if column == 0 else 0.0), h if column == 1 else 0.0
            applied[1] = h if column == 2 else 0.0
            one_step(plant_row, lag, state, applied, loads, period_s, moved)
            plant_columns[0, column] += moved[4] / (2.0 * h)
            plant_columns[1, column] += moved[5] / (2.0 * h)
        for column in range(STIFFNESS_OBSERVED + 3):
            memory[:] = rest
            y[2], y[5], applied[1] = theta_ms, 0.0, 0.0
            if column < STIFFNESS_OBSERVED:
                memory[STIFFNESS_ENTRIES[column]] += h
            elif column == STIFFNESS_OBSERVED:
                y[2] += h
            elif column == STIFFNESS_OBSERVED + 1:
                y[5] = h
            else:
                applied[1] = h
            one_tick(prepared_row, memory, y, applied, 0.0, delayed, reference, hold, following, torques)
            for i in range(STIFFNESS_OBSERVED):
                observer[i, column] += following[STIFFNESS_ENTRIES[i]] / (2.0 * h)
            if column < STIFFNESS_OBSERVED:
                law[column] += torques[1] / (2.0 * h)
