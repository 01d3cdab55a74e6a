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
from vssea_core.compiled import entry, inlined
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
MEASURED = (0, 2, 1, 3)
"""Plant states that are measured, in the order of y: both positions, both velocities."""
OUTPUTS_OF_PLANT = 4
REFERENCES = 5  # r and four derivatives
OBSERVED = len(POSITION_NAMES)
OBSERVER_COLUMNS = OBSERVED + OUTPUTS_OF_PLANT + 1
LAW_COLUMNS = OBSERVED + 1 + REFERENCES


@entry
def probe_plant(plant_row, lag_row, theta_ms, step_s, columns):
    """Write the plant over `step_s` [s] to `columns` (5, 8): x+ from x, held torque, link and motor disturbance [N m].

    `lag_row` is the LagShares of that step. The disturbances are constant over the step.
    """
    plant = Plant(*to_fixed_tuple(plant_row[:PLANT_SIZE], PLANT_SIZE))
    lag = LagShares(*to_fixed_tuple(lag_row[:LAG_SIZE], LAG_SIZE))
    loads = np.zeros((2, 1, 16))
    loads[:, 0, 0] = CONSTANT
    loads[:, 0, 4], loads[:, 0, 5] = -np.inf, np.inf
    inputs = np.zeros(8)
    for column in range(8):
        inputs[:] = 0.0
        inputs[column] = TINY
        loads[0, 0, 1], loads[1, 0, 1] = inputs[6], inputs[7]
        now = PlantState(inputs[0], inputs[1], inputs[2], inputs[3], theta_ms, 0.0, inputs[4])
        after = advance_plant(plant, (lag, lag, lag), now, inputs[5], 0.0, loads[0], loads[1], 0.0, step_s)[0]
        columns[0, column] = after.theta_l / TINY
        columns[1, column] = after.omega_l / TINY
        columns[2, column] = after.theta_e / TINY
        columns[3, column] = after.omega_e / TINY
        columns[4, column] = after.motor_torque / TINY


@inlined
def prepared_at(prepared_row, theta_ms):
    """Return the Prepared with the gains at a stiffness motor position [rad]."""
    row = np.empty(ROW)
    take_row(prepared_row, theta_ms, row)
    return loaded_prepared(prepared_row, row)


@entry
def rest_memory(prepared_row, theta_ms):
    """Return the packed memory (n,) of a controller at rest at `theta_ms` [rad], the spring unloaded."""
    rest = np.zeros(MEMORY_SIZE)
    still = Measurement(0.0, 0.0, theta_ms, 0.0, 0.0, 0.0)
    keep_memory(rest, observe(prepared_at(prepared_row, theta_ms), loaded_memory(rest), still, 0.0, 0.0))
    return rest


@entry
def probe_controller(prepared_row, theta_ms, delayed, observer, law):
    """Write the observers to `observer` (13, 18) and the law to `law` (19,), at rest at `theta_ms` [rad].

    Columns of `observer`: memory, measurement (MEASURED), torque applied over the period that ended; rows: memory after it.
    Columns of `law`: memory after the observers, torque that waits for a compute delay, r and its four derivatives (those of
    a sample later where the delay is compensated). `delayed` says whether there is a compute delay.
    """
    prepared = prepared_at(prepared_row, theta_ms)
    rest = rest_memory(prepared_row, theta_ms)
    values, inputs = np.empty(MEMORY_SIZE), np.zeros(OBSERVED + 11)
    for column in range(OBSERVED + 11):
        inputs[:] = 0.0
        inputs[column] = TINY
        values[:] = rest
        for i in range(OBSERVED):
            values[POSITION_ENTRIES[i]] += inputs[i]
        memory = loaded_memory(values)
        y, r = inputs[OBSERVED : OBSERVED + 5], inputs[OBSERVED + 6 : OBSERVED + 11]
        if column < OBSERVED + 5:
            after = observe(prepared, memory, Measurement(y[0], y[1], theta_ms, y[2], y[3], 0.0), y[4], 0.0)
            keep_memory(values, after)
            for i in range(OBSERVED):
                observer[i, column] = values[POSITION_ENTRIES[i]] / TINY
        target, hold = Target(r[0], r[1], r[2], r[3], r[4]), StiffnessTarget(theta_ms, 0.0, 0.0)
        if delayed and prepared.law.predict != 0.0:
            memory = predicted(prepared.law, memory, inputs[OBSERVED + 5], 0.0)
        torque = act(prepared.law, memory, target, hold).motor_torque / TINY
        if column < OBSERVED:
            law[column] = torque
        elif column >= OBSERVED + 5:
            law[column - 5] = torque


STEP_OF_STIFFNESS_MOTOR = 2.0**-10
"""Difference [rad, rad/s, N m ...] for the stiffness axis: with an unloaded spring it is linear, so any size would do."""
STIFFNESS_STATES, STIFFNESS_OBSERVED = 2, len(STIFFNESS_NAMES)


@entry
def probe_stiffness_axis(plant_row, prepared_row, theta_ms, period_s, plant_columns, observer, law):
    """Write the stiffness axis, the spring unloaded: plant (2, 3), observer (6, 9) and law (7,), as the two above.

    Its state is [theta_ms, theta_ms'] and is measured whole; about a position that is not zero, so by central differences.
    """
    plant = Plant(*to_fixed_tuple(plant_row[:PLANT_SIZE], PLANT_SIZE))
    none = LagShares(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    prepared = prepared_at(prepared_row, theta_ms)
    calm = np.zeros((0, 16))
    rest = rest_memory(prepared_row, theta_ms)
    plant_columns[:] = 0.0
    observer[:] = 0.0
    law[:] = 0.0
    values, inputs = np.empty(MEMORY_SIZE), np.zeros(12)
    for column in range(12):  # x, torque; memory, y, applied
        for side in range(2):
            h = STEP_OF_STIFFNESS_MOTOR if side == 0 else -STEP_OF_STIFFNESS_MOTOR
            inputs[:] = 0.0
            inputs[column] = h
            if column < 3:
                now = PlantState(0.0, 0.0, 0.0, 0.0, theta_ms + inputs[0], inputs[1], 0.0)
                moved = advance_plant(plant, (none, none, none), now, 0.0, inputs[2], calm, calm, 0.0, period_s)[0]
                plant_columns[0, column] += moved.theta_ms / (2.0 * h)
                plant_columns[1, column] += moved.omega_ms / (2.0 * h)
                continue
            values[:] = rest
            for i in range(STIFFNESS_OBSERVED):
                values[STIFFNESS_ENTRIES[i]] += inputs[3 + i]
            memory = loaded_memory(values)
            y = Measurement(0.0, 0.0, theta_ms + inputs[9], 0.0, 0.0, inputs[10])
            keep_memory(values, observe(prepared, memory, y, 0.0, inputs[11]))
            for i in range(STIFFNESS_OBSERVED):
                observer[i, column - 3] += values[STIFFNESS_ENTRIES[i]] / (2.0 * h)
            if column < 3 + STIFFNESS_OBSERVED:
                held = act(prepared.law, memory, Target(0.0, 0.0, 0.0, 0.0, 0.0), StiffnessTarget(theta_ms, 0.0, 0.0))
                law[column - 3] += held.stiffness_torque / (2.0 * h)
