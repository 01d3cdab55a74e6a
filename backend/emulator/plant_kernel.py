"""The emulated actuator over some time, compiled: the plant at a fine step, its drives' limits and their own braking."""

import math

from numba.np.unsafe.ndarray import to_fixed_tuple

from vssea_core.actuator.drive import Drives, Heat, limit_motor_torque, limit_stiffness_torque, warmed
from vssea_core.actuator.dynamics import FINEST, Plant, PlantState, advance_plant, lag_shares
from vssea_core.compiled import entry, inlined

FINE_STEP_S = 2.5e-4
UNSAFE_TORQUE = 0.5  # N m at the gear side; below it the motor is taken to be without torque
PLANT_NUMBERS, DRIVE_NUMBERS, STATE_SIZE = len(Plant._fields), len(Drives._fields), len(PlantState._fields)
LAG_AT = PLANT_NUMBERS + DRIVE_NUMBERS
THERMAL_AT, NUMBERS = LAG_AT + 1, LAG_AT + 2

# Columns of an axis: what its drive does, what it stands, what it gave.
(
    MODE, TORQUE, DECELERATION, SPEED_REFERENCE, POSITION_REFERENCE, CAP, PUSH, POSITION_GAIN, SPEED_GAIN, GIVEN, LIMITED,
) = range(11)  # fmt: skip
AXIS_SIZE = 11
OFF, TORQUE_GIVEN, BRAKING = 0.0, 1.0, 2.0
"""An axis without torque, with the torque it is told, and braking down its ramp to hold still by the drive's own loop."""

# Columns of the record: plant time, the last time with torque on the motor, then the largest magnitudes so far.
(
    TIME, LAST_UNSAFE, LINK_VELOCITY, MOTOR_VELOCITY, STIFFNESS_VELOCITY, DEFLECTION, MOTOR_TORQUE, STIFFNESS_TORQUE,
) = range(8)  # fmt: skip
RECORD_SIZE = 8


@inlined
def asked_torque(axis, position, velocity, h):
    """Return the torque [N m] that the drive of an `axis` asks of its motor over the next `h` [s]."""
    if axis[MODE] == TORQUE_GIVEN:
        return axis[TORQUE]
    if axis[MODE] == OFF:
        return 0.0
    reference = axis[SPEED_REFERENCE]
    axis[SPEED_REFERENCE] = math.copysign(max(0.0, abs(reference) - axis[DECELERATION] * h), reference)
    axis[POSITION_REFERENCE] += 0.5 * h * (reference + axis[SPEED_REFERENCE])
    farthest = axis[CAP] / axis[POSITION_GAIN]  # a reference that the motor cannot follow does not run away from it
    error = min(farthest, max(-farthest, axis[POSITION_REFERENCE] - position))
    axis[POSITION_REFERENCE] = position + error
    return axis[POSITION_GAIN] * error + axis[SPEED_GAIN] * (axis[SPEED_REFERENCE] - velocity)


@inlined
def capped(axis, torque):
    """Return the torque [N m] within what the drive of an `axis` is set to stand; note whether that limited it."""
    axis[LIMITED] = 1.0 if abs(torque) > axis[CAP] else 0.0
    return math.copysign(min(abs(torque), axis[CAP]), torque)


@entry
def advance(numbers, state, axes, link_loads, motor_loads, record, duration_s):
    """Advance `state` by `duration_s` in place, with its thermal averages; return whether it is still a spring that holds.

    `numbers` are Plant, Drives, torque-loop lag and thermal time; `axes` (2, AXIS_SIZE) motor and stiffness motor; the
    loads are tables of constant disturbances; `record` holds the largest magnitudes so far.
    """
    plant = Plant(*to_fixed_tuple(numbers[:PLANT_NUMBERS], PLANT_NUMBERS))
    drives = Drives(*to_fixed_tuple(numbers[PLANT_NUMBERS:LAG_AT], DRIVE_NUMBERS))
    steps = max(1, math.ceil(duration_s / FINE_STEP_S - 1e-9))
    h = duration_s / steps
    drives = Drives(
        drives.peak_torque,
        drives.continuous_torque,
        drives.stall_torque,
        drives.torque_per_speed,
        drives.stiffness_peak_torque,
        drives.stiffness_continuous_torque,
        drives.stiffness_speed,
        math.exp(-h / numbers[THERMAL_AT]),
        drives.leaf_cube,
    )
    lag, inertia, damping = numbers[LAG_AT], plant.per_motor_inertia, plant.motor_damping
    lags = (
        lag_shares(lag, inertia, damping, h),
        lag_shares(lag, inertia, damping, h / plant.substeps),
        lag_shares(lag, inertia, damping, h / (plant.substeps * FINEST)),
    )
    now = PlantState(*to_fixed_tuple(state[:STATE_SIZE], STATE_SIZE))
    heat = Heat(state[STATE_SIZE], state[STATE_SIZE + 1])
    motor, stiffness = axes[0], axes[1]
    holds = True
    for _ in range(steps):
        tau_e = capped(motor, asked_torque(motor, now.theta_e, now.omega_e, h))
        tau_e, _available, bits = limit_motor_torque(drives, heat, tau_e, now.omega_e)
        if bits != 0:
            motor[LIMITED] = 1.0
        tau_ms = capped(stiffness, asked_torque(stiffness, now.theta_ms, now.omega_ms, h))
        tau_ms, bits = limit_stiffness_torque(drives, heat, tau_ms, now.omega_ms)
        if bits != 0:
            stiffness[LIMITED] = 1.0
        now, _loads = advance_plant(plant, lags, now, tau_e, tau_ms + stiffness[PUSH], link_loads, motor_loads, 0.0, h)
        heat = warmed(drives, heat, tau_e, tau_ms)
        motor[GIVEN], stiffness[GIVEN] = now.motor_torque, tau_ms
        total = now.theta_l + now.omega_l + now.theta_e + now.omega_e + now.theta_ms + now.omega_ms + now.motor_torque
        if not math.isfinite(total) or abs(now.theta_e - now.theta_l) >= math.pi:
            holds = False
            break
        record[TIME] += h
        if abs(now.motor_torque) >= UNSAFE_TORQUE:
            record[LAST_UNSAFE] = record[TIME]
        record[LINK_VELOCITY] = max(record[LINK_VELOCITY], abs(now.omega_l))
        record[MOTOR_VELOCITY] = max(record[MOTOR_VELOCITY], abs(now.omega_e))
        record[STIFFNESS_VELOCITY] = max(record[STIFFNESS_VELOCITY], abs(now.omega_ms))
        record[DEFLECTION] = max(record[DEFLECTION], abs(now.theta_e - now.theta_l))
        record[MOTOR_TORQUE] = max(record[MOTOR_TORQUE], abs(now.motor_torque))
        record[STIFFNESS_TORQUE] = max(record[STIFFNESS_TORQUE], abs(tau_ms))
    for i in range(STATE_SIZE):
        state[i] = now[i]
    state[STATE_SIZE], state[STATE_SIZE + 1] = heat.motor, heat.stiffness_motor
    return holds
