"""The compiled tick on its own: what a controller elsewhere is given at each tick, and what it has to answer."""

import numpy as np
from numba.np.unsafe.ndarray import to_fixed_tuple

from vssea_core.actuator.dynamics import PlantState
from vssea_core.actuator.sensors import Measurement, measure
from vssea_core.compiled import entry, inlined
from vssea_core.control.law import StiffnessTarget, Target, act
from vssea_core.control.observer import Memory, observe
from vssea_core.control.packing import MEMORY_SIZE, ROW, is_scheduled, loaded_memory, loaded_prepared, take_row
from vssea_core.control.prediction import predicted
from vssea_core.signals.references import reference_at
from vssea_core.simulation.state import PLANT, loaded_rig
from vssea_core.tick.decision import gains_at

INPUT_UNITS = {
    "theta_l": "rad", "theta_e": "rad", "theta_ms": "rad", "omega_l": "rad/s", "omega_e": "rad/s", "omega_ms": "rad/s",
    "applied_motor": "N m", "applied_stiffness": "N m", "coming_motor": "N m", "motor_was_limited": "",
    "r": "rad", "r1": "rad/s", "r2": "rad/s^2", "r3": "rad/s^3", "r4": "rad/s^4",
    "next_r": "rad", "next_r1": "rad/s", "next_r2": "rad/s^2", "next_r3": "rad/s^3", "next_r4": "rad/s^4",
    "r_ms": "rad", "r_ms1": "rad/s", "r_ms2": "rad/s^2", "next_r_ms": "rad", "next_r_ms1": "rad/s", "next_r_ms2": "rad/s^2",
}  # fmt: skip
"""Columns of the inputs: measurement, torques, both references now and one period ahead."""
OUTPUT_UNITS = {
    "motor_torque": "N m", "stiffness_torque": "N m", "e1": "rad", "e2": "rad/s", "e3": "rad/s^2", "e4": "rad/s^3",
    "sigma": "rad/s^3", "snap": "rad/s^4", "link_d": "rad/s^2", "link_d1": "rad/s^3", "link_d2": "rad/s^4",
    "motor_d": "rad/s^2", "motor_d1": "rad/s^3", "motor_d2": "rad/s^4", "stiffness_d": "rad/s^2",
    "link_omega": "rad/s", "motor_omega": "rad/s", "stiffness_omega": "rad/s", "twisting": "rad/s^4",
}  # fmt: skip
"""Columns of the outputs: torques before any limit, the law's terms, the estimates."""
INPUTS, OUTPUTS = len(INPUT_UNITS), len(OUTPUT_UNITS)
TORQUES_AT, REFERENCES_AT, STIFFNESS_AT = 6, 10, 20


@inlined
def measurement(x):
    """Return the Measurement in a row of inputs."""
    return Measurement(x[0], x[1], x[2], x[3], x[4], x[5])


@inlined
def target(x, at):
    """Return the Target that starts at column `at`."""
    return Target(x[at], x[at + 1], x[at + 2], x[at + 3], x[at + 4])


@inlined
def stiffness_target(x, at):
    """Return the StiffnessTarget that starts at column `at`."""
    return StiffnessTarget(x[at], x[at + 1], x[at + 2])


@entry
def given(rig_row, reference, states, inputs):
    """Write measurements and references of every tick into `inputs` (n, INPUTS), from the plant's `states` (n, PLANT)."""
    rig = loaded_rig(rig_row)
    period = rig.sample_time_s
    for i in range(states.shape[0]):
        y = measure(rig.encoders, rig.noise, PlantState(*to_fixed_tuple(states[i], PLANT)), i)
        now = reference_at(reference, i * period)
        following = reference_at(reference, i * period + period)
        for j in range(TORQUES_AT):
            inputs[i, j] = y[j]
        for j in range(5):
            inputs[i, REFERENCES_AT + j] = now[j]
            inputs[i, REFERENCES_AT + 5 + j] = following[j]


@entry
def answered(prepared, predicts, inputs, outputs):
    """Run the tick from its first over `inputs` (n, INPUTS) and write what it answers into `outputs` (n, OUTPUTS)."""
    row = np.empty(ROW)
    start = inputs[0, STIFFNESS_AT]
    memory = loaded_memory(np.zeros(MEMORY_SIZE))
    scheduled = is_scheduled(prepared)
    twisting = 0.0
    done = 0
    while done < inputs.shape[0]:
        at = gains_at(memory, start)
        take_row(prepared, at, row)
        tuning = loaded_prepared(prepared, row)
        for i in range(done, inputs.shape[0]):
            if scheduled and gains_at(memory, start) != at:
                break
            x = inputs[i]
            if x[TORQUES_AT + 3] == 0.0:  # the integral goes on where no limit cut the last torque
                memory = Memory(memory.link, memory.motor, memory.stiffness, memory.spring, twisting)
            memory = observe(tuning, memory, measurement(x), x[TORQUES_AT], x[TORQUES_AT + 1])
            if predicts:
                ahead = predicted(tuning.law, memory, x[TORQUES_AT + 2], x[STIFFNESS_AT + 2])
                terms = act(tuning.law, ahead, target(x, REFERENCES_AT + 5), stiffness_target(x, STIFFNESS_AT + 3))
            else:
                terms = act(tuning.law, memory, target(x, REFERENCES_AT), stiffness_target(x, STIFFNESS_AT))
            twisting = terms.twisting
            y = outputs[i]
            y[0], y[1] = terms.motor_torque, terms.stiffness_torque
            y[2], y[3], y[4], y[5] = terms.e1, terms.e2, terms.e3, terms.e4
            y[6], y[7] = terms.sigma, terms.snap
            y[8], y[9], y[10] = memory.link.d, memory.link.d1, memory.link.d2
            y[11], y[12], y[13] = memory.motor.d, memory.motor.d1, memory.motor.d2
            y[14] = memory.stiffness.d
            y[15], y[16], y[17] = memory.link.omega, memory.motor.omega, memory.stiffness.omega
            y[18] = memory.twisting
            done += 1
