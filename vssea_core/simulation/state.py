"""The arrays a run works on: parameters from the document, and the one state that a live session and a simulation share."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba.np.unsafe.ndarray import to_fixed_tuple
from numpy.typing import NDArray

from vssea_core.actuator.drive import Drives, Heat
from vssea_core.actuator.dynamics import FINEST, LagShares, Plant, PlantState, lag_shares
from vssea_core.actuator.parameters import Actuator, Timing
from vssea_core.actuator.parts import DELAY_LINE, Delay, delay_of
from vssea_core.actuator.sensors import Encoders, Noise, encoders, noise_of
from vssea_core.actuator.spring import equilibrium_deflection, stiffness_motor_position
from vssea_core.actuator.surroundings import met_load_at_rest
from vssea_core.compiled import inlined
from vssea_core.control.packing import MEMORY_SIZE
from vssea_core.scenario import Scenario
from vssea_core.signals.disturbances import disturbance_tables, load_at
from vssea_core.signals.references import TRANSITION_SIZE
from vssea_core.signals.stiffness import SLEWED_SIZE

Numbers = NDArray[np.float64]

PLANT, HEAT = len(PlantState._fields), len(Heat._fields)
APPLIED = PLANT + HEAT  # torques applied over the last period: motor, stiffness motor
PENDING = APPLIED + 2  # torques waiting for a compute delay of one sample
MEMORY = PENDING + 2
TRANSITION = MEMORY + MEMORY_SIZE
SLEWED = TRANSITION + TRANSITION_SIZE
DELAYED = SLEWED + SLEWED_SIZE  # torques on their way through the drive, the newest first
STATE_SIZE = DELAYED + DELAY_LINE


class Rig(NamedTuple):
    """The simulated rig as the kernel takes it: true plant, drives, encoders and timing."""

    plant: Plant
    lags: tuple[LagShares, LagShares, LagShares]  # for each fineness of integration
    drives: Drives
    encoders: Encoders
    sample_time_s: float
    compute_delay: float
    torque_lag_s: float
    delay: Delay
    noise: Noise


@dataclass(frozen=True)
class Inputs:
    """Everything a run of the kernel reads, from one scenario."""

    rig: Numbers
    link_terms: Numbers
    motor_terms: Numbers
    stiffness_terms: Numbers


def plant_numbers(actuator: Actuator, sample_time_s: float) -> Plant:
    """Return the true plant's parameters, with its end stops and the steps that its dry friction needs."""
    link, motor, mechanism = actuator.link, actuator.motor, actuator.stiffness
    sharpness = motor.coulomb_friction * sample_time_s / (motor.inertia * motor.friction_velocity)
    return Plant(
        1.0 / link.inertia,
        link.damping,
        1.0 / motor.inertia,
        motor.damping,
        motor.coulomb_friction,
        motor.friction_velocity,
        mechanism.spring_constant,
        1.0 / mechanism.inertia,
        mechanism.damping,
        stiffness_motor_position(mechanism.stiffest, mechanism.spring_constant),
        stiffness_motor_position(mechanism.softest, mechanism.spring_constant),
        float(mechanism.back_torque == "paper"),
        float(max(1, math.ceil(sharpness / FRICTION_RATE_A_STEP))),
    )


FRICTION_RATE_A_STEP = 0.12
"""Largest friction rate times step: keeps the order-5 step within 1e-11 rad through a reversal."""


def drive_numbers(actuator: Actuator, sample_time_s: float) -> Drives:
    """Return the limits of both drives."""
    motor, mechanism = actuator.motor, actuator.stiffness
    return Drives(
        motor.peak_torque,
        motor.continuous_torque,
        motor.stall_torque,
        motor.stall_torque / motor.no_load_speed,
        mechanism.peak_torque,
        mechanism.continuous_torque,
        mechanism.speed_limit,
        math.exp(-sample_time_s / motor.thermal_time_s),
        mechanism.leaf_torque**3 / 1000.0,
    )


def rig_numbers(
    plant: Plant,
    drives: Drives,
    resolution: Encoders,
    lag_s: float,
    timing: Timing,
    delay_s: float = 0.0,
    noise: Noise = Noise(),  # noqa: B008
) -> Numbers:
    """Return a simulated rig as one array, in the order of Rig. Raises ValueError if the delay is too long (see delay_of)."""
    period = timing.sample_time_s
    motor = plant.per_motor_inertia, plant.motor_damping
    return np.array(
        [
            *plant,
            *lag_shares(lag_s, *motor, period),
            *lag_shares(lag_s, *motor, period / plant.substeps),
            *lag_shares(lag_s, *motor, period / (plant.substeps * FINEST)),
            *drives,
            *resolution,
            period,
            float(timing.compute_delay_samples),
            lag_s,
            *delay_of(delay_s, period),
            *noise,
        ]
    )


def rig_row(scenario: Scenario) -> Numbers:
    """Return the simulated rig of `scenario` as one array, in the order of Rig."""
    actuator, period = scenario.actuator, scenario.timing.sample_time_s
    return rig_numbers(
        plant_numbers(actuator, period),
        drive_numbers(actuator, period),
        encoders(scenario.sensors, actuator.motor),
        actuator.motor.torque_lag_s,
        scenario.timing,
        actuator.motor.torque_delay_s,
        noise_of(scenario.sensors, scenario.seed),
    )


PLANT_SIZE, LAG_SIZE = len(Plant._fields), len(LagShares._fields)
DRIVES_SIZE, ENCODERS_SIZE = len(Drives._fields), len(Encoders._fields)
FINE_AT = PLANT_SIZE + LAG_SIZE
FINEST_AT = FINE_AT + LAG_SIZE
DRIVES_AT = FINEST_AT + LAG_SIZE
ENCODERS_AT = DRIVES_AT + DRIVES_SIZE
TIMING_AT = ENCODERS_AT + ENCODERS_SIZE
DELAY_SIZE, NOISE_SIZE = len(Delay._fields), len(Noise._fields)
DELAY_AT = TIMING_AT + 3
NOISE_AT = DELAY_AT + DELAY_SIZE


@inlined
def loaded_rig(row):
    """Return the Rig of an array made by `rig_row`."""
    return Rig(
        Plant(*to_fixed_tuple(row[:PLANT_SIZE], PLANT_SIZE)),
        (
            LagShares(*to_fixed_tuple(row[PLANT_SIZE:FINE_AT], LAG_SIZE)),
            LagShares(*to_fixed_tuple(row[FINE_AT:FINEST_AT], LAG_SIZE)),
            LagShares(*to_fixed_tuple(row[FINEST_AT:DRIVES_AT], LAG_SIZE)),
        ),
        Drives(*to_fixed_tuple(row[DRIVES_AT:ENCODERS_AT], DRIVES_SIZE)),
        Encoders(*to_fixed_tuple(row[ENCODERS_AT:TIMING_AT], ENCODERS_SIZE)),
        row[TIMING_AT],
        row[TIMING_AT + 1],
        row[TIMING_AT + 2],
        Delay(*to_fixed_tuple(row[DELAY_AT:NOISE_AT], DELAY_SIZE)),
        Noise(*to_fixed_tuple(row[NOISE_AT : NOISE_AT + NOISE_SIZE], NOISE_SIZE)),
    )


def equilibrium_state(scenario: Scenario, inputs: Inputs | None = None) -> Numbers:
    """Return the state at rest in equilibrium under the disturbances that act at t = 0, with an unstarted controller.

    `inputs` are those of the scenario, where they are known already.

    Raises ValueError if the spring cannot carry the link's load at this stiffness, or a motor cannot hold still.
    """
    actuator, theta_l = scenario.actuator, scenario.initial.link_position
    mechanism, inputs = actuator.stiffness, inputs or inputs_of(scenario)
    at = _initial_stiffness_motor_position(scenario)
    met_load = met_load_at_rest(inputs.link_terms, 0.0, theta_l)
    link_load = load_at(inputs.link_terms, 0.0) + met_load
    motor_load, stiffness_load = load_at(inputs.motor_terms, 0.0), load_at(inputs.stiffness_terms, 0.0)
    try:
        deflection = equilibrium_deflection(link_load, mechanism.spring_constant, at)
    except ValueError as error:
        if met_load == 0.0:
            raise
        raise ValueError(
            f"at initial.link_position {theta_l:g} rad wall and weight load the link with {met_load:g} N·m: {error}, "
            "or start elsewhere"
        ) from error
    back = -12.0 * mechanism.spring_constant * math.sin(deflection / 4.0) ** 2 / at**4
    if mechanism.back_torque == "paper":
        back = link_load
    motor_torque, stiffness_torque = link_load + motor_load, back + stiffness_load
    _check_holds("motor", motor_torque, actuator.motor.peak_torque)
    if stiffness_load != 0.0:
        _check_holds("stiffness motor", stiffness_torque, mechanism.peak_torque)
    state = np.zeros(STATE_SIZE)
    state[:PLANT] = PlantState(theta_l, 0.0, theta_l + deflection, 0.0, at, 0.0, motor_torque)
    state[APPLIED : APPLIED + 2] = state[PENDING : PENDING + 2] = motor_torque, stiffness_torque
    state[SLEWED : SLEWED + SLEWED_SIZE] = at, at, 0.0, 0.0
    state[DELAYED:] = motor_torque
    return state


def _initial_stiffness_motor_position(scenario: Scenario) -> float:
    mechanism, model = scenario.actuator.stiffness, scenario.tuning.model
    theta_ms = stiffness_motor_position(scenario.stiffness_reference.stiffness, model.spring_constant)
    stiff = stiffness_motor_position(mechanism.stiffest, mechanism.spring_constant)
    soft = stiffness_motor_position(mechanism.softest, mechanism.spring_constant)
    return min(max(theta_ms, stiff), soft)


def _check_holds(which: str, torque: float, peak: float) -> None:
    if abs(torque) > peak:
        raise ValueError(
            f"the {which} would need {torque:.4g} N·m to hold still at t = 0; expected at most its peak torque {peak:g} N·m, "
            "so lower the disturbances at t = 0 or let them start later"
        )


def inputs_of(scenario: Scenario) -> Inputs:
    """Return the rig and the disturbance terms of `scenario` as arrays."""
    tables = disturbance_tables(scenario.disturbances, scenario.timing.sample_time_s, scenario.seed)
    return Inputs(rig_row(scenario), *tables)
